//! Memory requests of units.

/// One memory request of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// Client of the unit, as numbered in the wiring.
    pub client: u32,
    /// True for a posted write, false for a read.
    pub write: bool,
    /// Byte address.
    pub address: u64,
    /// Bytes, >= 1.
    pub bytes: u32,
}
