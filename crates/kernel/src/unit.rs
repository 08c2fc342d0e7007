//! The unit contract: what a unit does to a token and how long it is busy. When is the kernel's business.

use crate::memory_ports::MemoryPorts;
use crate::stats::UnitStats;
use crate::unit_info::UnitInfo;

/// Which inputs the next step takes (law 3): declared from the unit's own state alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// None: a source, or a unit that still emits from what it holds.
    Nothing,
    /// Every input.
    All,
    /// Only this input, counted from 0.
    Only(usize),
    /// There will be no further step.
    Finished,
}

impl Demand {
    /// Whether input `i` is declared.
    #[inline]
    pub fn takes(self, i: usize) -> bool {
        match self {
            Demand::All => true,
            Demand::Only(k) => k == i,
            Demand::Nothing | Demand::Finished => false,
        }
    }

    /// The inputs that are declared, of so many, one bit each.
    #[inline(always)]
    pub(crate) fn of(self, inputs: usize) -> u32 {
        match self {
            Demand::All => (1 << inputs) - 1,
            Demand::Only(k) => 1 << k,
            Demand::Nothing | Demand::Finished => 0,
        }
    }
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<O> {
    /// 0 or 1 token per output.
    pub out: O,
    /// Cycles the unit is kept, >= 1.
    pub occupancy: u64,
    /// Cycles from start to delivery; memory answers may come later.
    pub latency: u64,
    /// Its delivery passes a mark (law 11).
    pub marked: bool,
}

impl<O> Step<O> {
    /// A step of one cycle, delivered `latency` cycles after its start.
    #[inline]
    pub fn after(latency: u64, out: O) -> Self {
        Self { out, occupancy: 1, latency, marked: false }
    }

    /// A step over `items` items of a wide token, which enter `interval` cycles after each other: the unit is kept for all
    /// of them, and the last one is delivered `latency` cycles after it entered.
    #[inline]
    pub fn over(items: usize, interval: u64, latency: u64, out: O) -> Self {
        let occupancy = (items as u64 * interval).max(1);
        Self { out, occupancy, latency: latency + occupancy.saturating_sub(interval), marked: false }
    }

    /// Keeps the unit for this many cycles.
    #[inline]
    #[must_use]
    pub fn busy(mut self, occupancy: u64) -> Self {
        self.occupancy = occupancy;
        self
    }

    /// Marks the step: its delivery is counted as the end of a piece of work (law 11).
    #[inline]
    #[must_use]
    pub fn marked(mut self) -> Self {
        self.marked = true;
        self
    }
}

/// A hardware unit.
///
/// `In` is `()` for a source, `Option<T>` for one input, a tuple of options for several; `step` finds `Some` exactly
/// where [`Unit::demand`] declared the input. `Out` likewise.
///
/// A unit must be a function of its state and its inputs: no clock, no randomness, no shared state, no I/O. Memories
/// give time, never data (law 6): a step issues requests through [`MemoryPorts`] and computes with what it holds.
pub trait Unit {
    /// What it is for, and where its code is: what a block diagram says of it.
    const INFO: UnitInfo = UnitInfo { purpose: "", module: "" };

    /// What a step pops.
    type In;
    /// What a step emits.
    type Out;

    /// Which inputs the next step takes.
    fn demand(&self) -> Demand;

    /// One step.
    ///
    /// Mark it `#[inline(always)]`, with what it hands tokens to, where a unit makes a step per wide token: a token is then built in
    /// its slot, instead of being copied on its way there (3 % of a run).
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out>;

    /// Credits that the largest step needs of memory client `client` (as numbered in the wiring): requests it issues,
    /// or distinct lines it looks up; 0 for a client that the unit does not have. Asked before the run: it must not change
    /// during one. A step that needs more is a fault.
    fn largest_step(&self, client: usize) -> u32 {
        let _ = client;
        0
    }

    /// Whether no token is held back; a run that ends while one is, has deadlocked.
    fn is_empty(&self) -> bool {
        true
    }

    /// Tells what it counted, and how fast it fills its outputs. Asked after the run.
    fn report_stats(&self, stats: &mut UnitStats) {
        let _ = stats;
    }
}
