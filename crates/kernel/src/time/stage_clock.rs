//! The times of a stage: when it is free, what it has in flight, where its cycles went.

use super::in_flight::InFlightSteps;
use super::port_ids::PortIds;
use super::{FifoTiming, InputMask, StepTiming};
use crate::account::{Account, Cause};
use crate::capacity::MAX_CLIENTS;
use crate::netlist::StageInfo;
use crate::probe::Probe;
use crate::{Cycle, Demand, MemorySystem};

/// A wait: why, its first cycle, and the cycle after its last.
pub(crate) type Wait = (Cause, Cycle, Cycle);

/// The times of a stage.
#[derive(Clone, Debug)]
pub(crate) struct StageClock {
    pub(crate) free: Cycle,
    pub(crate) steps: u64,
    pub(super) busy: u64,
    /// Its FIFOs.
    pub(super) inputs: PortIds,
    pub(super) outputs: PortIds,
    /// Its steps keep it for a cycle, and deliver as much earlier.
    ideal: bool,
    /// Numbers of its memory clients.
    pub(super) clients: Box<[usize]>,
    pub(super) needs: MemoryNeeds,
    /// Whether it has a memory to itself.
    pub(super) has_private: bool,
    pub(super) flights: InFlightSteps,
    /// It is to be visited whether there is news for it or not.
    pub(crate) again: bool,
    /// Requests of its clients that had been served when it was last visited.
    pub(super) served: u64,
    /// Deliveries that passed a mark.
    pub(super) marks: Vec<Cycle>,
}

/// What a stage asks of its memory clients in every step.
#[derive(Clone, Debug)]
pub(super) struct MemoryNeeds {
    /// Credits that the largest step needs, by client.
    pub(super) credits: [u32; MAX_CLIENTS],
    /// The same of the clients that it needs any of.
    pub(super) of: Box<[CreditNeed]>,
    /// Whether it has asked any of them for anything in its last step: otherwise they have the credits that they had.
    pub(super) asked: bool,
    /// Clients in the order in which their memories serve them.
    pub(super) served_in_order: [usize; MAX_CLIENTS],
}

/// Credits of a client.
#[derive(Clone, Copy, Debug)]
pub(super) struct CreditNeed {
    /// Client as its unit numbers it, and as the memories do.
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
            again: true,
            served: 0,
            marks: Vec::new(),
        }
    }

    /// What its next step takes, by what its unit declares.
    #[inline(always)]
    pub(crate) fn takes(&self, demand: Demand) -> InputMask {
        InputMask::of(demand, self.inputs.count(None))
    }

    /// How long a step keeps the unit, and how long it takes to deliver, as far as it does not depend on memory.
    #[inline(always)]
    pub(super) fn kept(&self, &StepTiming { occupancy, latency, .. }: &StepTiming) -> (u64, u64) {
        if self.ideal { (1, latency.saturating_sub(occupancy.saturating_sub(1))) } else { (occupancy, latency) }
    }

    /// Notes what the oldest slot holders wait for, as far as it is known by now: for who asks in every cycle.
    pub(crate) fn record_awaits(&self, fifos: &[FifoTiming], memories: &MemorySystem) {
        if self.clients.is_empty() {
            return;
        }
        self.flights.oldest(|flight, to| {
            for (_, fifo) in self.outputs.of(to & self.outputs.all()) {
                fifos[fifo].set_awaits(flight.awaited(&self.clients, memories));
            }
        });
    }
}

/// Charges a wait of stage `stage` to its account and shows it to the probe.
#[inline]
pub(crate) fn charge<P: Probe>(account: &mut Account, probe: &mut P, stage: usize, (cause, from, to): Wait) {
    account.charge(cause, to.since(from));
    if P::is_on() {
        probe.waited(stage, cause, from, to);
    }
}
