//! Start of the next step of a stage, and the causes of its wait (laws 3 and 9).

use super::port_ids::ConnectedFifos;
use super::stage_clock::CreditNeed;
use super::{AnyArity, InputMask, MachineTiming, StageArity, StageClock};
use crate::account::Wait;
use crate::{Cycle, Demand, MemorySystem, StallCause};
use std::ops::Range;

impl MachineTiming {
    /// See [`StageClock::next_start`].
    pub(crate) fn next_start(&self, stage: usize, demand: Demand) -> Cycle {
        let clock = &self.stages[stage];
        let [inputs, outputs] = [clock.inputs, clock.outputs].map(|ends| ends.join(&self.fifos, &self.no_fifo, None));
        clock.next_start::<AnyArity>(&inputs, &outputs, &self.memories, clock.inputs_of(demand))
    }

    /// Splits the wait of a stage into its causes (law 9), in order, and passes each to `charge`.
    pub(crate) fn split_wait(&self, stage: usize, demand: Demand, interval: Range<Cycle>, charge: impl FnMut(Wait)) {
        let clock = &self.stages[stage];
        let [inputs, outputs] = [clock.inputs, clock.outputs].map(|ends| ends.join(&self.fifos, &self.no_fifo, None));
        clock.split_wait::<AnyArity>(&inputs, &outputs, &self.memories, clock.inputs_of(demand), interval, charge);
    }
}

impl StageClock {
    /// Returns the earliest start of a stage's next step (law 3); unknown while it depends on an unknown time, and if there is no
    /// further step.
    #[inline(always)]
    pub(super) fn next_start<K: StageArity>(
        &self,
        inputs: &ConnectedFifos<'_>,
        outputs: &ConnectedFifos<'_>,
        memories: &MemorySystem,
        takes: InputMask,
    ) -> Cycle {
        if takes == InputMask::NO_STEP {
            return Cycle::UNKNOWN;
        }
        let mut at = if K::HAS_MEMORY { self.released() } else { self.free };
        inputs.each(takes.inputs(), K::INPUTS, |_, fifo| at = at.max(fifo.front_visible()));
        // Most visits end here. Other unknown times make no difference.
        if !at.is_known() {
            return at;
        }
        outputs.each(outputs.all(K::OUTPUTS), K::OUTPUTS, |_, fifo| at = at.max(fifo.room_at()));
        if K::HAS_MEMORY && self.needs.asked {
            for &CreditNeed { client, credits, .. } in &self.needs.of {
                at = at.max(memories.credits_at(client, credits));
            }
        }
        at
    }

    /// See [`MachineTiming::split_wait`].
    ///
    /// The first cause that applies counts in each cycle, and every condition, once met, stays met until the step starts. So the
    /// causes follow each other in the order of the checks, and a running maximum splits the interval.
    #[inline(always)]
    pub(super) fn split_wait<K: StageArity>(
        &self,
        inputs: &ConnectedFifos<'_>,
        outputs: &ConnectedFifos<'_>,
        memories: &MemorySystem,
        takes: InputMask,
        Range { start, end }: Range<Cycle>,
        mut charge: impl FnMut(Wait),
    ) {
        let at = if K::HAS_MEMORY && self.block.until > start { self.block.split(start, end, &mut charge) } else { start };
        let mut wait = WaitSplitter { at, to: end, charge };
        inputs.each(takes.inputs(), K::INPUTS, |i, fifo| wait.until(StallCause::Starved(i), fifo.front_visible()));
        if wait.is_over() {
            return;
        }
        if K::HAS_MEMORY && self.needs.asked {
            for &CreditNeed { place, client, credits } in &self.needs.of {
                wait.until(StallCause::Memory(place), memories.credits_at(client, credits));
            }
        }
        outputs.each(outputs.all(K::OUTPUTS), K::OUTPUTS, |i, fifo| {
            let room = fifo.room_at();
            // Usually there is room, and the slot holders do not matter.
            if room <= wait.at {
                return;
            }
            if K::HAS_MEMORY {
                for &client in self.needs.served_in_order.iter().take(self.clients.len()) {
                    wait.until(StallCause::Memory(client), fifo.oldest_awaits(client).min(room));
                }
            }
            wait.until(StallCause::Blocked(i), room);
        });
    }
}

/// A wait that is being charged.
struct WaitSplitter<F> {
    at: Cycle,
    to: Cycle,
    charge: F,
}

impl<F: FnMut(Wait)> WaitSplitter<F> {
    /// Charges the rest up to `end` to this cause.
    #[inline(always)]
    fn until(&mut self, cause: StallCause, end: Cycle) {
        let end = end.min(self.to);
        if end > self.at {
            (self.charge)(Wait { cause, from: self.at, to: end });
            self.at = end;
        }
    }

    /// Returns true if nothing is left.
    fn is_over(&self) -> bool {
        self.at >= self.to
    }
}
