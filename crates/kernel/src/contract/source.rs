//! The unit at the front of a test: emits what an iterator gives.

use crate::{Demand, Step, Traffic, Unit};

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

/// Entry n of a pattern that repeats; `default` where there is none.
pub(super) fn of_pattern(pattern: &[u64], n: usize, default: u64) -> u64 {
    n.checked_rem(pattern.len()).map_or(default, |i| pattern[i])
}

impl<I: Iterator> Unit for Source<I> {
    type In = ();
    type Out = Option<I::Item>;

    fn demand(&self) -> Demand {
        if self.next.is_some() { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), _: &mut Traffic) -> Step<Self::Out> {
        let gap = of_pattern(&self.gaps, self.emitted, 0);
        self.emitted += 1;
        Step::after(0, std::mem::replace(&mut self.next, self.items.next())).busy(1 + gap)
    }

    fn is_empty(&self) -> bool {
        self.next.is_none()
    }
}
