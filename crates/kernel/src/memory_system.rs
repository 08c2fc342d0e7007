//! All memories, ports and caches of a machine, and the order in which requests are served.

use crate::cache::{Cache, LookUp};
use crate::memory::{Memory, Port};
use crate::{CacheConfig, Cycle, MemoryConfig, Request};

/// A client: a port, with or without a cache in front of it.
#[derive(Clone, Copy, Debug)]
struct Client {
    port: usize,
    cache: Option<usize>,
}

/// The memories of a machine.
///
/// Ports are numbered within their memory in the order in which their clients are added, so the order of wires cannot
/// matter (law 4).
#[derive(Clone, Debug, Default)]
pub struct MemorySystem {
    memories: Vec<Memory>,
    ports: Vec<Port>,
    caches: Vec<Cache>,
    clients: Vec<Client>,
}

impl MemorySystem {
    /// Adds a memory and returns its number.
    pub fn add_memory(&mut self, name: &str, config: &MemoryConfig) -> usize {
        self.memories.push(Memory::new(name, config));
        self.memories.len() - 1
    }

    /// Adds a client with a port of its own on `memory`; returns the client's number.
    pub fn add_client(&mut self, name: &str, memory: usize, outstanding: u32) -> usize {
        self.ports.push(Port::new(name, memory, outstanding));
        self.memories[memory].ports.push(self.ports.len() - 1);
        self.clients.push(Client { port: self.ports.len() - 1, cache: None });
        self.clients.len() - 1
    }

    /// Adds a client whose reads go through a cache of its own.
    pub fn add_cached_client(
        &mut self,
        name: &str,
        memory: usize,
        outstanding: u32,
        cache_name: &str,
        cache: &CacheConfig,
    ) -> usize {
        let client = self.add_client(name, memory, outstanding);
        self.caches.push(Cache::new(cache_name, cache));
        self.clients[client].cache = Some(self.caches.len() - 1);
        client
    }

    /// Name of a client's port.
    pub fn client_name(&self, client: usize) -> &str {
        &self.port(client).name
    }

    /// Name of the memory behind a client.
    pub fn memory_name(&self, client: usize) -> &str {
        &self.memories[self.port(client).memory].name
    }

    /// Name of the cache in front of a client's port, where there is one.
    pub fn cache_name(&self, client: usize) -> Option<&str> {
        self.clients[client].cache.map(|c| self.caches[c].name.as_str())
    }

    pub(crate) fn memories(&self) -> &[Memory] {
        &self.memories
    }

    pub(crate) fn ports(&self) -> &[Port] {
        &self.ports
    }

    pub(crate) fn caches(&self) -> &[Cache] {
        &self.caches
    }

    #[inline]
    fn port(&self, client: usize) -> &Port {
        &self.ports[self.clients[client].port]
    }

    /// Memory and port of a client: the order in which a step's answers are listed.
    pub(crate) fn service_rank(&self, client: usize) -> (usize, usize) {
        (self.port(client).memory, self.clients[client].port)
    }

    /// Marks the memories that a single stage uses; `stages` lists each stage's clients.
    pub(crate) fn find_private(&mut self, stages: &[Vec<usize>]) {
        for m in 0..self.memories.len() {
            let users = stages.iter().filter(|ids| ids.iter().any(|&c| self.port(c).memory == m)).count();
            self.memories[m].private = users <= 1;
        }
    }

    /// Forgets which memories are private: the ticked engine serves them all alike.
    pub(crate) fn share_all(&mut self) {
        self.memories.iter_mut().for_each(|m| m.private = false);
    }

    #[inline(always)]
    pub(crate) fn credits_at(&self, client: usize, credits: u32) -> Cycle {
        self.port(client).credits_at(credits)
    }

    /// Answer to a client's request `number`.
    #[inline]
    pub(crate) fn answer(&self, client: usize, number: u64) -> Cycle {
        self.port(client).answer(number)
    }

    /// Requests of a client that have been served: the answers to all before are known.
    #[inline]
    pub(crate) fn served(&self, client: usize) -> u64 {
        self.port(client).served
    }

    /// Keeps a client's answers from request `number` on, for steps in flight.
    #[inline]
    pub(crate) fn keep_from(&mut self, client: usize, number: u64) {
        self.ports[self.clients[client].port].keep_from = number;
    }

    /// A direct request; returns its number.
    #[inline]
    pub(crate) fn issue(&mut self, client: usize, arrival: Cycle, address: u64, bytes: u32, write: bool) -> u64 {
        let port = &mut self.ports[self.clients[client].port];
        self.memories[port.memory].queued += 1;
        port.issue(arrival, address, bytes, write)
    }

    /// Cycles that a client's cache takes for this many look-ups.
    #[inline]
    pub(crate) fn look_up_cycles(&self, client: usize, look_ups: u64) -> u64 {
        let per_cycle = self.clients[client].cache.map_or(1, |c| u64::from(self.caches[c].config.lookups_per_cycle.max(1)));
        // A division takes longer than all the rest.
        if look_ups <= per_cycle { 1 } else { look_ups.div_ceil(per_cycle) }
    }

    /// Looks up the lines that a request of a step touches and that the step has not looked up yet (`fresh` lists those it
    /// has), and tells how many these are. `ids`: the clients of the unit.
    #[inline(always)]
    pub(crate) fn look_up(&mut self, ids: &[usize], request: &Request, start: Cycle, fresh: &mut Vec<LookUp>) -> u64 {
        let client = request.client as usize;
        let Client { port, cache } = self.clients[ids[client]];
        let Some(cache) = cache.map(|c| &mut self.caches[c]) else { return 0 };
        let port = &mut self.ports[port];
        let memory = &mut self.memories[port.memory];
        let (first, last) = cache.lines(request.address, request.bytes);
        let before = fresh.len();
        for line in first..last + 1 {
            if fresh.iter().any(|l| l.line == line && l.client == client) {
                continue;
            }
            let bytes = cache.config.line_bytes;
            let (request, missed) = cache.look_up(line, || {
                memory.queued += 1;
                port.issue(start, line * u64::from(bytes), bytes, false)
            });
            fresh.push(LookUp { client, line, start, request, fill: port.answer(request), missed });
        }
        (fresh.len() - before) as u64
    }

    /// The answer of a look-up, if its fill is known by now. To be asked in order of look-up.
    #[inline(always)]
    pub(crate) fn resolve(&mut self, client: usize, look_up: &LookUp) -> Option<Cycle> {
        let Client { port, cache } = self.clients[client];
        let fill = if look_up.fill.is_known() { look_up.fill } else { self.ports[port].answer(look_up.request) };
        if fill.is_known() { Some(self.caches[cache?].resolve(look_up, fill)) } else { None }
    }

    /// Serves at once what a client's memory has queued, if no other stage uses that memory.
    #[inline(always)]
    pub(crate) fn serve_if_private(&mut self, client: usize) {
        let memory = self.port(client).memory;
        if self.memories[memory].queued > 0 && self.memories[memory].private {
            self.serve_before(memory, Cycle::UNKNOWN);
        }
    }

    /// Serves every request that no request still to come can precede, and tells whether there was any.
    ///
    /// To be called when no step can start before an answer is known. Then the earliest step still to come waits,
    /// through whatever chain, for a request that is queued here: it starts no earlier than the earliest answer that any
    /// memory can still give, and so do its own requests. All that arrive before that are served now.
    pub(crate) fn serve_safe(&mut self) -> bool {
        let waiting = self.memories.iter().filter(|m| m.queued > 0);
        let first_arrival = |m: &Memory| m.ports.iter().filter_map(|&p| self.ports[p].next_arrival()).min();
        let horizon = waiting.filter_map(|m| Some(m.earliest_answer(first_arrival(m)?))).min();
        let Some(horizon) = horizon else { return false };
        for memory in 0..self.memories.len() {
            self.serve_before(memory, horizon);
        }
        true
    }

    /// Serves what arrived at `memory` before `horizon`, in order of (arrival, port number, issue).
    fn serve_before(&mut self, memory: usize, horizon: Cycle) {
        let (memory, ports) = (&mut self.memories[memory], &mut self.ports);
        while memory.queued > 0 {
            let waiting = memory.ports.iter().filter_map(|&p| Some((ports[p].next_arrival()?, p)));
            // `min_by_key` returns the first of equals, and ports stand in order of number.
            match waiting.min_by_key(|&(arrival, _)| arrival) {
                Some((arrival, port)) if arrival < horizon => memory.serve(&mut ports[port]),
                _ => return,
            }
        }
    }

    /// Serves all that has arrived; for the ticked engine, at the end of each cycle.
    pub(crate) fn serve_all(&mut self) {
        for memory in 0..self.memories.len() {
            self.serve_before(memory, Cycle::UNKNOWN);
        }
    }

    /// The last cycle in which anything moved here or a credit came back, plus one.
    pub(crate) fn data_end(&self) -> Cycle {
        self.memories.iter().map(|m| m.data_end).max().unwrap_or(Cycle::ZERO)
    }

    /// The last answer on any port.
    pub(crate) fn last_answer(&self) -> Cycle {
        self.ports.iter().map(Port::last_answer).max().unwrap_or(Cycle::ZERO)
    }
}
