//! Bursts of memory channels.

use crate::Cycle;

/// A burst that waits for its column command.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Burst {
    pub(crate) bank: u32,
    pub(crate) row: u64,
    pub(crate) write: bool,
    /// When its request arrived.
    pub(crate) arrival: Cycle,
    /// Client and number of its request.
    pub(crate) client: u32,
    pub(crate) request: u64,
}
