//! Law 3: a step starts at the first cycle at which the unit is free, every declared input has a visible token, every output has
//! a slot, and every port has credits for the largest step. The slot is needed even if the step then emits nothing there.

use crate::common::{PlanBuilder, fault, small_memory, starts};
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_kernel_conformance::contract::{Bench, TestEnvironment};
use basrelief_kernel_conformance::plan::{PlanRequest, UnitKind};

#[test]
fn join_waits_for_its_last_input() {
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 4, 1)
        .fifo("b", 4, 1)
        .fifo("c", 4, 1)
        .unit("quick", UnitKind::Source { tokens: 3 }, ["", "a"], &[1], &[0])
        .unit("slow", UnitKind::Source { tokens: 3 }, ["", "b"], &[5], &[2])
        .unit("join", UnitKind::Join, ["a b", "c"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["c", ""], &[1], &[0]);
    // `slow` starts at 0, 5, 10; delivered 2, 7, 12; visible 3, 8, 13.
    assert_eq!(starts(&draw.0, "join"), [3, 8, 13]);
}

// Claim: laws, 3 Start: A step pops exactly its declared inputs, and starts with credits for its largest case. Impossible
// parameters are rejected.
#[test]
fn exactly_declared_inputs_are_popped() {
    let mut draw = PlanBuilder::default();
    draw.fifo("a", 4, 1)
        .fifo("b", 4, 1)
        .fifo("c", 8, 1)
        .unit("even", UnitKind::Source { tokens: 3 }, ["", "a"], &[1], &[0])
        .unit("odd", UnitKind::Source { tokens: 3 }, ["", "b"], &[10], &[0])
        .unit("merge", UnitKind::Merge { tokens: 6 }, ["a b", "c"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["c", ""], &[1], &[0]);
    // `a` is visible at 1, 2, 3 and `b` at 1, 11, 21. The merge alternates: a 1, b 2, a 3, b 11, a 12, b 21. Earlier tokens of
    // `a` do not overtake those of `b`.
    assert_eq!(starts(&draw.0, "merge"), [1, 2, 3, 11, 12, 21]);
}

#[test]
fn start_needs_slot_on_every_output() {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 8, 1)
        .fifo("out", 1, 1)
        .unit("source", UnitKind::Source { tokens: 6 }, ["", "in"], &[1], &[0])
        .unit("gather", UnitKind::Gather { size: 2 }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[10], &[0]);
    // Tokens are visible at 1, 2, .. 6. Step 1 emits nothing. Step 2 emits: visible 3, popped 3, slot free at 4. Step 3 emits
    // nothing and still waits until 4. Step 4, at 5: visible 6, popped when the sink is free at 3 + 10 = 13, slot free at 14.
    // Steps 5 and 6 are therefore at 14 and 15.
    assert_eq!(starts(&draw.0, "gather"), [1, 2, 4, 5, 14, 15]);
    assert_eq!(starts(&draw.0, "sink"), [3, 13, 23]);
}

/// A unit with these requests per step on port p of a memory, which answers the first after 8 cycles.
fn client(tokens: u64, requests: Vec<PlanRequest>) -> PlanBuilder {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .memory(small_memory(), &[("p", 8)])
        .unit("source", UnitKind::Source { tokens }, ["", "in"], &[1], &[0])
        .unit("client", UnitKind::Access { requests }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    draw
}

fn request(write: bool) -> PlanRequest {
    PlanRequest { port: "p".into(), write, bytes: 32, stride: 0, offset: 0, span: 64 }
}

#[test]
fn work_after_data_follows_last_answer() {
    // Step at 1: column 4, data 7 .. 9, answer 9.
    let visible = |latency, after: &[u32], write| {
        let mut plan = client(1, vec![request(write)]).0;
        (plan.units[1].latency, plan.units[1].after) = (vec![latency], after.to_vec());
        starts(&plan, "sink")
    };
    assert_eq!(visible(0, &[], false), [10]);
    assert_eq!(visible(0, &[4], false), [9 + 4 + 1]);
    // The latency counts from the start, beside the answer.
    assert_eq!(visible(12, &[4], false), [9 + 4 + 1]);
    assert_eq!(visible(20, &[4], false), [1 + 20 + 1]);
    // A posted write has no answer.
    assert_eq!(visible(0, &[4], true), [1 + 1]);
}

#[test]
fn blocking_step_keeps_unit_until_last_answer() {
    // Step 0 at 1, answer 9.
    let steps = |blocking, write| {
        let mut plan = client(2, vec![request(write)]).0;
        plan.units[1].blocking = blocking;
        starts(&plan, "client")
    };
    assert_eq!(steps(false, false), [1, 2]);
    assert_eq!(steps(true, false), [1, 9]);
    // A posted write has no answer.
    assert_eq!(steps(true, true), [1, 2]);
}

#[test]
fn blocking_step_frees_unit_before_delivery() {
    // Tokens 0 and 2 deliver 40 cycles after their start.
    let mut plan = client(4, vec![request(false)]).0;
    plan.units[1].blocking = true;
    plan.units[1].latency = vec![40, 0];
    // Answers 9, 15, 21, 27: the unit is free then, though it has not delivered token 0 yet. Delivered 41, 42, 55, 56.
    assert_eq!(starts(&plan, "client"), [1, 9, 15, 21]);
    assert_eq!(starts(&plan, "sink"), [42, 43, 56, 57]);
}

#[test]
fn silent_output_reserves_no_slot() {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 8, 1)
        .fifo("left", 1, 1)
        .fifo("right", 1, 1)
        .unit("source", UnitKind::Source { tokens: 4 }, ["", "in"], &[1], &[0])
        .unit("route", UnitKind::Route, ["in", "left right"], &[1], &[0])
        .unit("a", UnitKind::Sink, ["left", ""], &[1], &[0])
        .unit("b", UnitKind::Sink, ["right", ""], &[1], &[0]);
    // Token 0 goes left at 1: visible 2, popped 2, free at 3. Token 1 could go right at 2, but the left slot is occupied until 3.
    // It goes at 3, and the right slot is free again at 5. If token 1 had also reserved a left slot, that slot would never be
    // free.
    assert_eq!(starts(&draw.0, "route"), [1, 3, 5, 7]);
}

// Claim: as exactly_declared_inputs_are_popped.
#[test]
fn start_needs_credits_for_largest_step() {
    // Two reads of 32 bytes per step, 3 credits. Memory: closed 2, then 3 to the data, with 2 cycles per burst.
    let mut draw = PlanBuilder::default();
    let read = |offset| PlanRequest { port: "p".into(), write: false, bytes: 32, stride: 0, offset, span: 64 };
    draw.fifo("in", 8, 1)
        .fifo("out", 8, 1)
        .memory(small_memory(), &[("p", 3)])
        .unit("source", UnitKind::Source { tokens: 2 }, ["", "in"], &[1], &[0])
        .unit("reader", UnitKind::Access { requests: vec![read(0), read(32)] }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    // Step 1 at 1: column 4, data 7 .. 9; column 6, a hit, data 9 .. 11. One credit is left, but two are needed. The next step
    // waits for the first answer, at 9.
    assert_eq!(starts(&draw.0, "reader"), [1, 9]);
}

/// Unit with steps of occupancy 0.
#[derive(Clone)]
struct Timeless;

impl Unit for Timeless {
    type In = Option<u8>;
    type Out = Option<u8>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u8>, _: &mut MemoryPorts) -> Step<Option<u8>> {
        Step::after(0, input).busy(0)
    }
}

#[test]
fn occupancy_0_is_a_fault() {
    let setting = TestEnvironment { depth: 1, latency: 1, ..TestEnvironment::default() };
    let text = "unit, cycle 1: a step kept its unit for 0 cycles, expected at least 1 (law 3)";
    assert_eq!(fault(|| Bench::new(Timeless, vec![1], None, &[], &setting)), text);
}
