//! Division by numbers fixed at construction.

/// Divides by a number fixed at construction. It shifts if the divisor is a power of two, as it nearly always is. (A division
/// costs ten times as much.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Divisor {
    pub(crate) by: u64,
    shift: Option<u32>,
}

impl Divisor {
    pub(crate) fn new(by: u32) -> Self {
        let by = u64::from(by.max(1));
        Self { by, shift: by.is_power_of_two().then(|| by.trailing_zeros()) }
    }

    #[inline(always)]
    pub(crate) fn split(self, n: u64) -> (u64, u64) {
        match self.shift {
            Some(s) => (n >> s, n & (self.by - 1)),
            None => (n / self.by, n % self.by),
        }
    }

    /// Returns the numbers of the first and the last aligned block of this size that `bytes` (>= 1) at `address` touch.
    #[inline(always)]
    pub(crate) fn touched(self, address: u64, bytes: u32) -> (u64, u64) {
        (self.split(address).0, self.split(address + u64::from(bytes) - 1).0)
    }
}
