//! Units for the two ends of a machine: a source that emits the items of an iterator, and a sink that collects and checks.
//!
//! [`Source`] and [`Sink`] are ordinary units, for machines that a test wires itself. A failed expectation names the
//! sink, the cycle, the token and both values:
//!
//! ```
//! use basrelief_kernel::{Engine, Fifo, Machine, MemorySystem, Outcome, Sink, Source, Stage, Visitor, run};
//!
//! struct Wire {
//!     source: Stage<Source<std::ops::Range<u32>>>,
//!     fifo: Fifo<u32>,
//!     sink: Stage<Sink<u32>>,
//!     memories: MemorySystem,
//! }
//!
//! impl Machine for Wire {
//!     fn wire<V: Visitor>(&mut self, v: &mut V) {
//!         v.stage(self.source.between((), &mut self.fifo));
//!         v.stage(self.sink.between(&mut self.fifo, ()));
//!     }
//!     fn memories(&mut self) -> &mut MemorySystem {
//!         &mut self.memories
//!     }
//! }
//!
//! let mut machine = Wire {
//!     source: Stage::new("source", Source::new(0..3).with_gaps(&[9])),
//!     fifo: Fifo::new("wire", 2, 1),
//!     sink: Stage::new("sink", Sink::expect([0, 1, 7])),
//!     memories: MemorySystem::default(),
//! };
//! let report = run(&mut machine, Engine::Timed);
//! assert_eq!(report.outcome, Outcome::Fault("sink, cycle 21: token 2: got 2, expected 7".into()));
//! ```

use crate::{Demand, MemoryPorts, Step, Unit};
use std::fmt::Debug;

/// Emits the items of an iterator, one per cycle or with gaps.
#[derive(Clone, Debug)]
pub struct Source<I: Iterator> {
    items: I,
    next: Option<I::Item>,
    emitted: usize,
    gaps: Vec<u64>,
}

impl<I: Iterator> Source<I> {
    /// A source of `items`, one per cycle.
    pub fn new(items: impl IntoIterator<IntoIter = I>) -> Self {
        let mut items = items.into_iter();
        Self { next: items.next(), items, emitted: 0, gaps: Vec::new() }
    }

    /// Items emitted so far.
    pub fn emitted(&self) -> usize {
        self.emitted
    }

    /// Leaves `gaps[n mod length]` cycles free after item n.
    #[must_use]
    pub fn with_gaps(mut self, gaps: &[u64]) -> Self {
        self.gaps = gaps.to_vec();
        self
    }
}

impl<I: Iterator> Unit for Source<I> {
    type In = ();
    type Out = Option<I::Item>;

    fn demand(&self) -> Demand {
        if self.next.is_some() { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), _: &mut MemoryPorts) -> Step<Self::Out> {
        let gap = pattern_entry(&self.gaps, self.emitted, 0);
        self.emitted += 1;
        Step::after(0, std::mem::replace(&mut self.next, self.items.next())).busy(1 + gap)
    }

    fn is_empty(&self) -> bool {
        self.next.is_none()
    }
}
/// Collects tokens, at a configurable pace. With [`Sink::expect`] it also checks them.
///
/// A token that differs from the expected one is a [fault](MemoryPorts::fault): the run ends with a message that names this unit,
/// the cycle, the token's index and both values. Missing tokens leave the unit non-empty: the run ends as a deadlock that names
/// it.
#[derive(Clone, Debug)]
pub struct Sink<T> {
    tokens: Vec<T>,
    expected: Option<Vec<T>>,
    occupancy: Vec<u64>,
}

impl<T> Default for Sink<T> {
    fn default() -> Self {
        Self { tokens: Vec::new(), expected: None, occupancy: Vec::new() }
    }
}

impl<T> Sink<T> {
    /// Creates a sink that collects all tokens, one per cycle.
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates a sink that expects exactly these tokens, in this order.
    pub fn expect(tokens: impl IntoIterator<Item = T>) -> Self {
        Self { expected: Some(tokens.into_iter().collect()), ..Self::default() }
    }

    /// Sets the occupancy of the step for token n to `occupancy[n mod length]` >= 1 cycles, which holds back the tokens behind
    /// it.
    #[must_use]
    pub fn with_occupancy(mut self, occupancy: &[u64]) -> Self {
        self.occupancy = occupancy.to_vec();
        self
    }

    /// Returns the collected tokens, in order.
    pub fn tokens(&self) -> &[T] {
        &self.tokens
    }
}

/// Describes the mismatch of token `n`.
fn mismatch<T: Debug>(n: usize, got: Option<&T>, expected: Option<&T>) -> String {
    let show = |token: Option<&T>| token.map_or("none".into(), |t| format!("{t:?}"));
    format!("token {n}: got {}, expected {}", show(got), show(expected))
}

impl<T: Debug + PartialEq> Unit for Sink<T> {
    type In = Option<T>;
    type Out = ();

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, input: Option<T>, traffic: &mut MemoryPorts) -> Step<()> {
        let n = self.tokens.len();
        self.tokens.extend(input);
        if let Some(expected) = &self.expected
            && self.tokens.get(n) != expected.get(n)
        {
            traffic.fault(mismatch(n, self.tokens.get(n), expected.get(n)));
        }
        Step::after(0, ()).busy(pattern_entry(&self.occupancy, n, 1))
    }

    fn is_empty(&self) -> bool {
        self.expected.as_ref().is_none_or(|expected| self.tokens.len() >= expected.len())
    }
}

/// Entry `n` of a repeating pattern; `default` if the pattern is empty.
fn pattern_entry(pattern: &[u64], n: usize, default: u64) -> u64 {
    n.checked_rem(pattern.len()).map_or(default, |i| pattern[i])
}
