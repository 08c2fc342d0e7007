//! The memory ports of a unit: a step issues requests here and receives nothing back.

use crate::request::Request;
use crate::step_requests::{StepRequests, StepRequestsView, UnitRequests};
use crate::{MAX_CLIENTS, MemoryClients};

/// Requests and look-ups of a step, in order of issue. They arrive at the step's start, or at the issue rate of their port (laws 4
/// and 5). The kernel may keep those of earlier steps in front of them.
#[derive(Clone, Debug, Default)]
pub struct MemoryPorts {
    pub(crate) discards: bool,
    pub(crate) requests: Vec<Request>,
    pub(crate) look_ups: Vec<Request>,
    pub(crate) fault: Option<String>,
    /// The requests after tag look-up.
    asked: StepRequests,
}

impl MemoryPorts {
    /// Creates ports that answer at once and discard all requests, for the functional model.
    pub fn discarding() -> Self {
        Self { discards: true, ..Self::default() }
    }

    /// Returns true if requests are discarded, so their addresses need not be computed. No other result of a step may depend on
    /// it (law 6).
    #[inline(always)]
    pub fn is_discarding(&self) -> bool {
        self.discards
    }

    /// Returns the clients with requests, one bit each.
    pub(crate) fn clients(&self) -> u32 {
        self.requests.iter().chain(&self.look_ups).fold(0, |clients, request| clients | 1 << (request.client & 31))
    }

    /// Reads `bytes` at `address` through client `client`. The step delivers when the data have arrived.
    #[inline]
    pub fn read(&mut self, client: u32, address: u64, bytes: u32) {
        if !self.discards {
            self.requests.push(Request { client, write: false, address, bytes });
        }
    }

    /// Posts a write. No step waits for it, but it holds a credit of the client's port.
    #[inline]
    pub fn write(&mut self, client: u32, address: u64, bytes: u32) {
        if !self.discards {
            self.requests.push(Request { client, write: true, address, bytes });
        }
    }

    /// Looks up every line that `bytes` at `address` touch, in the cache of client `client`. A line looked up before in the same
    /// step costs nothing.
    #[inline]
    pub fn look_up(&mut self, client: u32, address: u64, bytes: u32) {
        if !self.discards {
            self.look_ups.push(Request { client, write: false, address, bytes });
        }
    }

    /// Returns ports with room for as many requests and with the same fault.
    pub(crate) fn emptied(&self) -> Self {
        let [requests, look_ups] = self.lengths().map(Vec::with_capacity);
        Self { requests, look_ups, fault: self.fault.clone(), ..Self::default() }
    }

    /// Number of requests, and of look-ups.
    #[inline(always)]
    pub(crate) fn lengths(&self) -> [usize; 2] {
        [self.requests.len(), self.look_ups.len()]
    }

    /// Returns a step's requests and look-ups from these places on, so many of each.
    #[inline(always)]
    pub(crate) fn step_at(&self, [requests, look_ups]: [usize; 2], counts: [u32; 2]) -> UnitRequests<'_> {
        UnitRequests {
            requests: &self.requests[requests..][..counts[0] as usize],
            look_ups: &self.look_ups[look_ups..][..counts[1] as usize],
        }
    }

    /// Ends the run with this message because the unit cannot continue. Use it for errors that only the data can show, such as a
    /// gathering memory that is too small, and name the parameter to change.
    pub fn fault(&mut self, message: String) {
        self.fault.get_or_insert(message);
    }

    /// Returns the requests of this step so far, for tests of units.
    pub fn requests(&self) -> &[Request] {
        &self.requests
    }

    /// Returns the look-ups of this step so far, for tests of units.
    pub fn look_ups(&self) -> &[Request] {
        &self.look_ups
    }

    /// Returns true if the step issued nothing.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.requests.is_empty() && self.look_ups.is_empty()
    }

    /// Clears the requests of the step.
    #[inline]
    pub fn clear(&mut self) {
        self.requests.clear();
        self.look_ups.clear();
        self.asked.clear();
    }

    /// Returns the distinct lines that the step looks up, with their clients. Call it after `settle`.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (u32, u64)> {
        self.asked.lines()
    }

    /// Looks up the tags and returns the requests of the step. Returns `None` and sets a fault if the requests contradict the
    /// unit's declaration or the wiring. `largest`: needs of the largest step, by client.
    #[inline(always)]
    pub(crate) fn settle(
        &mut self,
        clients: &mut MemoryClients<'_>,
        largest: &[u32; MAX_CLIENTS],
    ) -> Option<StepRequestsView<'_>> {
        let Self { requests, look_ups, asked, fault, .. } = self;
        asked.settle_now(UnitRequests { requests, look_ups }, clients, largest, fault)
    }

    /// As `settle`, for a step whose requests are elsewhere.
    #[inline(always)]
    pub(crate) fn settle_stored<'a>(
        &'a mut self,
        asks: UnitRequests<'a>,
        clients: &mut MemoryClients<'_>,
        largest: &[u32; MAX_CLIENTS],
    ) -> Option<StepRequestsView<'a>> {
        self.asked.settle_now(asks, clients, largest, &mut self.fault)
    }
}
