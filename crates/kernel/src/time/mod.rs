//! Time: what follows, in cycles, from what units do. It knows no units and no tokens: for each stage when it is free and what it
//! has in flight, for each FIFO the times of its slots, and the memories.

mod clock;
mod conclude;
mod ends;
mod flight;
mod occupancy;
mod path;
mod slots;
mod start;

pub(crate) use clock::{Clock, Wait, charge};
pub(crate) use conclude::{Halt, Rest};
pub(crate) use path::Path;
pub(crate) use slots::Slots;

use crate::shape::Shape;
use crate::unit::Demand;
use crate::{Account, Cycle, MemorySystem, Probe, Traffic};

/// What a step did, as far as time depends on it. What it asked of memories stands in [`Traffic`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Made {
    /// Cycles the unit is kept, >= 1.
    pub(crate) occupancy: u64,
    /// Cycles from start to delivery.
    pub(crate) latency: u64,
    /// Outputs that got a token, one bit each.
    pub(crate) outputs: u32,
    /// Whether its delivery passes a mark.
    pub(crate) marked: bool,
}

/// What the compiler knows of a stage: how many FIFOs it has on its two sides, and whether it uses memory. A step is some dozens of
/// instructions, and takes two thirds more where it must ask for these.
pub(crate) trait Known {
    /// Inputs, where it is known how many.
    const INPUTS: Option<usize>;
    /// Outputs, where it is known how many.
    const OUTPUTS: Option<usize>;
    /// Whether it may have memory clients.
    const HAS_MEMORY: bool;
}

/// Nothing is known.
pub(crate) struct Unknown;

impl Known for Unknown {
    const INPUTS: Option<usize> = None;
    const OUTPUTS: Option<usize> = None;
    const HAS_MEMORY: bool = true;
}

/// The times of a run.
#[derive(Clone, Debug)]
pub(crate) struct Time {
    pub(crate) shape: Shape,
    pub(crate) stages: Vec<Clock>,
    pub(crate) accounts: Vec<Account>,
    pub(crate) fifos: Vec<Slots>,
    pub(crate) memories: MemorySystem,
}

impl Time {
    /// At power-on.
    pub(crate) fn new(mut shape: Shape) -> Self {
        let mut memories = std::mem::take(&mut shape.memories);
        memories.find_private(shape.stages.iter().map(|stage| stage.clients.as_slice()));
        let stages: Vec<_> = shape.stages.iter().map(|stage| Clock::new(stage, &memories)).collect();
        let has_clients = |stage: usize| !shape.stages[stage].clients.is_empty();
        let fifos = shape.fifos.iter().map(|f| Slots::new(f.depth, f.latency, has_clients(f.producer))).collect();
        Self { accounts: vec![Account::default(); shape.stages.len()], shape, stages, fifos, memories }
    }

    /// Makes a step of a stage that starts at `at`.
    #[inline(always)]
    pub(crate) fn step<K: Known>(&mut self, stage: usize, at: Cycle, demand: Demand, made: &Made, traffic: &mut Traffic) {
        let Self { stages, fifos, memories, .. } = self;
        let clock = &mut stages[stage];
        clock.step::<K>((at, demand.of(clock.inputs.count(K::INPUTS))), made, (fifos, memories), traffic);
    }

    /// Charges the cycles that a stage waits from the end of its last step to the start of the next, at `at`.
    pub(crate) fn charge_wait<P: Probe>(&mut self, stage: usize, demand: Demand, at: Cycle, probe: &mut P) {
        let Self { stages, accounts, fifos, memories, .. } = self;
        let clock = &stages[stage];
        let account = &mut accounts[stage];
        clock.split_wait(fifos, memories, demand, (clock.free, at), |wait| charge(account, probe, stage, wait));
    }

    /// Keeps how full FIFOs are, for a probe that looks on.
    pub(crate) fn keep_fills<P: Probe>(&mut self) {
        if P::is_on() {
            self.fifos.iter_mut().for_each(Slots::keep_fills);
        }
    }

    /// Shows a probe how full FIFOs were, as far as that is settled, or up to the `end` of the run.
    pub(crate) fn show_fills<P: Probe>(&mut self, probe: &mut P, end: Option<Cycle>) {
        if P::is_on() {
            for (number, fifo) in self.fifos.iter_mut().enumerate() {
                fifo.take_fills(end).into_iter().for_each(|(at, slots)| probe.held(number, at, slots));
            }
        }
    }

    /// Delivers the steps of a stage in flight whose answers are known by now, and tells whether there were any. To be called
    /// before looking at the next start.
    #[inline(always)]
    pub(crate) fn land_known<K: Known>(&mut self, stage: usize) -> bool {
        let clock = &mut self.stages[stage];
        K::HAS_MEMORY && !clock.flights.is_empty() && clock.land(&mut self.fifos, &mut self.memories)
    }

    /// The same for all stages.
    pub(crate) fn land_all(&mut self) {
        for stage in 0..self.stages.len() {
            self.land_known::<Unknown>(stage);
        }
    }
}
