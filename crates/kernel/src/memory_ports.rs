//! The port handle that a step is given: it takes requests and tells nothing.

use crate::request::Request;
use crate::step_requests::{Cursor, StepRequests, StepRequestsView, objection};
use crate::{MAX_CLIENTS, MemorySystem};

/// Requests and look-ups of one step, in order of issue. All arrive at the step's start (laws 4 and 5).
#[derive(Clone, Debug, Default)]
pub struct MemoryPorts {
    pub(crate) discards: bool,
    pub(crate) requests: Vec<Request>,
    pub(crate) look_ups: Vec<Request>,
    pub(crate) fault: Option<String>,
    /// What it comes to, once tags are asked.
    asked: StepRequests,
    at: Cursor,
}

impl MemoryPorts {
    /// A handle that answers at once and keeps no account: the functional model's.
    pub fn discarding() -> Self {
        Self { discards: true, ..Self::default() }
    }

    /// Whether nobody hears what is asked, so that it need not be worked out. Nothing else that a step does may depend on it (law 6).
    #[inline(always)]
    pub fn is_discarding(&self) -> bool {
        self.discards
    }

    /// The clients that were asked for something, one bit each.
    pub(crate) fn clients(&self) -> u32 {
        self.requests.iter().chain(&self.look_ups).fold(0, |clients, request| clients | 1 << (request.client & 31))
    }

    /// Reads `bytes` at `address` through client `client`; the step delivers when the data are there.
    #[inline]
    pub fn read(&mut self, client: u32, address: u64, bytes: u32) {
        if !self.discards {
            self.requests.push(Request { client, write: false, address, bytes });
        }
    }

    /// Posts a write; nothing waits for it, but it holds a credit of the client's port.
    #[inline]
    pub fn write(&mut self, client: u32, address: u64, bytes: u32) {
        if !self.discards {
            self.requests.push(Request { client, write: true, address, bytes });
        }
    }

    /// Looks up every line that `bytes` at `address` touch, in the cache behind client `client`. Lines mentioned
    /// before in the same step cost nothing.
    #[inline]
    pub fn look_up(&mut self, client: u32, address: u64, bytes: u32) {
        if !self.discards {
            self.look_ups.push(Request { client, write: false, address, bytes });
        }
    }

    /// Asks what was asked before, by somebody else.
    #[inline(always)]
    pub(crate) fn ask(&mut self, requests: &[Request], look_ups: &[Request]) {
        self.requests.extend_from_slice(requests);
        self.look_ups.extend_from_slice(look_ups);
    }

    /// The unit cannot go on: the run ends with this message. For what only the data can show, such as a gathering
    /// memory that is too small; say which parameter to change.
    pub fn fault(&mut self, message: String) {
        self.fault.get_or_insert(message);
    }

    /// Requests of this step so far; for tests of a unit.
    pub fn requests(&self) -> &[Request] {
        &self.requests
    }

    /// Look-ups of this step so far; for tests of a unit.
    pub fn look_ups(&self) -> &[Request] {
        &self.look_ups
    }

    /// Whether the step issued nothing.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.requests.is_empty() && self.look_ups.is_empty()
    }

    /// Forgets the step's requests.
    #[inline]
    pub fn clear(&mut self) {
        self.requests.clear();
        self.look_ups.clear();
        self.asked.clear();
        self.at = Cursor::default();
    }

    /// The lines that the step looks up, each once, with their clients; to be asked once it is settled.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (u32, u64)> {
        self.asked.lines()
    }

    /// What the step asks, its tags asked; none, and a fault, where that is not what its unit declared or the machine wired:
    /// `largest` is what the largest step needs, by client.
    #[inline(always)]
    pub(crate) fn settle(
        &mut self,
        (ids, memories): (&[usize], &mut MemorySystem),
        largest: &[u32; MAX_CLIENTS],
    ) -> Option<StepRequestsView<'_>> {
        let asks = (self.requests.as_slice(), self.look_ups.as_slice());
        if !self.asked.settle(asks, (ids, &mut *memories), largest) {
            let text = objection(asks, (ids, memories), largest);
            self.fault(text);
            return None;
        }
        Some(self.asked.all(&mut self.at))
    }
}
