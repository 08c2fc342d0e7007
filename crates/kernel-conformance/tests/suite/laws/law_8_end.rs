//! Law 8: the run ends when every unit's next start is unknown, never after a number of idle cycles. It is complete, or it is a
//! deadlock with a fixed text. Total = 1 + the last cycle in which a unit was busy, a token became visible, or a memory moved
//! data.

use crate::common::{PlanBuilder, account, report, run_both, small_memory};
use basrelief_kernel::{BlockedUnit, Engine, FifoLevel, Outcome, RunLimits, WaitsFor, run_with};
use basrelief_kernel_conformance::plan::{Plan, PlanMemory, PlanPeriodic, UnitKind};

fn wire(tokens: u64, source: (u64, u64), sink: u64) -> Plan {
    let mut draw = PlanBuilder::default();
    draw.fifo("f", 1, 1).unit("source", UnitKind::Source { tokens }, ["", "f"], &[source.0], &[source.1]).unit(
        "sink",
        UnitKind::Sink,
        ["f", ""],
        &[sink],
        &[0],
    );
    draw.0
}

/// A fork and a join with two branches. One branch works in batches of four, the other is a FIFO with `depth` slots.
fn batch_beside(depth: usize) -> Plan {
    let mut draw = PlanBuilder::default();
    for fifo in ["in", "a", "middle", "a2", "out"] {
        draw.fifo(fifo, 1, 1);
    }
    draw.fifo("b", depth, 1)
        .unit("source", UnitKind::Source { tokens: 8 }, ["", "in"], &[1], &[0])
        .unit("fork", UnitKind::Fork, ["in", "a b"], &[1], &[0])
        .unit("gather", UnitKind::Gather { size: 4 }, ["a", "middle"], &[1], &[0])
        .unit("expand", UnitKind::Expand { factor: 4 }, ["middle", "a2"], &[1], &[0])
        .unit("join", UnitKind::Join, ["a2 b", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    draw.0
}

#[test]
fn periodic_client_keeps_no_run_alive() {
    let mut plan = wire(1, (1, 0), 7);
    let periodic = PlanPeriodic { name: "v".into(), period: 3, bytes: 4, stride: 0, span: 4 };
    plan.memories.push(PlanMemory { periodic: vec![periodic], ..small_memory() });
    let report = report(&plan);
    // The token is visible and popped at 1, and occupies the sink until 8. Requests arrive at 0, 3 and 6.
    assert_eq!((&report.outcome, report.total), (&Outcome::Complete, 8));
    assert_eq!(report.memories[0].ports[0].counts.reads, 3);
}

// Claim: laws, 8 End: Idle time does not end a run. A deadlock names units, FIFOs and occupancy.
#[test]
fn idle_stretches_do_not_end_a_run() {
    // One slot: starts 0, 50,002 and 100,004. Each token is visible and popped 50,001 later, and occupies the sink for 7 cycles.
    let report = report(&wire(3, (1, 50_000), 7));
    assert_eq!((&report.outcome, report.total), (&Outcome::Complete, 150_005 + 7));
}

#[test]
fn long_idle_stretches_do_not_end_a_run() {
    // As above, with 2^40 instead of 50,000.
    let mut machine = crate::common::machine(&wire(3, (1, 1 << 40), 7));
    let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_: &mut _| true };
    let report = run_with(&mut machine, Engine::Timed, None, limits);
    assert_eq!((report.outcome, report.total), (Outcome::Complete, 3 * (1 << 40) + 5 + 7));
}

#[test]
fn empty_run_takes_one_cycle() {
    let report = report(&wire(0, (1, 0), 1));
    assert_eq!((&report.outcome, report.total), (&Outcome::Complete, 1));
    assert_eq!(account(&report, "source"), "busy 0, done 1");
}

#[test]
fn last_busy_cycle_counts() {
    // One token at 0, visible and popped at 1. It occupies the source for 9 cycles, 0 .. 8.
    assert_eq!(report(&wire(1, (9, 0), 1)).total, 9);
    assert_eq!(report(&wire(1, (1, 0), 9)).total, 10);
}

// Claim: as idle_stretches_do_not_end_a_run.
#[test]
fn deadlock_names_units_fifos_and_levels() {
    // `fork` steps at 1 and 3, then `b` is full. `in` receives its third token at 4, visible at 5: 6 cycles. `gather` holds two
    // tokens of four. The other two never arrive.
    let report = report(&batch_beside(2));
    let Outcome::Deadlock(deadlock) = &report.outcome else { panic!("{:?}", report.outcome) };
    assert_eq!(
        deadlock.to_string(),
        "deadlock after 6 cycles: `source` waits for a slot in `in` (1 of 1 slots); \
         `fork` waits for a slot in `b` (2 of 2 slots); `gather` waits for a token from `a` (0 of 1 slots); \
         `expand` waits for a token from `middle` (0 of 1 slots); `join` waits for a token from `a2` (0 of 1 slots); \
         `sink` waits for a token from `out` (0 of 1 slots). \
         Give the FIFO that is full more slots (fifo.<name>.depth)"
    );
    assert_eq!(report.outcome, run_both(&batch_beside(2), 1000).0.outcome);
    // The same as data: the missing slots, and the circular wait.
    let full = FifoLevel { fifo: "b".into(), held: 2, depth: 2 };
    assert_eq!(deadlock.stuck[1], BlockedUnit { unit: "fork".into(), waits_for: WaitsFor::Slot(full) });
    assert_eq!(deadlock.circle, ["fork", "join", "expand", "gather"]);
}

#[test]
fn enough_slots_resolve_the_deadlock() {
    assert_eq!(report(&batch_beside(4)).outcome, Outcome::Complete);
}

#[test]
fn cycle_limit_ends_run_with_current_state() {
    let plan = wire(100, (1, 0), 1);
    let whole = report(&plan).total;
    let (cut, _) = run_both(&plan, 20);
    assert_eq!((&cut.outcome, cut.total), (&Outcome::Limit, 20));
    let (uncut, _) = run_both(&plan, whole);
    assert_eq!(uncut.outcome, Outcome::Complete);
}

#[test]
fn caller_may_stop_a_run() {
    let plan = wire(100_000, (1, 0), 1);
    for engine in [Engine::Timed, Engine::Ticked] {
        let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_: &mut _| false };
        let report = run_with(&mut crate::common::machine(&plan), engine, None, limits);
        assert_eq!(report.outcome, Outcome::Stopped);
    }
}
