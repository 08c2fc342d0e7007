//! Law 7: control tokens use the same FIFOs as data. A gathering unit flushes on the end token, and never exceeds its memory.
//! Feedback is an ordinary FIFO.

use crate::common::{PlanBuilder, fault, report, run_and_record, sink_tokens};
use basrelief_kernel::{Demand, Engine, MemoryPorts, Outcome, Step, Unit, run, run_functional};
use basrelief_kernel_conformance::contract::{Bench, TestEnvironment};
use basrelief_kernel_conformance::plan::UnitKind;

#[test]
fn gathering_unit_flushes_on_last_token() {
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 2, 1)
        .fifo("out", 2, 1)
        .unit("source", UnitKind::Source { tokens: 6 }, ["", "in"], &[1], &[0])
        .unit("gather", UnitKind::Gather { size: 4 }, ["in", "out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    assert_eq!(report(&draw.0).outcome, Outcome::Complete);
    let [timed, _] = sink_tokens(&draw.0);
    assert!(timed[0].1.iter().map(|t| (t.id, t.last)).eq([(0, false), (1, true)]));
}

#[test]
fn feedback_is_an_ordinary_fifo() {
    // Every token passes the loop once: even numbers return, odd numbers leave.
    let mut draw = PlanBuilder::default();
    draw.fifo("in", 1, 1)
        .fifo("loop", 1, 1)
        .fifo("back", 1, 1)
        .fifo("out", 1, 1)
        .unit("source", UnitKind::Source { tokens: 5 }, ["", "in"], &[1], &[0])
        .unit("merge", UnitKind::Merge { tokens: 10 }, ["in back", "loop"], &[1], &[0])
        .unit("route", UnitKind::Route, ["loop", "back out"], &[1], &[0])
        .unit("sink", UnitKind::Sink, ["out", ""], &[1], &[0]);
    assert_eq!(report(&draw.0).outcome, Outcome::Complete);
    let [timed, functional] = sink_tokens(&draw.0);
    assert!(timed[0].1.iter().map(|t| t.id).eq([1, 3, 5, 7, 9]));
    assert_eq!(timed, functional);
}

/// Items, a setting for the items after it, and the end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flow {
    Item(u32),
    Scale(u32),
    End,
}

/// Scales items by the current setting. Emits them in batches of at most `room`, after the end token.
#[derive(Clone)]
struct Batch {
    room: usize,
    scale: u32,
    held: Vec<u32>,
    flushing: bool,
}

impl Unit for Batch {
    type In = Option<Flow>;
    type Out = Option<Flow>;

    fn demand(&self) -> Demand {
        if self.flushing { Demand::Nothing } else { Demand::All }
    }

    fn step(&mut self, input: Option<Flow>, traffic: &mut MemoryPorts) -> Step<Option<Flow>> {
        match input {
            Some(Flow::Item(_)) if self.held.len() == self.room => {
                traffic.fault(format!("more than {} items in a batch; give `batch.room` more", self.room));
            }
            Some(Flow::Item(x)) => self.held.push(x * self.scale),
            Some(Flow::Scale(scale)) => self.scale = scale,
            Some(Flow::End) => self.flushing = true,
            None if self.held.is_empty() => {
                self.flushing = false;
                return Step::after(0, Some(Flow::End));
            }
            None => return Step::after(0, Some(Flow::Item(self.held.remove(0)))),
        }
        Step::after(0, None)
    }

    fn is_empty(&self) -> bool {
        self.held.is_empty() && !self.flushing
    }
}

fn bench(room: usize, tokens: Vec<Flow>) -> Bench<Batch> {
    let setting = TestEnvironment { depth: 2, latency: 1, ..TestEnvironment::default() };
    Bench::new(Batch { room, scale: 1, held: vec![], flushing: false }, tokens, None, &[], &setting)
}

// Claim: laws, 7 Control in band: A control token takes effect when it is popped. A full gather memory is an error, not a deadlock.
#[test]
fn control_token_takes_effect_when_popped() {
    use Flow::{End, Item, Scale};
    let tokens = vec![Item(1), Scale(10), Item(2), Item(3), End, Item(4), Scale(1), Item(5), End];
    for engine in [Engine::Timed, Engine::Ticked] {
        let mut bench = bench(3, tokens.clone());
        assert_eq!(run(&mut bench, engine).outcome, Outcome::Complete);
        assert_eq!(bench.tokens(), [Item(1), Item(20), Item(30), End, Item(40), Item(5), End]);
    }
}

#[test]
fn gathering_unit_without_end_token_deadlocks() {
    let unended = || bench(3, vec![Flow::Item(1), Flow::Item(2)]);
    let report = run(&mut unended(), Engine::Timed);
    assert_eq!(run_and_record(unended).0, report, "work separate from time, left");
    let Outcome::Deadlock(deadlock) = report.outcome else { panic!("{:?}", report.outcome) };
    assert!(deadlock.circle.is_empty(), "the unit waits for a source that has finished");
    assert_eq!(
        deadlock.to_string(),
        "deadlock after 3 cycles: `unit` waits for a token from `input_0` (0 of 2 slots); \
         `sink_0` waits for a token from `output_0` (0 of 2 slots). \
         No FIFO is full: a unit holds tokens back for others that never came"
    );
}

// Claim: as control_token_takes_effect_when_popped.
#[test]
fn exceeding_gather_memory_is_error_not_deadlock() {
    let tokens = || vec![Flow::Item(1), Flow::Item(2), Flow::Item(3), Flow::End];
    let what = "more than 2 items in a batch; give `batch.room` more";
    assert_eq!(fault(|| bench(2, tokens())), format!("unit, cycle 3: {what}"));
    assert_eq!(run_functional(&mut bench(2, tokens()), &mut |_| true), Err(format!("unit: {what}")));
}
