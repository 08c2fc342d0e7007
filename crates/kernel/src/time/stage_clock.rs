//! Times of a stage: its clock, its steps in flight, and its waits.

use super::blocking_wait::BlockingWait;
use super::in_flight::InFlightSteps;
use super::port_ids::PortIds;
use super::{FifoTiming, InputMask, StepTiming};
use crate::account::{CycleAccount, Wait};
use crate::capacity::MAX_CLIENTS;
use crate::netlist::StageInfo;
use crate::probe::Probe;
use crate::{Cycle, Demand, MemorySystem};

/// The number of a step, and the cycles of its answers by memory client.
pub(super) type StepAnswers = (u64, [Cycle; MAX_CLIENTS]);

/// Times of a stage.
#[derive(Clone, Debug)]
pub(crate) struct StageClock {
    pub(crate) free: Cycle,
    pub(crate) steps: u64,
    pub(super) busy: u64,
    /// Its FIFOs.
    pub(super) inputs: PortIds,
    pub(super) outputs: PortIds,
    /// True if its steps occupy it for one cycle and deliver as much earlier.
    ideal: bool,
    /// Numbers of its memory clients.
    pub(super) clients: Box<[usize]>,
    pub(super) needs: MemoryNeeds,
    /// True if a memory is used by this stage only.
    pub(super) has_private: bool,
    pub(super) flights: InFlightSteps,
    /// The wait for the answers of its last blocking step.
    pub(crate) block: BlockingWait,
    /// True if it must be visited even without news.
    pub(crate) again: bool,
    /// Served requests of its clients at the last visit.
    pub(super) served: u64,
    /// Deliveries that passed a mark.
    pub(super) marks: Vec<Cycle>,
    /// Answers of steps that awaited some, since they were last taken, if a probe reads them.
    pub(super) answers: Option<Vec<StepAnswers>>,
}

/// Credits that a stage needs of its memory clients in every step.
#[derive(Clone, Debug)]
pub(super) struct MemoryNeeds {
    /// Credits that the largest step needs, by client.
    pub(super) credits: [u32; MAX_CLIENTS],
    /// The same for clients with a need above 0.
    pub(super) of: Box<[CreditNeed]>,
    /// True if its last step issued requests. Otherwise credits have not changed.
    pub(super) asked: bool,
    /// Clients in the order in which their memories serve them.
    pub(super) served_in_order: [usize; MAX_CLIENTS],
}

/// Credits of a client.
#[derive(Clone, Copy, Debug)]
pub(super) struct CreditNeed {
    /// Client number within the unit, and within the memories.
    pub(super) place: usize,
    pub(super) client: usize,
    pub(super) credits: u32,
}

impl MemoryNeeds {
    fn new(clients: &[usize], credits: &[u32; MAX_CLIENTS], memories: &MemorySystem) -> Self {
        let mut served_in_order = std::array::from_fn(|i| i);
        served_in_order[..clients.len()].sort_by_key(|&i| memories.service_rank(clients[i]));
        let of =
            clients.iter().zip(credits).enumerate().map(|(place, (&client, &credits))| CreditNeed { place, client, credits });
        Self { credits: *credits, of: of.filter(|need| need.credits > 0).collect(), asked: true, served_in_order }
    }
}

impl StageClock {
    pub(super) fn new(shape: &StageInfo, memories: &MemorySystem) -> Self {
        let StageInfo { inputs, outputs, clients, credits, ideal, .. } = shape;
        Self {
            free: Cycle::ZERO,
            steps: 0,
            busy: 0,
            ideal: *ideal,
            inputs: PortIds::new(inputs),
            outputs: PortIds::new(outputs),
            clients: clients.as_slice().into(),
            needs: MemoryNeeds::new(clients, credits, memories),
            has_private: memories.has_private(clients),
            flights: InFlightSteps::default(),
            block: BlockingWait::default(),
            again: true,
            served: 0,
            marks: Vec::new(),
            answers: None,
        }
    }

    /// Converts a demand of its unit to a mask.
    #[inline(always)]
    pub(crate) fn inputs_of(&self, demand: Demand) -> InputMask {
        InputMask::of(demand, self.inputs.count(None))
    }

    /// Returns the occupancy and the latency of a step, as far as they do not depend on memory.
    #[inline(always)]
    pub(super) fn known_timing(&self, &StepTiming { occupancy, latency, .. }: &StepTiming) -> (u64, u64) {
        if self.ideal { (1, latency.saturating_sub(occupancy.saturating_sub(1))) } else { (occupancy, latency) }
    }

    /// Returns the first cycle in which its last step keeps it no longer; unknown while a blocking step waits for an answer.
    pub(crate) fn released(&self) -> Cycle {
        self.free.max(self.block.until)
    }

    /// Returns a lower bound of the cycle in which a blocking step keeps it no longer.
    pub(super) fn no_release_before(&self, memories: &mut MemorySystem) -> Cycle {
        let until = self.block.until;
        if until.is_known() { until } else { self.flights.no_release_before(&self.clients, memories) }
    }

    /// Records the known answers that a blocking step and the oldest slot holders wait for, for the engine that asks in every
    /// cycle.
    pub(crate) fn record_awaits(&mut self, fifos: &[FifoTiming], memories: &MemorySystem) {
        if self.clients.is_empty() {
            return;
        }
        if let Some(flight) = self.flights.blocking() {
            self.block.note(flight.awaited(&self.clients, memories));
        }
        self.flights.oldest(|flight, to| {
            for (_, fifo) in self.outputs.of(to & self.outputs.all()) {
                fifos[fifo].set_awaits(flight.awaited(&self.clients, memories));
            }
        });
    }
}

/// Charges a wait of stage `stage` to its account and reports it to the probe.
#[inline]
pub(crate) fn charge<P: Probe>(account: &mut CycleAccount, probe: &mut P, stage: usize, Wait { cause, from, to }: Wait) {
    account.charge(cause, to.since(from));
    if P::is_on() {
        probe.on_stall(stage, cause, from, to);
    }
}
