//! Periodic clients of memories (law 4): clients that belong to no unit, for example the scan-out of a display.

use crate::Cycle;

/// Requests of a periodic client. Request k = 0, 1, .. is a read that arrives in cycle k * `period` at address
/// `base` + (k * `stride`) mod `span`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeriodicReads {
    /// Cycles from request to request, >= 1.
    pub period: u64,
    /// Bytes of a request, >= 1.
    pub bytes: u32,
    /// Lowest byte address.
    pub base: u64,
    /// Bytes from the address of a request to the address of the next.
    pub stride: u64,
    /// Size of the address range \[bytes\], >= 1.
    pub span: u64,
}

impl PeriodicReads {
    /// Returns the address of request `number`.
    pub(crate) fn address(&self, number: u64) -> u64 {
        let offset = u128::from(number) * u128::from(self.stride) % u128::from(self.span.max(1));
        self.base + offset as u64
    }
}

/// A periodic client.
#[derive(Clone, Debug)]
pub(crate) struct PeriodicClient {
    pub(crate) client: usize,
    pub(crate) reads: PeriodicReads,
    /// Arrival and number of the next request.
    pub(crate) next: (Cycle, u64),
}

/// Data of a periodic client on the bus of a channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LateData {
    pub(crate) channel: usize,
    pub(crate) from: Cycle,
    pub(crate) to: Cycle,
}
