//! Law 5: the look-ups of a step are its distinct lines, made at its start or at so many per cycle. Tags run ahead of the data, and
//! answers arrive in order.
//!
//! The memory is that of law 4, with lines of 32 bytes and a hit latency of 2.

use crate::common::{PlanBuilder, report, run_both, small_cache, small_memory, starts};
use basrelief_kernel::CacheCounts;
use basrelief_kernel_conformance::plan::{Plan, PlanCache, PlanLookUp, UnitKind};

fn look_up(stride: u64, offset: u64) -> PlanLookUp {
    PlanLookUp { stride, offset, span: 1 << 20 }
}

fn client(tokens: u64, (sets, ways, per_cycle): (u32, u32, u32), lookups: Vec<PlanLookUp>) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .memory(small_memory(), &[("p", 8)])
        .cache(PlanCache { sets, ways, lookups_per_cycle: per_cycle, ..small_cache("p") })
        .unit("source", UnitKind::Source { tokens }, ["", "in"], &[1], &[0])
        .unit("client", UnitKind::Cached { cache: "cache".into(), lookups }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    draw.0
}

fn counts(plan: &Plan) -> CacheCounts {
    report(plan).caches[0].counts
}

// Claim: laws, 5 Cache: A miss goes to memory, and a line in flight is merged. A hit behind a miss waits.
#[test]
fn miss_goes_to_memory_and_line_in_flight_is_merged() {
    // Three steps, at 1, 2, 3, all of line 0. Miss: closed, column 4, data 7 .. 9, + 2: delivered 11, visible 12. The other steps
    // find the line in flight. Their answer is also at max(9, start) + 2 = 11, and they become visible one after the other.
    let plan = client(3, (4, 1, 1), vec![look_up(0, 0)]);
    assert_eq!(starts(&plan, "sink"), [12, 13, 14]);
    assert_eq!(counts(&plan), CacheCounts { hits: 0, misses: 1, merged: 2 });
}

#[test]
fn look_up_is_judged_in_its_own_cycle() {
    // Step 0 at 1 looks up line 5 at 1 and line 0 one cycle later. Line 5: closed, column 4. Line 0: conflict, precharged at 4,
    // column 10, data 13 .. 15. Step 1 at 14 looks up another line and then line 0: at 14 in flight, at 15 a hit.
    let lookups = vec![look_up(160, 160), look_up(0, 0)];
    for (at_once, hits) in [(true, 0), (false, 1)] {
        let mut plan = client(2, (16, 1, 1), lookups.clone());
        plan.caches[0].at_once = at_once;
        plan.units[0].occupancy = vec![13];
        assert_eq!(starts(&plan, "client"), [1, 14]);
        assert_eq!(counts(&plan), CacheCounts { hits, misses: 3, merged: 1 - hits });
    }
}

#[test]
fn answer_counts_from_the_last_look_up() {
    // Step 0 at 1 misses four lines of two rows; the last answer is long before step 1, at 101, which hits all. Two look-ups per
    // cycle: the last is at 102, answered at 104, visible 105.
    let lookups = (0..4).map(|line| look_up(0, 32 * line)).collect::<Vec<_>>();
    for (at_once, visible) in [(true, 104), (false, 105)] {
        let mut plan = client(2, (4, 1, 2), lookups.clone());
        plan.caches[0].at_once = at_once;
        plan.units[0].occupancy = vec![100];
        assert_eq!(starts(&plan, "sink")[1], visible);
    }
}

#[test]
fn present_line_is_a_hit() {
    // The source delivers token 1 at 8. Its step is at 9, when the line has arrived: a hit, delivered 9 + 2 = 11. That is the
    // cycle of the miss, so it is visible one cycle later. A step one cycle earlier would be merged, with the same times.
    for (occupancy, expected) in [(8, (1, 0)), (7, (0, 1))] {
        let mut plan = client(2, (4, 1, 1), vec![look_up(0, 0)]);
        plan.units[0].occupancy = vec![occupancy];
        assert_eq!(starts(&plan, "client"), [1, 1 + occupancy]);
        assert_eq!(starts(&plan, "sink"), [12, 13]);
        let counts = counts(&plan);
        assert_eq!((counts.hits, counts.merged), expected);
    }
}

// Claim: as miss_goes_to_memory_and_line_in_flight_is_merged.
#[test]
fn hit_behind_miss_waits() {
    // Token 0 misses line 0. Token 1 misses line 1 much later. Token 2, at 32, hits line 0, but its answer waits for that of line
    // 1.
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
    // One set of two ways. Steps look up lines 0 1, 0 2, 0 3. Each uses line 0, so line 2 replaces 1, and line 3 replaces 2.
    // Replacement of the oldest line would replace line 0 by line 2, and miss line 0 twice more.
    let plan = client(3, (1, 2, 1), vec![look_up(0, 0), look_up(32, 32)]);
    assert_eq!(counts(&plan).misses, 4);
    // Lines 0 2 1 0 2 1 in two ways: each line is replaced just before its next look-up.
    let round = PlanLookUp { stride: 64, offset: 0, span: 96 };
    assert_eq!(counts(&client(6, (1, 2, 1), vec![round.clone()])).misses, 6);
    assert_eq!(counts(&client(6, (1, 3, 1), vec![round])).misses, 3);
}

#[test]
fn line_replaced_in_flight_is_a_new_miss() {
    // One line in total: 0, 1, 0. The first fill of line 0 is in flight when line 1 replaces it.
    let plan = client(3, (1, 1, 1), vec![PlanLookUp { span: 64, ..look_up(32, 0) }]);
    // Columns 4, 6, 8: data 7 .. 9, 9 .. 11, 11 .. 13; + 2, visible one cycle later.
    assert_eq!(starts(&plan, "sink"), [12, 14, 16]);
    assert_eq!(counts(&plan), CacheCounts { hits: 0, misses: 3, merged: 0 });
}

#[test]
fn look_ups_per_cycle_limit_the_rate() {
    // Five distinct lines (one occurs twice) at two per cycle take three cycles per step.
    let lines = [0, 32, 64, 0, 96, 128].map(|offset| look_up(0, offset)).to_vec();
    let mut plan = client(3, (8, 1, 2), lines);
    plan.memories[0].ports[0].outstanding = 32;
    assert_eq!(starts(&plan, "client"), [1, 4, 7]);
}

#[test]
fn merged_look_up_may_be_older_than_credits() {
    // A unit with four credits shares its memory with another unit. Step 1 requests line 1, and the next step looks it up again.
    // Later steps issue five more requests before the answers are known. The second look-up must count as merged, not as a hit.
    let text = include_str!("merged_late.json");
    let plan: Plan = serde_json::from_str(text).unwrap();
    let (report, _) = run_both(&plan, u64::MAX);
    assert_eq!(report.caches[0].counts, CacheCounts { hits: 1, misses: 6, merged: 2 });
}
