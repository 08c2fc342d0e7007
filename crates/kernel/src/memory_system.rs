//! All memories, ports and caches of a machine, and the order in which requests are served.

use crate::cache::{Cache, Fill, LookUp};
use crate::memory::{Memory, Port};
use crate::{CacheConfig, Cycle, MemoryConfig};

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
    /// Ports in order of (memory, number): the order in which a step's answers are listed.
    service_order: Vec<usize>,
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
        let rank = self.ports.iter().filter(|p| p.memory <= memory).count() - 1;
        self.service_order.insert(rank, self.ports.len() - 1);
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

    /// Memory and place in its order of ports, of a client.
    pub(crate) fn service_rank(&self, client: usize) -> usize {
        let port = self.clients[client].port;
        self.service_order.iter().position(|&p| p == port).unwrap_or(usize::MAX)
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

    #[inline]
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
        self.ports[self.clients[client].port].issue(arrival, address, bytes, write)
    }

    /// Bytes of a line of a client's cache; 0 where it has none.
    pub(crate) fn line_bytes(&self, client: usize) -> u64 {
        self.clients[client].cache.map_or(0, |c| u64::from(self.caches[c].config.line_bytes.max(1)))
    }

    /// Look-ups per cycle of a client's cache.
    pub(crate) fn lookups_per_cycle(&self, client: usize) -> u64 {
        self.clients[client].cache.map_or(1, |c| u64::from(self.caches[c].config.lookups_per_cycle.max(1)))
    }

    /// One look-up of a step that starts at `start`.
    #[inline]
    pub(crate) fn look_up(&mut self, client: usize, start: Cycle, line: u64) -> LookUp {
        let Client { port, cache } = self.clients[client];
        let port = &mut self.ports[port];
        let Some(cache) = cache.map(|c| &mut self.caches[c]) else {
            return LookUp { line, start, fill: Fill::Known(Cycle::ZERO), missed: false };
        };
        let bytes = cache.config.line_bytes;
        let (request, missed) = cache.look_up(line, || port.issue(start, line * u64::from(bytes), bytes, false));
        let known = port.answer(request);
        let fill = if known.is_known() { Fill::Known(known) } else { Fill::Request(request) };
        LookUp { line, start, fill, missed }
    }

    /// The answer of a look-up, if its fill is known by now. To be asked in order of look-up.
    #[inline]
    pub(crate) fn resolve(&mut self, client: usize, look_up: LookUp) -> Option<Cycle> {
        let fill = match look_up.fill {
            Fill::Known(at) => at,
            Fill::Request(number) => self.port(client).answer(number),
        };
        let cache = self.clients[client].cache?;
        fill.is_known().then(|| self.caches[cache].resolve(look_up, fill))
    }

    /// Serves at once what a client's memory has queued, if no other stage uses that memory.
    #[inline]
    pub(crate) fn serve_if_private(&mut self, client: usize) {
        let memory = self.port(client).memory;
        if self.memories[memory].private {
            self.serve_before(memory, Cycle::UNKNOWN);
        }
    }

    /// Serves every request that no request still to come can precede, and tells whether there was any.
    ///
    /// To be called when no step can start before an answer is known. Then the earliest step still to come waits,
    /// through whatever chain, for a request that is queued here: it starts no earlier than the earliest arrival plus
    /// the least latency of any memory, and so do its own requests. All that arrive before that are served now.
    pub(crate) fn serve_safe(&mut self) -> bool {
        let Some(earliest) = self.ports.iter().filter_map(Port::next_arrival).min() else { return false };
        let least = self.memories.iter().map(Memory::least_latency).min().unwrap_or(1);
        for memory in 0..self.memories.len() {
            self.serve_before(memory, earliest + least);
        }
        true
    }

    /// Serves what arrived at `memory` before `horizon`, in order of (arrival, port number, issue).
    fn serve_before(&mut self, memory: usize, horizon: Cycle) {
        loop {
            let ports = self.service_order.iter().filter(|&&p| self.ports[p].memory == memory);
            // `min_by_key` returns the first of equals, and the order of ports is their number.
            let next = ports.filter_map(|&p| Some((self.ports[p].next_arrival()?, p))).min_by_key(|&(arrival, _)| arrival);
            match next {
                Some((arrival, port)) if arrival < horizon => self.memories[memory].serve(&mut self.ports[port]),
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
