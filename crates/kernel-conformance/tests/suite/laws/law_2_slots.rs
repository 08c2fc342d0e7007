//! Law 2: a slot is reserved at the start of the step that fills it, and is free again the cycle after the pop. Full rate needs
//! depth >= ceil((latency + f + 1) / occupancy).

use crate::common::{PlanBuilder, starts};
use basrelief_kernel_conformance::plan::{Plan, UnitKind};

fn wire(depth: usize, f: u64, occupancy: u64, latency: u64, tokens: u64) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("f", depth, f).unit("source", UnitKind::Source { tokens }, ["", "f"], &[occupancy], &[latency]).unit(
        "sink",
        UnitKind::Sink,
        ["f", ""],
        &[1],
        &[0],
    );
    draw.0
}

// Claim: laws, 2 Slots: A slot is held from the start of the step through the pop, which gives the depth for full rate.
#[test]
fn slot_is_held_from_start_through_pop() {
    // Latency 5, f = 1. A token that starts at s is visible and popped at s + 6, and its slot is free at s + 7. Two slots
    // therefore give starts 0 and 1, then 7 and 8, and so on.
    assert_eq!(starts(&wire(2, 1, 1, 5, 6), "source"), [0, 1, 7, 8, 14, 15]);
}

// Claim: as slot_is_held_from_start_through_pop.
#[test]
fn full_rate_needs_exactly_the_depth_of_law_2() {
    for (f, occupancy, latency) in [(1, 1, 0), (1, 1, 5), (3, 1, 0), (2, 2, 5), (1, 3, 10), (1, 4, 0)] {
        let depth = (latency + f + 1_u64).div_ceil(occupancy) as usize;
        let full_rate: Vec<u64> = (0..40).map(|n| n * occupancy).collect();
        assert_eq!(starts(&wire(depth, f, occupancy, latency, 40), "source"), full_rate, "depth {depth}");
        if depth > 1 {
            assert_ne!(starts(&wire(depth - 1, f, occupancy, latency, 40), "source"), full_rate, "depth {}", depth - 1);
        }
    }
}

// Claim: as slot_is_held_from_start_through_pop.
#[test]
fn deep_fifo_holds_its_producer_back_when_full() {
    const DEPTH: usize = 520;
    let mut plan = wire(DEPTH, 1, 1, 0, 1500);
    plan.units[1].occupancy = vec![3];
    let (mut expected, mut pops): (Vec<u64>, Vec<u64>) = (vec![], vec![]);
    for n in 0..1500 {
        let slot = if n < DEPTH { 0 } else { pops[n - DEPTH] + 1 };
        expected.push(slot.max(expected.last().map_or(0, |start| start + 1)));
        pops.push((expected[n] + 1).max(pops.last().map_or(0, |pop| pop + 3)));
    }
    assert!(expected[1499] > 1499, "the FIFO was full");
    assert_eq!(starts(&plan, "source"), expected);
}
