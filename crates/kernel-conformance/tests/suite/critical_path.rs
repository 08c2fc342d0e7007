//! The critical path: chains computed by hand, and a property. Without memories, units and FIFOs off the path do not limit the
//! run.

use crate::common::random::recipe;
use crate::common::{PlanBuilder, machine, record_plan, run_both, small_cache, small_memory};
use basrelief_kernel::{CriticalPath, Netlist, Outcome, PathSegment, Recording, ResimulationMemory, StageGroups, critical_path};
use basrelief_kernel_conformance::plan::{Plan, PlanLookUp, PlanRequest, UnitKind};
use proptest::prelude::*;
use std::borrow::Cow;

fn path_of(plan: &Plan, most_steps: usize) -> Option<CriticalPath> {
    path_by(plan, most_steps, &[])
}

/// Finds the path of a recording that is read chunk by chunk, and of one that is read before. Both must be equal.
fn path_by(plan: &Plan, most_steps: usize, groups: &[StageGroups]) -> Option<CriticalPath> {
    let recording = record_plan(plan, u64::MAX);
    let netlist = || Netlist::of(&mut machine(plan)).unwrap();
    let mut chunks = recording.iter().map(Cow::Borrowed);
    let path = critical_path(netlist(), &mut |_| Ok(chunks.next()), most_steps, groups).unwrap();
    let whole = Recording::new(&recording[..], &netlist(), u64::MAX);
    assert_eq!(path, whole.critical_path(netlist(), most_steps, groups, &mut ResimulationMemory::default()).unwrap());
    path
}

/// Returns the segments of a path as text.
fn parts(draw: &PlanBuilder) -> Vec<(String, u64)> {
    let word = |stretch: &PathSegment| match stretch {
        PathSegment::Occupancy(unit) => format!("occupancy {unit}"),
        PathSegment::Latency(unit) => format!("latency {unit}"),
        PathSegment::Fifo(fifo) => format!("fifo {fifo}"),
        PathSegment::Slot(fifo) => format!("slot {fifo}"),
        PathSegment::Memory(client, phase) => format!("{phase:?} {client}"),
        PathSegment::Rest => "rest".into(),
    };
    path_of(&draw.0, usize::MAX).unwrap().parts.iter().map(|part| (word(&part.stretch), part.cycles)).collect()
}

fn expect(draw: &PlanBuilder, expected: &[(&str, u64)]) {
    let mut found = parts(draw);
    let mut expected: Vec<(String, u64)> = expected.iter().map(|&(what, cycles)| (what.to_owned(), cycles)).collect();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
}

/// The middle unit works without a gap, from the first token to the last.
#[test]
fn always_busy_unit_is_the_path() {
    let draw = PlanBuilder::chain();
    expect(&draw, &[("fifo a", 1), ("occupancy work", 9), ("latency work", 2), ("fifo b", 1), ("occupancy sink", 1)]);
}

/// The same chain. The steps of each stage belong to tokens 0 to 3 in order.
// Claim: analysis: The critical path by polygon adds up to the path. A segment belongs to its first step.
#[test]
fn segment_belongs_to_its_first_step() {
    let draw = PlanBuilder::chain();
    let by_group = |groups: &[StageGroups]| path_by(&draw.0, usize::MAX, groups).unwrap().by_group;
    let tokens = vec![groups(0..4); 3];
    // Token 0 passes `a` and one step of `work`. The last token passes `work`, `b` and `sink`.
    assert_eq!(by_group(&tokens), [(0, 1 + 3), (1, 3), (2, 3), (3, 2 + 1 + 1)]);
    let whole = vec![groups([7; 4]); 3];
    assert_eq!(by_group(&whole), [(7, 14)]);
    assert_eq!(by_group(&[]), []);
    // A stage without groups has no steps to attribute. Its segments belong to the step before.
    assert_eq!(by_group(&[groups(0..4), StageGroups::default(), groups(0..4)]), [(0, 13), (3, 1)]);
}

fn groups(of: impl IntoIterator<Item = u32>) -> StageGroups {
    let mut groups = StageGroups::default();
    of.into_iter().for_each(|group| {
        groups.push(group);
    });
    groups
}

/// One slot: source at 0, 2, 4, sink at 1, 3, 5.
#[test]
fn single_slot_alternates_on_path() {
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 1, 1).unit("source", UnitKind::Source { tokens: 3 }, ["", "a"], &[1], &[0]).unit(
        "sink",
        UnitKind::Sink,
        ["a", ""],
        &[1],
        &[0],
    );
    expect(&draw, &[("fifo a", 3), ("slot a", 2), ("occupancy sink", 1)]);
}

/// The starts of `work` are too far apart for 32 bits. It is busy beyond the last token of `sink`.
#[test]
fn far_steps_are_on_the_path() {
    let longest = u32::MAX.into();
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 2, 1)
        .fifo("b", 2, 1)
        .unit("source", UnitKind::Source { tokens: 3 }, ["", "a"], &[1], &[0])
        .unit("work", UnitKind::Work, ["a", "b"], &[longest], &[0])
        .unit("sink", UnitKind::Sink, ["b", ""], &[1], &[0]);
    expect(&draw, &[("fifo a", 1), ("occupancy work", 3 * longest)]);
}

/// The first request is issued at 1, in view at 2, its row open at 4, its data complete at 9. The second is issued at 9 with the
/// returned credit. Its row is open, so its data are complete at 15.
#[test]
fn request_appears_phase_by_phase() {
    let request = |write| PlanRequest { port: "p".into(), write, bytes: 32, stride: 0, offset: 0, span: 64 };
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 2, 1)
        .fifo("b", 2, 1)
        .unit("source", UnitKind::Source { tokens: 2 }, ["", "a"], &[1], &[0])
        .unit("reader", UnitKind::Access { requests: vec![request(false)] }, ["a", "b"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["b", ""], &[1], &[0])
        .memory(small_memory(), &[("p", 1)]);
    let phases = [("Arrival p", 2), ("Bank p", 2), ("Data p", 10)];
    expect(&draw, &[&[("fifo a", 1), ("fifo b", 1), ("occupancy sink", 1)][..], &phases].concat());
    assert_eq!(run_both(&draw.0, u64::MAX).0.total, 17);
}

/// Token 0 misses at 1: in view at 2, row open at 4, data complete at 9, past the cache at 11. The data of token 1 are complete at 11,
/// too, but token 0 did not wait for them.
#[test]
fn request_behind_a_cache_is_its_own() {
    let look_up = PlanLookUp { stride: 32, offset: 0, span: 64 };
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 2, 1)
        .fifo("b", 2, 1)
        .unit("source", UnitKind::Source { tokens: 2 }, ["", "a"], &[1], &[0])
        .unit("reader", UnitKind::Cached { cache: "cache".into(), lookups: vec![look_up] }, ["a", "b"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["b", ""], &[20], &[0])
        .memory(small_memory(), &[("p", 2)])
        .cache(small_cache("p"));
    let phases = [("Arrival p", 1), ("Bank p", 2), ("Data p", 5), ("Cache p", 2)];
    expect(&draw, &[&[("fifo a", 1), ("fifo b", 1), ("occupancy sink", 40)][..], &phases].concat());
}

#[test]
fn too_many_steps_give_no_path() {
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 1, 1).unit("source", UnitKind::Source { tokens: 30 }, ["", "a"], &[1], &[0]).unit(
        "sink",
        UnitKind::Sink,
        ["a", ""],
        &[1],
        &[0],
    );
    assert_eq!(path_of(&draw.0, 59), None);
    assert!(path_of(&draw.0, 60).is_some());
}

/// Makes every unit and FIFO ideal that has no segment on the path.
fn rest_made_ideal(plan: &Plan, path: &CriticalPath) -> Plan {
    let is_on = |stretch: PathSegment| path.parts.iter().any(|part| part.stretch == stretch);
    let mut plan = plan.clone();
    for unit in &mut plan.units {
        if !is_on(PathSegment::Occupancy(unit.name.clone())) && !is_on(PathSegment::Latency(unit.name.clone())) {
            (unit.occupancy, unit.latency) = (vec![1], vec![0]);
        }
    }
    for fifo in &mut plan.fifos {
        if !is_on(PathSegment::Slot(fifo.name.clone())) {
            fifo.depth += 7;
        }
    }
    plan
}

proptest! {
    #[test]
    fn path_is_as_long_as_run(recipe in recipe()) {
        let (plan, _) = recipe.plan();
        let report = run_both(&plan, u64::MAX).0;
        let path = path_of(&plan, usize::MAX);
        prop_assert_eq!(path.is_some(), report.outcome == Outcome::Complete);
        if let Some(path) = path {
            prop_assert_eq!(path.cycles, report.total);
            prop_assert_eq!(path.parts.iter().map(|part| part.cycles).sum::<u64>(), report.total);
            prop_assert!(path.parts.iter().all(|part| part.by_mark.iter().sum::<u64>() == part.cycles));
            prop_assert!(path.parts.is_sorted_by_key(|part| std::cmp::Reverse(part.cycles)));
            let steps: Vec<StageGroups> = report.units.iter().map(|unit| groups((0..unit.steps).map(|n| n as u32 / 3))).collect();
            let by_group = path_by(&plan, usize::MAX, &steps).unwrap().by_group;
            prop_assert_eq!(by_group.iter().map(|(_, cycles)| cycles).sum::<u64>(), report.total);
        }
    }

    /// The path bounds the run from below: the run gets no shorter unless a segment on the path does. (With shared memories, a
    /// faster unit may change the order of requests. The test therefore has no memories.)
    #[test]
    fn unit_off_the_path_limits_nothing(recipe in recipe()) {
        let mut recipe = recipe;
        recipe.parts.retain(|part| !matches!(part, crate::common::random::GraphPart::Access { .. } | crate::common::random::GraphPart::Cached { .. }));
        let (plan, _) = recipe.plan();
        let report = run_both(&plan, u64::MAX).0;
        if let Some(path) = path_of(&plan, usize::MAX) {
            let ideal = rest_made_ideal(&plan, &path);
            prop_assert_eq!(run_both(&ideal, u64::MAX).0.total, report.total);
        }
    }
}
