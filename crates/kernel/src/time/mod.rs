//! Time: what follows, in cycles, from what units do. It knows no units and no tokens: for each stage when it is free and what it
//! has in flight, for each FIFO the times of its slots, and the memories.

mod clock;
mod conclude;
mod flight;
mod occupancy;
mod slots;
mod start;

pub(crate) use clock::{Clock, Wait, charge};
pub(crate) use conclude::{Halt, Rest};
pub(crate) use slots::Slots;

use crate::shape::Shape;
use crate::unit::Demand;
use crate::{Account, Cycle, MemorySystem, Probe, Traffic};
use flight::MARKED;

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

    /// Makes a step of a stage, which starts at `at`: takes it into the times of its FIFOs, and issues its traffic.
    #[inline]
    pub(crate) fn step(&mut self, stage: usize, at: Cycle, demand: Demand, made: &Made, traffic: &mut Traffic) {
        let Self { stages, accounts, fifos, memories, .. } = self;
        let clock = &mut stages[stage];
        for (i, &fifo) in clock.inputs.iter().enumerate() {
            if demand.takes(i) {
                fifos[fifo].pop(at);
            }
        }
        for (i, &fifo) in clock.outputs.iter().enumerate() {
            if made.outputs & 1 << i != 0 {
                fifos[fifo].reserve(at);
            }
        }
        let outputs = made.outputs | if made.marked { MARKED } else { 0 };
        let mut occupancy = made.occupancy;
        if traffic.is_empty() && clock.flights.is_empty() {
            clock.deliver(outputs, at + made.latency, fifos);
        } else {
            occupancy = occupancy.max(clock.depart(at, (at + made.latency, outputs), (fifos, memories), traffic));
        }
        accounts[stage].busy += occupancy;
        clock.free = at + occupancy;
        clock.steps += 1;
    }

    /// Charges the cycles that a stage waits from the end of its last step to the start of the next, at `at`.
    #[inline]
    pub(crate) fn charge_wait<P: Probe>(&mut self, stage: usize, demand: Demand, at: Cycle, probe: &mut P) {
        let Self { stages, accounts, fifos, memories, .. } = self;
        let clock = &stages[stage];
        if at > clock.free {
            let account = &mut accounts[stage];
            clock.split_wait(fifos, memories, demand, (clock.free, at), |wait| charge(account, probe, stage, wait));
        }
    }

    /// Delivers the steps of a stage in flight whose answers are known by now, and tells whether there were any. To be called
    /// before looking at the next start.
    #[inline]
    pub(crate) fn land_known(&mut self, stage: usize) -> bool {
        let clock = &mut self.stages[stage];
        !clock.flights.is_empty() && clock.land(&mut self.fifos, &mut self.memories)
    }

    /// The same for all stages.
    pub(crate) fn land_all(&mut self) {
        for stage in 0..self.stages.len() {
            self.land_known(stage);
        }
    }
}
