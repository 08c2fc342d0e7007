//! The unit contract: correct units pass, and each violation is found and named.

use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_kernel::{Sink, Source};
use basrelief_kernel_conformance::contract::{ClientKind, Contract};
use basrelief_kernel_conformance::unit_contract;
use std::cell::Cell;
use std::rc::Rc;

/// A source under test.
fn counter() -> Source<std::ops::Range<u32>> {
    Source::new(0..40).with_gaps(&[0, 2])
}

/// A source that has emitted this number of items.
fn counter_at(emitted: usize) -> Source<std::ops::Range<u32>> {
    let mut source = counter();
    for _ in 0..emitted {
        source.step((), &mut MemoryPorts::default());
    }
    source
}

fn sink() -> Sink<u8> {
    Sink::new().with_occupancy(&[1, 3])
}

/// A sink that has consumed these tokens.
fn sink_of(tokens: Vec<u8>) -> Sink<u8> {
    let mut sink = sink();
    for token in tokens {
        sink.step(Some(token), &mut MemoryPorts::default());
    }
    sink
}

unit_contract! {
    name: source,
    unit: counter(),
    inputs: (),
    state: |unit| unit.emitted() => |unit, emitted| *unit = counter_at(emitted),
}

unit_contract! {
    name: sink_of_bytes,
    unit: sink(),
    inputs: (0..40).collect(),
    state: |unit| unit.tokens().to_vec() => |unit, tokens| *unit = sink_of(tokens),
}

/// Doubles its input and has no state.
#[derive(Clone)]
struct Double;

impl Unit for Double {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u64>, _: &mut MemoryPorts) -> Step<Option<u64>> {
        Step::after(1, input.map(|n| 2 * n))
    }
}

unit_contract! { name: double, unit: Double, inputs: (0..40).collect(), stateless }

/// Pops two inputs, with two tokens of the first per token of the second, and emits sum and difference on two outputs.
#[derive(Clone, Default)]
struct Butterfly {
    held: Option<i64>,
}

impl Unit for Butterfly {
    type In = (Option<i64>, Option<i64>);
    type Out = (Option<i64>, Option<i64>);
    fn demand(&self) -> Demand {
        if self.held.is_some() { Demand::All } else { Demand::Only(0) }
    }
    fn step(&mut self, (a, b): Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        match (self.held.take(), a, b) {
            (Some(h), Some(a), Some(b)) => Step::after(3, (Some(h + a + b), Some(h + a - b))).busy(2),
            (None, Some(a), None) => {
                self.held = Some(a);
                Step::after(0, (None, None))
            }
            _ => unreachable!("a step is given what demand declared"),
        }
    }
    fn is_empty(&self) -> bool {
        self.held.is_none()
    }
}

unit_contract! {
    name: butterfly,
    unit: Butterfly::default(),
    inputs: ((0..60).collect(), (100..130).collect()),
    state: |unit| unit.held => |unit, held| unit.held = held,
}

/// Emits each token three times, with a read, a write and a look-up per step. It works for a cycle after its data, and every third
/// step blocks. Each switch breaks one promise.
#[derive(Clone, Default)]
struct Triple {
    held: (u64, u32),
    /// Excluded from the state.
    unsaved: u64,
    steps: Rc<Cell<u64>>,
    greedy: bool,
    forgetful: bool,
    shared: bool,
    hoards: bool,
    hasty: bool,
}

impl Unit for Triple {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        if self.held.1 > 0 { Demand::Nothing } else { Demand::All }
    }
    fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<Option<u64>> {
        if let Some(token) = input {
            self.held = (token, 3);
        }
        let token = self.held.0;
        self.held.1 -= 1;
        self.unsaved += 1;
        self.steps.set(self.steps.get() + 1);
        traffic.look_up(0, 96 * token, 64);
        traffic.look_up(0, 96 * token + 4, 4);
        traffic.read(1, 8 * token, 8);
        traffic.write(1, 8 * token, 8);
        if self.greedy && token == 7 {
            traffic.read(1, 0, 8);
        }
        let out = match () {
            () if self.forgetful => self.unsaved,
            () if self.shared => self.steps.get(),
            () => token,
        };
        let latency = if self.hasty { 0 } else { 1 };
        let step = Step::after(latency, Some(out)).busy(1 + token % 2).after_data(1);
        if token.is_multiple_of(3) { step.blocking() } else { step }
    }
    fn largest_step(&self, client: usize) -> u32 {
        if client < 2 { 2 } else { 0 }
    }
    fn is_empty(&self) -> bool {
        self.held.1 == 0 && !self.hoards
    }
}

const CLIENTS: [ClientKind; 2] = [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port];

unit_contract! {
    name: triple,
    unit: Triple::default(),
    inputs: (0..30).collect(),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state: |unit| unit.held => |unit, held| unit.held = held,
}

fn contract(unit: Triple) -> Contract<Triple> {
    contract_of(unit, (0..30).collect())
}

fn contract_of(unit: Triple, tokens: Vec<u64>) -> Contract<Triple> {
    Contract::new(unit, tokens, |unit| unit.held, |unit, held| unit.held = held).clients(&CLIENTS)
}

#[test]
fn step_beyond_largest_is_named() {
    let broken = contract(Triple { greedy: true, ..Triple::default() }).steps_keep_within_largest_step().unwrap_err();
    assert!(broken.what.starts_with("unit, cycle "), "{broken}");
    assert!(broken.what.ends_with("a step needs 3 credits of memory client 1, but largest_step(1) declares 2"), "{broken}");
}

#[test]
fn work_after_data_beyond_latency_is_named() {
    let broken = contract(Triple { hasty: true, ..Triple::default() }).work_after_data_is_part_of_latency().unwrap_err();
    assert!(broken.what.ends_with("a step works 1 cycles after its data, expected at most its latency, 0"), "{broken}");
}

#[test]
fn unlisted_client_is_named() {
    let broken = contract(Triple::default()).clients(&[ClientKind::Cache { line_bytes: 64 }]).check_all().unwrap_err();
    assert!(broken.what.ends_with("`unit` declares a largest step for its memory client 1, but 1 are wired"), "{broken}");
    let broken = contract(Triple::default()).clients(&[ClientKind::Port, ClientKind::Port]).check_all().unwrap_err();
    assert!(broken.what.ends_with("a step looks up a line in memory client 0, which has no cache"), "{broken}");
}

#[test]
fn unsaved_state_is_found() {
    let contract = contract(Triple { forgetful: true, ..Triple::default() });
    let broken = contract.state_round_trips().unwrap_err();
    assert!(broken.what.ends_with("token 1: got 1, expected 2"), "{broken}");
    let broken = contract.reset_is_idempotent().unwrap_err();
    assert!(broken.what.ends_with("token 0: got 91, expected 1"), "{broken}");
}

#[test]
fn stateful_unit_declared_stateless_is_found() {
    let contract = Contract::stateless(Triple::default(), (0..30).collect()).clients(&CLIENTS);
    let broken = contract.state_round_trips().unwrap_err();
    assert!(broken.what.ends_with("token 1: got 1, expected 0"), "{broken}");
}

#[test]
fn state_shared_between_clones_is_found() {
    let broken = contract(Triple { shared: true, ..Triple::default() }).runs_are_deterministic().unwrap_err();
    assert!(broken.what.contains("token 0: got 91, expected 1"), "{broken}");
}

#[test]
fn token_held_back_is_deadlock_naming_unit() {
    let broken = contract(Triple { hoards: true, ..Triple::default() }).nothing_is_left_at_the_end().unwrap_err();
    assert!(broken.what.contains("`unit` waits for a token from `input_0` (0 of 1 slots)"), "{broken}");
}

#[test]
fn unit_without_steps_breaks_contract() {
    let broken = contract_of(Triple::default(), vec![]).check_all().unwrap_err();
    assert!(broken.what.contains("made no step"), "{broken}");
}
