//! Times of tokens.

use crate::Cycle;
use std::cell::Cell;

/// Times of one token.
#[derive(Clone, Debug)]
pub(super) struct TokenTimes {
    /// Start of the step that reserved a slot for it.
    pub(super) reserved: Cell<Cycle>,
    /// When it can be popped; unknown until that is, and while there is none.
    pub(super) visible: Cell<Cycle>,
    /// From when on its slot is free: the cycle after its pop; unknown until that is.
    pub(super) free: Cell<Cycle>,
}
