//! Law 1: depth >= 1, latency f >= 1. A token delivered at d is visible from max(d + f, visible time of the token before it + 1).
//! Tokens never overtake.

use crate::common::{PlanBuilder, report, run_both, sink_tokens, starts};
use basrelief_kernel::Fifo;
use basrelief_kernel_conformance::plan::{Plan, PlanMachine, UnitKind};

/// A source, one FIFO and a sink. The source delivers token n `latency[n]` cycles after its start.
fn wire(depth: usize, fifo_latency: u64, latency: &[u64]) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("f", depth, fifo_latency)
        .unit("source", UnitKind::Source { tokens: latency.len() as u64 }, ["", "f"], &[1], latency)
        .unit("sink", UnitKind::Sink, ["f", ""], &[1], &[0]);
    draw.0
}

// Claim: laws, 1 FIFO: A token is visible f cycles after its delivery, and tokens keep their order.
#[test]
fn token_is_visible_f_cycles_after_delivery() {
    // StepStarts 0, 1, 2; delivered 0, 1, 2; visible 5, 6, 7.
    assert_eq!(starts(&wire(8, 5, &[0, 0, 0]), "sink"), [5, 6, 7]);
}

// Claim: as token_is_visible_f_cycles_after_delivery.
#[test]
fn tokens_never_overtake() {
    // StepStarts 0, 1, 2, 3; delivered 9, 1, 2, 10; d + f = 11, 3, 4, 12. Token 1 waits for token 0: 11 + 1. Token 2 waits for token
    // 1: 12 + 1. Token 3 waits for token 2: 13 + 1.
    let plan = wire(8, 2, &[9, 0, 0, 7]);
    assert_eq!(starts(&plan, "sink"), [11, 12, 13, 14]);
    let [timed, _] = sink_tokens(&plan);
    assert!(timed[0].1.iter().map(|t| t.id).eq(0..4));
}

#[test]
fn one_token_becomes_visible_per_cycle() {
    // Delivered 6, 6, 6, 6: visible 7, 8, 9, 10.
    assert_eq!(starts(&wire(8, 1, &[6, 5, 4, 3]), "sink"), [7, 8, 9, 10]);
}

#[test]
fn token_of_periodic_fifo_waits_for_next_multiple() {
    // Delivered 0, 1, 2, 18; d + f = 1, 2, 3, 19. Period 5: the next multiples are 5, then not before 6 and 11: 10 and 15, then 20.
    let mut plan = wire(8, 1, &[0, 0, 0, 15]);
    plan.fifos[0].period = 5;
    assert_eq!(starts(&plan, "sink"), [5, 10, 15, 20]);
    let histogram = report(&plan).fifos[0].histogram.clone();
    // Reserved at 0, 1, 2, 3, popped at 5, 10, 15, 20.
    assert_eq!(histogram[..5], [0, 6, 6, 6, 3]);
}

#[test]
#[should_panic(expected = "FIFO f: period 0, expected at least 1 (law 1)")]
fn period_0_is_rejected() {
    let _ = Fifo::<u8>::new("f", 1, 1).with_period(0);
}

#[test]
#[should_panic(expected = "FIFO f: depth 0, expected at least 1 (law 1)")]
fn depth_0_is_rejected() {
    Fifo::<u8>::new("f", 0, 1);
}

#[test]
#[should_panic(expected = "FIFO f: latency 0, expected at least 1 (law 1)")]
fn latency_0_is_rejected() {
    Fifo::<u8>::new("f", 1, 0);
}

#[test]
fn plan_with_depth_or_latency_0_is_rejected_by_name() {
    let error = |depth, latency| PlanMachine::new(&wire(depth, latency, &[0])).unwrap_err().to_string();
    assert_eq!(error(0, 1), "FIFO `f`: `depth` is 0, expected 1..=1048576");
    assert_eq!(error(1, 0), "FIFO `f`: `latency` is 0, expected 1..=1099511627776");
}

#[test]
fn token_is_visible_until_its_pop() {
    let mut draw = PlanBuilder::default();
    draw.fifo("f", 1, 1).unit("source", UnitKind::Source { tokens: 3 }, ["", "f"], &[1], &[0]).unit(
        "sink",
        UnitKind::Sink,
        ["f", ""],
        &[4],
        &[0],
    );
    let (_, seen) = run_both(&draw.0, u64::MAX);
    let visible: Vec<(u64, usize)> = seen.visible[0].iter().map(|(at, tokens)| (at.0, *tokens)).collect();
    // Starts at 0, 2 and 6, when the slot is free. Pops at 1, 5 and 9.
    assert_eq!(visible, [(1, 1), (2, 0), (3, 1), (6, 0), (7, 1), (10, 0)]);
}
