//! Law 10: occupancy = slots reserved or filled, from reservation through pop. The histogram sums to the total.

use crate::common::{PlanBuilder, histogram, report, run_both};
use basrelief_kernel_conformance::plan::{Plan, UnitKind};

fn wire(depth: usize, tokens: u64, source: (u64, u64), sink: u64) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("f", depth, 1).unit("source", UnitKind::Source { tokens }, ["", "f"], &[source.0], &[source.1]).unit(
        "sink",
        UnitKind::Sink,
        ["f", ""],
        &[sink],
        &[0],
    );
    draw.0
}

// Claim: laws, 10 Occupancy: A slot counts as occupied from reservation through pop.
#[test]
fn slot_counts_from_reservation_through_pop() {
    // StepStarts 2 x n, latency 3, visible and popped 4 later. Each token occupies a slot for 5 cycles: 0..=4, 2..=6, 4..=8. Occupied
    // slots in cycles 0 .. 8: 1 1 2 2 3 2 2 1 1.
    assert_eq!(histogram(&report(&wire(4, 3, (2, 3), 1)), "f"), [0, 4, 4, 1, 0]);
}

#[test]
fn slot_freed_then_reserved_next_cycle_is_never_empty() {
    // Two slots, latency 5: starts 0 1 7 8 14 15, pops 6 7 13 14 20 21. One slot is occupied in 0 and 21, two in between.
    assert_eq!(histogram(&report(&wire(2, 6, (1, 5), 1)), "f"), [0, 2, 20]);
}

#[test]
fn token_left_inside_counts_to_the_end() {
    // The sink takes 10 cycles per token: pops at 1, 11, 21; starts 0, 1, 2 in four slots. Total 31.
    // Occupied: 1 in 0; 2 in 1 (token 0 until its pop) and 2 .. 11; 1 in 12 .. 21; none in 22 .. 30.
    assert_eq!(histogram(&report(&wire(4, 3, (1, 0), 10)), "f"), [9, 11, 11, 0, 0]);
}

#[test]
fn high_water_mark_is_maximum_level() {
    let report = report(&wire(8, 20, (1, 0), 3));
    assert_eq!(report.fifos[0].high_water(), 8);
    assert_eq!(report.fifos[0].histogram.iter().sum::<u64>(), report.total);
}

/// A flip keeps the ticked engine going after the run of 4083 cycles. In cycle 4096 it shows levels to the probe, but none that changed
/// after the end.
#[test]
fn no_level_changes_after_the_end() {
    let plan: Plan = serde_json::from_str(include_str!("busy_after_the_end.json")).unwrap();
    assert_eq!(run_both(&plan, u64::MAX).0.total, 4083);
}
