//! Timing: the cycles that follow from the work of units. It has no units and no tokens. It holds the clock and the steps in
//! flight of each stage, the times of each FIFO's slots, and the memories.

mod blocking_wait;
mod compact_step;
mod fifo_timing;
mod finalize;
mod in_flight;
mod input_mask;
mod kept_tokens;
mod next_start;
mod occupancy;
mod path_cycles;
mod path_tracer;
mod path_walk;
mod port_ids;
mod stage_clock;
mod stage_cursor;
mod stage_visit;
mod step_timing;
mod token_ring;

pub(crate) use compact_step::CompactStep;
pub(crate) use fifo_timing::{FifoMemory, FifoTiming};
pub(crate) use finalize::{FinalUnitState, StopReason};
pub(crate) use input_mask::InputMask;
pub(crate) use path_tracer::PathTracer;
pub(crate) use stage_clock::{StageClock, charge};
pub(crate) use stage_visit::StageVisit;
pub(crate) use step_timing::{AnyArity, StageArity, StepTiming};

use crate::memory_events::EventBounds;
use crate::netlist::{FifoSpec, Netlist};
use crate::{Cycle, CycleAccount, MemorySystem, Probe};

/// The timing state of a run.
#[derive(Clone, Debug)]
pub(crate) struct MachineTiming {
    pub(crate) shape: Netlist,
    pub(crate) stages: Vec<StageClock>,
    pub(crate) accounts: Vec<CycleAccount>,
    pub(crate) fifos: Vec<FifoTiming>,
    /// A FIFO without tokens, for places of a stage without one.
    no_fifo: FifoTiming,
    pub(crate) memories: MemorySystem,
    /// True if waits are charged and occupancy is counted.
    pub(crate) accounts_for: bool,
    /// No step starts in this cycle or later.
    pub(crate) limit: Cycle,
}

impl MachineTiming {
    /// Creates the state at power-on.
    pub(crate) fn new(shape: Netlist) -> Self {
        Self::in_memory(shape, Vec::new())
    }

    /// Creates the state at power-on in the memory of the FIFOs of an earlier run.
    pub(crate) fn in_memory(mut shape: Netlist, memory: Vec<FifoMemory>) -> Self {
        let mut memories = std::mem::take(&mut shape.memories);
        memories.find_private(shape.stages.iter().map(|stage| stage.clients.as_slice()));
        let stages: Vec<_> = shape.stages.iter().map(|stage| StageClock::new(stage, &memories)).collect();
        let has_clients = |stage: usize| !shape.stages[stage].clients.is_empty();
        let memory = memory.into_iter().chain(std::iter::repeat_with(FifoMemory::default));
        let fifos = shape.fifos.iter().zip(memory);
        let fifos = fifos.map(|(fifo, memory)| FifoTiming::new(fifo, has_clients(fifo.producer), memory)).collect();
        let (accounts, limit) = (vec![CycleAccount::default(); shape.stages.len()], Cycle::UNKNOWN);
        let no_fifo = FifoTiming::new(&FifoSpec::default(), false, FifoMemory::default());
        Self { accounts, shape, stages, fifos, no_fifo, memories, accounts_for: true, limit }
    }

    /// Returns the memory of its FIFOs, for the next run.
    pub(crate) fn into_fifo_memory(self) -> Vec<FifoMemory> {
        self.fifos.into_iter().map(FifoTiming::into_memory).collect()
    }

    /// Switches accounting off, for runs that need only times.
    pub(crate) fn account_for_nothing(&mut self) {
        self.accounts_for = false;
        self.fifos.iter_mut().for_each(FifoTiming::count_nothing);
    }

    /// Forgets the answers that tokens waited for: only accounts and critical paths need them.
    pub(crate) fn forget_awaits(&mut self) {
        self.fifos.iter_mut().for_each(FifoTiming::forget_awaits);
    }

    /// Returns a stage to work on, and the netlist.
    #[inline(always)]
    pub(crate) fn visit<K: StageArity>(&mut self, stage: usize) -> (StageVisit<'_>, &Netlist) {
        let Self { shape, stages, accounts, fifos, no_fifo, memories, .. } = self;
        let (clock, account) = (&mut stages[stage], &mut accounts[stage]);
        let inputs = clock.inputs.join(fifos, no_fifo, K::INPUTS);
        let outputs = clock.outputs.join(fifos, no_fifo, K::OUTPUTS);
        (StageVisit { stage, clock, account, fifos, memories, inputs, outputs }, shape)
    }

    /// Makes room for the times of further tokens on the outputs of a stage, where that is necessary.
    pub(crate) fn grow_outputs(&mut self, stage: usize) {
        let outputs = self.stages[stage].outputs;
        outputs.of(outputs.all()).for_each(|(_, fifo)| self.fifos[fifo].grow());
    }

    /// Records FIFO levels and memory events, if the probe reads them.
    pub(crate) fn keep_fills<P: Probe>(&mut self, probe: &P) {
        if P::is_on() && probe.reads_levels() {
            self.fifos.iter().for_each(|fifo| fifo.keep_fills(probe.reads_visible()));
            self.memories.keep_events();
        }
        if P::is_on() && probe.reads_wires() {
            self.fifos.iter().for_each(|fifo| fifo.keep_tokens(true));
            self.stages.iter_mut().for_each(|clock| clock.answers = Some(Vec::new()));
        }
    }

    /// Emits FIFO levels and memory events to a probe, as far as they are settled, or up to the `end` of the run.
    pub(crate) fn show_fills<P: Probe>(&mut self, probe: &mut P, end: Option<Cycle>) {
        let (levels, wires) = (P::is_on() && probe.reads_levels(), P::is_on() && probe.reads_wires());
        if !levels && !wires {
            return;
        }
        let bounds = EventBounds { limit: self.limit, end };
        for (number, fifo) in self.fifos.iter().enumerate() {
            let visible = fifo.take_visible();
            if levels {
                fifo.take_fills(end).into_iter().for_each(|(at, slots)| probe.on_occupancy(number, at, slots));
                fifo.emit_visible(&visible, bounds, |at, tokens| probe.on_visible_count(number, at, tokens));
            }
            if wires {
                visible.into_iter().for_each(|visible| probe.on_visible(number, visible));
            }
        }
        if levels {
            self.memories.emit(probe, bounds);
        }
        if wires {
            for (number, clock) in self.stages.iter_mut().enumerate() {
                for (step, answers) in clock.answers.iter_mut().flat_map(|answers| answers.drain(..)) {
                    probe.on_answers(number, step, &answers);
                }
            }
        }
    }

    /// Delivers the steps of all stages in flight whose answers are known by now.
    pub(crate) fn land_all(&mut self) {
        for stage in 0..self.stages.len() {
            self.visit::<AnyArity>(stage).0.deliver_known_steps::<AnyArity>();
        }
    }
}
