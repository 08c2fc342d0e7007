//! One look-up per cache port and cycle, all of a step's distinct lines at its start; tags run ahead of the data,
//! answers come in order.
//!
//! The memory as for law 4; lines of 32 bytes; hit latency 2.

use super::common::{Draw, report, run_both, small_memory, starts};
use basrelief_kernel::CacheCounts;
use basrelief_kernel_conformance::plan::{Kind, Plan, PlanCache, PlanLookUp};

fn look_up(stride: u64, offset: u64) -> PlanLookUp {
    PlanLookUp { stride, offset, span: 1 << 20 }
}

fn client(tokens: u64, (sets, ways, per_cycle): (u32, u32, u32), lookups: Vec<PlanLookUp>) -> Plan {
    let (name, port) = ("cache".into(), "p".into());
    let mut draw = Draw::default();
    draw.fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .memory(small_memory(), &[("p", 8)])
        .cache(PlanCache { name, port, line_bytes: 32, sets, ways, hit_latency: 2, lookups_per_cycle: per_cycle })
        .unit("source", Kind::Source { tokens }, ["", "in"], &[1], &[0])
        .unit("client", Kind::Cached { cache: "cache".into(), lookups }, ["in", "out"], &[1], &[0])
        .unit("sink", Kind::Sink, ["out", ""], &[1], &[0]);
    draw.0
}

fn counts(plan: &Plan) -> CacheCounts {
    report(plan).caches[0].counts
}

#[test]
fn miss_goes_to_memory_and_line_in_flight_is_merged() {
    // Three steps, at 1, 2, 3, all of line 0. Miss: closed, column 4, data 7 .. 9, + 2: delivered 11, visible 12. The
    // others find the line in flight: max(9, their start) + 2 = 11 as well, visible one after the other.
    let plan = client(3, (4, 1, 1), vec![look_up(0, 0)]);
    assert_eq!(starts(&plan, "sink"), [12, 13, 14]);
    assert_eq!(counts(&plan), CacheCounts { hits: 0, misses: 1, merged: 2 });
}

#[test]
fn present_line_is_a_hit() {
    // The source lets token 1 go at 8: its step is at 9, when the answer is there: a hit, delivered 9 + 2 = 11 - in the
    // cycle of the miss, so visible one later. One cycle sooner it is merged, with the same times.
    for (occupancy, expected) in [(8, (1, 0)), (7, (0, 1))] {
        let mut plan = client(2, (4, 1, 1), vec![look_up(0, 0)]);
        plan.units[0].occupancy = vec![occupancy];
        assert_eq!(starts(&plan, "client"), [1, 1 + occupancy]);
        assert_eq!(starts(&plan, "sink"), [12, 13]);
        let counts = counts(&plan);
        assert_eq!((counts.hits, counts.merged), expected);
    }
}

#[test]
fn hit_behind_miss_waits() {
    // Token 0 misses line 0, token 1 line 1, long after; token 2, at 32, hits line 0 but answers behind line 1.
    let mut plan = client(3, (4, 1, 1), vec![PlanLookUp { span: 64, ..look_up(32, 0) }]);
    plan.units[0].occupancy = vec![30, 1, 1];
    // Line 1: step at 31, hit, column 32, data 35 .. 37, delivered 39, visible 40. Line 0: 32 + 2 = 34, but in order:
    // 39, visible 41.
    assert_eq!(starts(&plan, "client"), [1, 31, 32]);
    assert_eq!(starts(&plan, "sink"), [12, 40, 41]);
    assert_eq!(counts(&plan), CacheCounts { hits: 1, misses: 2, merged: 0 });
}

#[test]
fn least_recently_used_line_is_replaced() {
    // One set of two ways. Steps look up lines 0 1, 0 2, 0 3: line 0 is used in each, so 2 replaces 1 and 3 replaces 2.
    // Oldest first would lose line 0 to line 2, and miss it twice more.
    let plan = client(3, (1, 2, 1), vec![look_up(0, 0), look_up(32, 32)]);
    assert_eq!(counts(&plan).misses, 4);
    // Lines 0 2 1 0 2 1 in two ways: each was replaced just before it is asked for again.
    let round = PlanLookUp { stride: 64, offset: 0, span: 96 };
    assert_eq!(counts(&client(6, (1, 2, 1), vec![round.clone()])).misses, 6);
    assert_eq!(counts(&client(6, (1, 3, 1), vec![round])).misses, 3);
}

#[test]
fn line_replaced_in_flight_is_a_new_miss() {
    // One line in all: 0, 1, 0. The first fill of line 0 is under way when line 1 takes its place.
    let plan = client(3, (1, 1, 1), vec![PlanLookUp { span: 64, ..look_up(32, 0) }]);
    // Columns 4, 6, 8: data 7 .. 9, 9 .. 11, 11 .. 13; + 2, visible one later.
    assert_eq!(starts(&plan, "sink"), [12, 14, 16]);
    assert_eq!(counts(&plan), CacheCounts { hits: 0, misses: 3, merged: 0 });
}

#[test]
fn look_ups_per_cycle_limit_the_rate() {
    // Five distinct lines (one twice) at two per cycle: three cycles per step.
    let lines = [0, 32, 64, 0, 96, 128].map(|offset| look_up(0, offset)).to_vec();
    let mut plan = client(3, (8, 1, 2), lines);
    plan.memories[0].ports[0].outstanding = 32;
    assert_eq!(starts(&plan, "client"), [1, 4, 7]);
}

#[test]
fn merged_look_up_may_be_older_than_credits() {
    // A unit with four credits, whose memory another shares: line 1 is asked for in step 1 and looked up again in the
    // next, while later steps have issued five more requests by the time the answers are known. Once this was taken for
    // a hit.
    let text = include_str!("merged_late.json");
    let plan: Plan = serde_json::from_str(text).unwrap();
    let (report, _) = run_both(&plan, u64::MAX);
    assert_eq!(report.caches[0].counts, CacheCounts { hits: 1, misses: 6, merged: 2 });
}
