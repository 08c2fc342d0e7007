//! Accesses of the current work to memory (12), as the microcomputer (10) remembers them.

use crate::{NormalLoad, RegisterOrder};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Numbers that lie together in memory (12): address of the first, and their count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct NumberRange {
    pub(super) from: u64,
    pub(super) numbers: u64,
}

/// Work that begins when its operands have arrived: its cycles, and its outputs to the registers and to circuit (50).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WaitingWork {
    pub(super) cycles: u64,
    pub(super) order: Option<RegisterOrder>,
    pub(super) load: Option<Arc<NormalLoad>>,
}

/// Accesses to memory (12) of the current work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct OperandAccess {
    pub(super) fetches: VecDeque<NumberRange>,
    pub(super) stores: VecDeque<NumberRange>,
    /// Cycles of the load operations that are not spent yet.
    pub(super) load_cycles: u64,
    pub(super) work: Option<WaitingWork>,
}

impl OperandAccess {
    /// Returns true if no work waits.
    pub(crate) fn is_empty(&self) -> bool {
        self.work.is_none()
    }
}
