//! A probe behind a pointer.

use basrelief_kernel::{Cause, Cycle, Probe};

/// What a [`Probe`] is told, whatever its type. So the machines are compiled once, with this crate, and not once more in every
/// program that runs them: that took a fifth of the time of a test build.
pub trait Watch {
    /// See [`Probe::worked`].
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle);
    /// See [`Probe::waited`].
    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle);
}

impl<P: Probe> Watch for P {
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        Probe::worked(self, stage, from, to);
    }

    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        Probe::waited(self, stage, cause, from, to);
    }
}

/// Hands on to any probe.
pub(crate) struct Watched<'a>(pub(crate) &'a mut dyn Watch);

impl Probe for Watched<'_> {
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.0.worked(stage, from, to);
    }

    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        self.0.waited(stage, cause, from, to);
    }
}
