//! Recordings: execution does not depend on time, and timing follows from a recording.

use crate::common::random::{Recipe, recipe};
use crate::common::{PlanBuilder, machine, record_plan, run_both, streams};
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{
    Netlist, Outcome, Recording, ResimulateError, ResimulationMemory, RunReport, make_steps, resimulate, time_steps,
};
use basrelief_kernel_conformance::plan::{Plan, UnitKind};
use proptest::collection::vec;
use proptest::prelude::*;
use std::borrow::Cow;

/// Returns the same units with the FIFOs, memories and caches of another recipe.
fn other_times(plan: &Plan, other: &Recipe) -> Plan {
    let mut plan = plan.clone();
    for (fifo, &(depth, latency)) in plan.fifos.iter_mut().zip(other.fifos.iter().cycle()) {
        (fifo.depth, fifo.latency) = (depth, latency);
    }
    for (memory, from) in plan.memories.iter_mut().zip(&other.memories) {
        memory.config = from.config.clone();
    }
    for (cache, &(depth, latency)) in plan.caches.iter_mut().zip(other.fifos.iter().cycle()) {
        (cache.sets, cache.ways) = (depth as u32, latency as u32);
        (cache.hit_latency, cache.lookups_per_cycle) = (latency as u32, depth as u32);
    }
    plan
}

fn timed_again(recording: &[RecordingChunk], plan: &Plan) -> Result<RunReport, ResimulateError> {
    let mut chunks = recording.iter().map(Cow::Borrowed);
    resimulate(Netlist::of(&mut machine(plan)).unwrap(), &mut |_| Ok(chunks.next()), u64::MAX)
}

proptest! {
    /// Law 6 for the units of plans: their work is the same under any timing.
    #[test]
    fn recording_is_independent_of_timing(recipe in recipe(), other in recipe()) {
        let (plan, _) = recipe.plan();
        let slower = other_times(&plan, &other);
        let [here, there] = [&plan, &slower].map(|plan| run_both(plan, u64::MAX).0.outcome);
        if [here, there] == [Outcome::Complete, Outcome::Complete] {
            prop_assert_eq!(streams(&record_plan(&plan, u64::MAX)), streams(&record_plan(&slower, u64::MAX)));
        }
    }

    #[test]
    fn resimulation_equals_run(recipe in recipe(), other in recipe()) {
        let (plan, _) = recipe.plan();
        let slower = other_times(&plan, &other);
        let (recorded, ran) = (run_both(&plan, u64::MAX).0, run_both(&slower, u64::MAX).0);
        match timed_again(&record_plan(&plan, u64::MAX), &slower) {
            Ok(again) => prop_assert_eq!(again, ran),
            // The recorded run ended in a deadlock, but with the new timing the run would continue.
            Err(error) => prop_assert!(
                matches!(error, ResimulateError::EndsEarly(_)) && recorded.outcome != Outcome::Complete, "{}", error
            ),
        }
    }

    /// One shared `Recording` gives the same full report, and the same cycles, as a new resimulation.
    #[test]
    fn shared_recording_gives_same_report_each_time(recipe in recipe(), other in recipe()) {
        let (plan, _) = recipe.plan();
        let recorded = record_plan(&plan, u64::MAX);
        let shape = |plan: &Plan| Netlist::of(&mut machine(plan)).unwrap();
        let (held, mut memory) = (Recording::new(&recorded[..], &shape(&plan), u64::MAX), ResimulationMemory::default());
        for plan in [&plan, &other_times(&plan, &other)] {
            let report = timed_again(&recorded, plan);
            let complete = |report: &RunReport| (report.outcome == Outcome::Complete).then(|| report.marked_cycles());
            prop_assert_eq!(held.cycles(shape(plan), &mut memory), report.as_ref().map(complete).map_err(Clone::clone));
            prop_assert_eq!(held.resimulate(shape(plan), &mut memory), report);
        }
    }

    #[test]
    fn chunks_round_trip_through_bytes(recipe in recipe()) {
        for chunk in record_plan(&recipe.plan().0, u64::MAX) {
            prop_assert_eq!(RecordingChunk::from_bytes(&chunk.to_bytes()), Ok(chunk));
        }
    }

    /// Resimulation of any corrupt recording ends with a report or an error.
    #[test]
    fn corrupt_recording_causes_no_panic(recipe in recipe(), changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut: bool) {
        let (plan, _) = recipe.plan();
        let mut spoiled = Vec::new();
        for chunk in record_plan(&plan, u64::MAX) {
            let mut bytes = chunk.to_bytes();
            for (index, byte) in &changes {
                let at = index.index(bytes.len());
                bytes[at] = *byte;
            }
            if cut {
                bytes.truncate(changes[0].0.index(bytes.len()));
            }
            spoiled.extend(RecordingChunk::from_bytes(&bytes));
        }
        let mut chunks = spoiled.into_iter().map(Cow::Owned);
        let shape = Netlist::of(&mut machine(&plan)).unwrap();
        // A cycle limit, because a corrupt step may occupy its unit for 2^32 cycles. The content of the report does not matter.
        let _ = resimulate(shape, &mut |_| Ok(chunks.next()), 1 << 20);
    }
}

#[test]
fn stopped_work_is_timed_up_to_its_end() {
    let mut plan = PlanBuilder::chain().0;
    plan.units[0].kind = UnitKind::Source { tokens: 400 };
    let whole = run_both(&plan, u64::MAX).0;
    let mut batches = Vec::new();
    make_steps(&mut machine(&plan), &mut |_| false, 40, &mut |batch| batches.push(batch)).unwrap();
    let mut batches = batches.into_iter();
    let stopped = time_steps(Netlist::of(&mut machine(&plan)).unwrap(), &mut || batches.next(), None);
    assert_eq!(stopped.outcome, Outcome::Stopped);
    let steps = |report: &RunReport| report.units.iter().map(|unit| unit.steps).sum::<u64>();
    assert!(0 < steps(&stopped) && steps(&stopped) < steps(&whole), "{stopped:?}");
}

/// Batches stay small even if long FIFOs allow many steps ahead.
#[test]
fn step_batches_are_small() {
    let mut plan = PlanBuilder::chain().0;
    plan.units[0].kind = UnitKind::Source { tokens: 5_000 };
    plan.fifos.iter_mut().for_each(|fifo| fifo.depth = 10_000);
    let mut batches = Vec::new();
    make_steps(&mut machine(&plan), &mut |_| true, 40, &mut |batch| batches.push(batch.steps())).unwrap();
    assert_eq!(batches.iter().sum::<usize>(), 3 * 5_000);
    assert!(batches.iter().all(|steps| *steps <= 40 + 3 * 10), "{batches:?}");
}

#[test]
fn truncated_recording_names_unit_that_could_continue() {
    let plan: Plan = serde_json::from_str(include_str!("laws/merged_late.json")).unwrap();
    let whole = record_plan(&plan, u64::MAX);
    let cut = record_plan(&plan, run_both(&plan, u64::MAX).0.total / 2);
    assert!(timed_again(&whole, &plan).is_ok());
    let Err(ResimulateError::EndsEarly(unit)) = timed_again(&cut, &plan) else { panic!("expected an early end") };
    assert!(plan.units.iter().any(|u| u.name == unit), "{unit}");
}

#[test]
fn netlist_detects_other_work() {
    let plan: Plan = serde_json::from_str(include_str!("laws/merged_late.json")).unwrap();
    let shape = |plan: &Plan| Netlist::of(&mut machine(plan)).unwrap();
    let mut longer = plan.clone();
    longer.caches[0].line_bytes *= 2;
    assert_eq!(shape(&plan).same_work(&shape(&plan)), Ok(()));
    assert_eq!(shape(&plan).same_work(&shape(&longer)), Err("the lines of its caches are others".into()));
    let mut renamed = plan.clone();
    renamed.units[0].name = "other".into();
    assert!(shape(&plan).same_work(&shape(&renamed)).unwrap_err().contains("there is `other`"));
}
