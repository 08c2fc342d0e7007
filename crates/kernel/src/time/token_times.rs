//! Times of tokens.

use crate::Cycle;
use std::cell::Cell;

/// Times of one token.
#[derive(Clone, Debug)]
pub(super) struct TokenTimes {
    /// Start of the step that reserved a slot for it.
    pub(super) reserved: Cell<Cycle>,
    /// First cycle in which it can be popped; unknown until it is delivered, and if there is no token.
    pub(super) visible: Cell<Cycle>,
    /// First cycle in which its slot is free again, the cycle after its pop; unknown before the pop.
    pub(super) free: Cell<Cycle>,
}

impl TokenTimes {
    /// Creates the times of an entry that was never used.
    pub(super) fn unused() -> Self {
        Self { reserved: Cell::default(), visible: Cell::new(Cycle::UNKNOWN), free: Cell::default() }
    }
}
