//! The unit at the end of a test: collects, and checks if told what to expect.

use super::source::of_pattern;
use crate::{Demand, Step, Traffic, Unit};
use std::fmt::Debug;

/// Collects tokens, and so slowly as it is told to; with [`Sink::expect`] it checks them, too.
///
/// A token that differs from the expected one is a [fault](Traffic::fault): the run ends, and names this unit, the
/// cycle, the token's index and both values. Tokens that never come leave the unit non-empty: the run ends as a
/// deadlock that names it.
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
    /// Collects whatever comes, one token per cycle.
    pub fn new() -> Self {
        Self::default()
    }

    /// Expects exactly these tokens, in this order.
    pub fn expect(tokens: impl IntoIterator<Item = T>) -> Self {
        Self { expected: Some(tokens.into_iter().collect()), ..Self::default() }
    }

    /// Is kept `occupancy[n mod length]` >= 1 cycles by token n, and so holds back those behind it.
    #[must_use]
    pub fn with_occupancy(mut self, occupancy: &[u64]) -> Self {
        self.occupancy = occupancy.to_vec();
        self
    }

    /// The tokens that came, in order.
    pub fn tokens(&self) -> &[T] {
        &self.tokens
    }
}

/// What is wrong with token `n`.
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

    fn step(&mut self, input: Option<T>, traffic: &mut Traffic) -> Step<()> {
        let n = self.tokens.len();
        self.tokens.extend(input);
        if let Some(expected) = &self.expected
            && self.tokens.get(n) != expected.get(n)
        {
            traffic.fault(mismatch(n, self.tokens.get(n), expected.get(n)));
        }
        Step::after(0, ()).busy(of_pattern(&self.occupancy, n, 1))
    }

    fn is_empty(&self) -> bool {
        self.expected.as_ref().is_none_or(|expected| self.tokens.len() >= expected.len())
    }
}
