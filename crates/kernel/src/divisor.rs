//! Division by numbers fixed at construction.

/// Splits a number by a divisor fixed at construction: a shift where the divisor is a power of two, as it nearly
/// always is (a division costs ten times as much).
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

    /// First and last of the numbers of the aligned pieces of this size that `bytes` (>= 1) from `address` on touch.
    #[inline(always)]
    pub(crate) fn touched(self, address: u64, bytes: u32) -> (u64, u64) {
        (self.split(address).0, self.split(address + u64::from(bytes) - 1).0)
    }
}
