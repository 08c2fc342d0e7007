//! The wait of a unit for the answers of its blocking step (laws 3 and 9).

use crate::account::Wait;
use crate::capacity::MAX_CLIENTS;
use crate::{Cycle, StallCause};

/// Clients of a step, in order of first mention.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ClientOrder {
    count: u8,
    clients: [u8; MAX_CLIENTS],
}

impl ClientOrder {
    /// Appends a client, unless it is mentioned already.
    pub(crate) fn mention(&mut self, client: usize) {
        if self.iter().all(|known| known != client)
            && let Some(place) = self.clients.get_mut(usize::from(self.count))
        {
            *place = client as u8;
            self.count += 1;
        }
    }

    fn iter(&self) -> impl Iterator<Item = usize> {
        self.clients.iter().take(usize::from(self.count)).map(|&client| usize::from(client))
    }
}

/// The answers for which the last blocking step of a stage keeps its unit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BlockingWait {
    /// The cycle of the last answer; unknown while any answer is unknown.
    pub(crate) until: Cycle,
    order: ClientOrder,
    /// Answers by client, as far as they are known.
    answers: [Cycle; MAX_CLIENTS],
}

impl BlockingWait {
    /// Begins the wait of a step that mentions these clients.
    pub(crate) fn begin(&mut self, order: ClientOrder) {
        *self = Self { until: Cycle::UNKNOWN, order, answers: [Cycle::UNKNOWN; MAX_CLIENTS] };
    }

    /// Records the answers that are known.
    pub(crate) fn note(&mut self, answers: [Cycle; MAX_CLIENTS]) {
        self.answers = answers;
    }

    /// Ends the wait: all answers are known. The unit is free from the last of them on.
    pub(crate) fn release(&mut self, answers: [Cycle; MAX_CLIENTS]) {
        self.answers = answers;
        self.until = answers.into_iter().fold(Cycle::ZERO, Cycle::max);
    }

    /// Passes the cycles of an interval in which the unit waits to `charge`, by the first client whose answer is missing. Returns
    /// the start of the rest of the interval.
    pub(super) fn split(&self, mut from: Cycle, to: Cycle, charge: &mut impl FnMut(Wait)) -> Cycle {
        for client in self.order.iter() {
            let end = self.answers[client].min(to);
            if end > from {
                charge(Wait { cause: StallCause::Memory(client), from, to: end });
                from = end;
            }
        }
        from
    }

    /// Returns the client whose answer ended the wait at `at`.
    pub(crate) fn last(&self, at: Cycle) -> Option<usize> {
        self.order.iter().find(|&client| self.answers[client] == at)
    }
}
