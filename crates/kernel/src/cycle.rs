//! Time, counted in cycles from 0.

use std::{fmt, ops};

/// A point in time \[cycles\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct Cycle(pub u64);

impl Cycle {
    /// Power-on.
    pub const ZERO: Self = Self(0);
    /// An unknown time, later than every known time. In a finished run: never.
    pub const UNKNOWN: Self = Self(u64::MAX);

    /// Returns true if the time is known.
    #[inline]
    pub fn is_known(self) -> bool {
        self != Self::UNKNOWN
    }

    /// Adds cycles to a known time. (Operator `+` keeps unknown times unknown, which takes two more instructions. A step adds
    /// some ten times.)
    #[inline(always)]
    pub(crate) fn after(self, cycles: u64) -> Self {
        debug_assert!(self.is_known(), "the time is known");
        Self(self.0.wrapping_add(cycles))
    }

    /// Returns the cycles from `earlier` to `self`; 0 if `earlier` is later.
    #[inline]
    pub fn since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
}

impl ops::Add<u64> for Cycle {
    type Output = Self;
    #[inline]
    fn add(self, cycles: u64) -> Self {
        Self(self.0.saturating_add(cycles))
    }
}

impl fmt::Display for Cycle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_known() { write!(f, "cycle {}", self.0) } else { f.write_str("never") }
    }
}
