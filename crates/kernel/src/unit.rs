//! The unit interface: a unit states its effect on tokens and how long it is busy. The kernel decides when.

use crate::memory_ports::MemoryPorts;
use crate::probe::UnitTable;
use crate::stats::UnitStats;
use crate::unit_info::UnitInfo;

/// The inputs from which the next step takes tokens (law 3), declared from the unit's own state alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// No input: a source, or a unit that still emits stored tokens.
    Nothing,
    /// Every input.
    All,
    /// Only this input, counted from 0.
    Only(usize),
    /// There will be no further step.
    Finished,
}

impl Demand {
    /// Returns true if input `i` is declared.
    #[inline]
    pub fn takes(self, i: usize) -> bool {
        match self {
            Demand::All => true,
            Demand::Only(k) => k == i,
            Demand::Nothing | Demand::Finished => false,
        }
    }

    /// Returns the declared inputs out of `inputs`, one bit each.
    #[inline(always)]
    pub(crate) fn of(self, inputs: usize) -> u32 {
        match self {
            Demand::All => (1 << inputs) - 1,
            Demand::Only(k) => 1 << k,
            Demand::Nothing | Demand::Finished => 0,
        }
    }
}

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<O> {
    /// 0 or 1 token per output.
    pub out: O,
    /// Cycles for which the step occupies the unit, >= 1.
    pub occupancy: u64,
    /// Cycles from start to delivery; memory answers may come later.
    pub latency: u64,
    /// Cycles from the last memory answer to delivery: the part of the work that needs the data (law 3).
    pub after_data: u32,
    /// True if the step keeps its unit until its last memory answer (law 3).
    pub blocking: bool,
    /// Its delivery passes a mark (law 11).
    pub marked: bool,
}

impl<O> Step<O> {
    /// A step of one cycle, delivered `latency` cycles after its start.
    #[inline]
    pub fn after(latency: u64, out: O) -> Self {
        Self { out, occupancy: 1, latency, after_data: 0, blocking: false, marked: false }
    }

    /// A step over `items` items of a wide token, which enter `interval` cycles apart. The unit is busy for all of them, and the
    /// last one is delivered `latency` cycles after it entered.
    ///
    /// This is the only convention of delivery: a latency counts from the entry of the last item. So a token of one item that
    /// follows cannot be delivered in the same cycle.
    #[inline]
    pub fn over(items: usize, interval: u64, latency: u64, out: O) -> Self {
        let occupancy = (items as u64 * interval).max(1);
        let latency = latency + occupancy.saturating_sub(interval);
        Self { out, occupancy, latency, after_data: 0, blocking: false, marked: false }
    }

    /// A step of so many cycles, one item per cycle. The last one is delivered `latency` cycles after it entered.
    #[inline]
    pub fn during(cycles: u64, latency: u64, out: O) -> Self {
        let occupancy = cycles.max(1);
        Self { occupancy, latency: latency.saturating_add(occupancy - 1), ..Self::after(0, out) }
    }

    /// Replaces the tokens and keeps the times.
    #[inline]
    pub fn map<T>(self, map: impl FnOnce(O) -> T) -> Step<T> {
        let Self { out, occupancy, latency, after_data, blocking, marked } = self;
        Step { out: map(out), occupancy, latency, after_data, blocking, marked }
    }

    /// Sets the occupancy in cycles.
    #[inline]
    #[must_use]
    pub fn busy(mut self, occupancy: u64) -> Self {
        self.occupancy = occupancy;
        self
    }

    /// Sets the cycles of work that need the data: the step delivers no earlier than so many cycles after each of its memory
    /// answers. An example is the filter behind a data fetch.
    #[inline]
    #[must_use]
    pub fn after_data(mut self, cycles: u32) -> Self {
        self.after_data = cycles;
        self
    }

    /// Makes the step blocking: it keeps its unit until its last memory answer. An example is the load of a table that the next
    /// step reads.
    #[inline]
    #[must_use]
    pub fn blocking(mut self) -> Self {
        self.blocking = true;
        self
    }

    /// Marks the step: its delivery ends a piece of work (law 11).
    #[inline]
    #[must_use]
    pub fn marked(mut self) -> Self {
        self.marked = true;
        self
    }
}

/// A hardware unit.
///
/// `In` is `()` for a source, `Option<T>` for one input, and a tuple of options for several. `step` receives `Some` exactly for
/// the inputs that [`Unit::demand`] declared. The same holds for `Out`.
///
/// A unit must be a function of its state and its inputs: no clock, no randomness, no shared state, no I/O. Memories give time,
/// never data (law 6): a step issues requests through [`MemoryPorts`] and computes with its own state.
pub trait Unit {
    /// Purpose of the unit and path of its code, for block diagrams.
    const INFO: UnitInfo = UnitInfo { purpose: "", module: "" };

    /// Tokens that a step pops.
    type In;
    /// Tokens that a step emits.
    type Out;

    /// Returns the inputs of the next step.
    fn demand(&self) -> Demand;

    /// Executes one step.
    ///
    /// If a unit makes a step per wide token, mark `step` and the functions to which it passes tokens `#[inline(always)]`: a
    /// token is then built in its slot instead of being copied there (3 % of a run).
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out>;

    /// Credits that the largest step needs of memory client `client` (as numbered in the wiring): requests that it issues, or
    /// distinct lines that it looks up; 0 for a client that the unit does not have. The kernel asks before the run, and the
    /// number must not change during the run. A step that needs more is a fault.
    fn largest_step(&self, client: usize) -> u32 {
        let _ = client;
        0
    }

    /// Returns true if the unit holds no token back. A run that ends while a unit holds a token is a deadlock.
    fn is_empty(&self) -> bool {
        true
    }

    /// Returns the parameters and table contents that a hardware twin of the unit needs and that its tokens do not carry. Called
    /// after the run.
    fn twin_tables(&self) -> Vec<UnitTable> {
        Vec::new()
    }

    /// Reports counters and the rates at which the unit fills its outputs. Called after the run.
    fn report_stats(&self, stats: &mut UnitStats) {
        let _ = stats;
    }
}
