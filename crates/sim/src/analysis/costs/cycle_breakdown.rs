//! Cycles by activity.

use std::ops::AddAssign;

/// Activity of a unit in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CostKind {
    /// Busy with a step.
    Busy,
    /// Starved: waiting for a token.
    Starved,
    /// Waiting for memory credits or responses.
    Memory,
    /// Blocked: waiting for a FIFO slot.
    Blocked,
}

impl CostKind {
    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Busy => "busy",
            Self::Starved => "starved",
            Self::Memory => "memory",
            Self::Blocked => "blocked",
        }
    }
}

/// Unit cycles by activity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CycleBreakdown {
    /// Busy with steps.
    pub busy: u64,
    /// Starved: waiting for tokens.
    pub starved: u64,
    /// Waiting for memory credits or responses.
    pub memory: u64,
    /// Blocked: waiting for FIFO slots.
    pub blocked: u64,
}

impl CycleBreakdown {
    /// Returns the sum of all activities.
    pub fn total(&self) -> u64 {
        self.busy + self.starved + self.memory + self.blocked
    }

    pub(super) fn charge(&mut self, kind: CostKind, cycles: u64) {
        *match kind {
            CostKind::Busy => &mut self.busy,
            CostKind::Starved => &mut self.starved,
            CostKind::Memory => &mut self.memory,
            CostKind::Blocked => &mut self.blocked,
        } += cycles;
    }
}

impl AddAssign for CycleBreakdown {
    fn add_assign(&mut self, other: Self) {
        self.busy += other.busy;
        self.starved += other.starved;
        self.memory += other.memory;
        self.blocked += other.blocked;
    }
}
