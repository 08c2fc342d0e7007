//! All memories, ports and caches of a machine, and the order in which requests are served.

use crate::cache::{Cache, CacheTagArray};
use crate::client::Client;
use crate::memory::{Memory, MemoryRequest};
use crate::memory_events::{EventBounds, Gauge};
use crate::periodic::{FlipTiming, PeriodicClient, PeriodicControl, PeriodicReads};
use crate::port::{Completion, Port};
use crate::{CacheConfig, Cycle, MemoryConfig, MemoryEvent, Probe, Request};
pub(crate) use look_ups::LookUpQueue;

/// The memories of a machine.
///
/// Ports are numbered within their memory in the order in which their clients are added, so the order of the wiring cannot matter
/// (law 4).
#[derive(Clone, Debug, Default)]
pub struct MemorySystem {
    memories: Vec<Memory>,
    clients: Vec<Client>,
}

impl MemorySystem {
    /// Adds a memory and returns its number.
    pub fn add_memory(&mut self, name: &str, config: &MemoryConfig) -> usize {
        self.memories.push(Memory::new(name, config));
        self.memories.len() - 1
    }

    /// Adds a client with its own port on `memory`, of the memory's [issue rate](MemoryConfig::issue), and returns the client's
    /// number.
    pub fn add_client(&mut self, name: &str, memory: usize, outstanding: u32) -> usize {
        let number = self.clients.len();
        self.memories[memory].ports.push(number);
        let mut port = Port::new(name, memory, outstanding);
        port.set_issue_rate(self.memories[memory].issue);
        self.clients.push(Client { port, cache: None, is_periodic: false, control: None });
        number
    }

    /// Adds a periodic client and returns its number. It belongs to no unit, holds no credits, and comes after all other ports of
    /// the memory in order (law 4). It keeps no run alive and does not count towards the total (law 8).
    ///
    /// # Panics
    /// If the period is 0.
    pub fn add_periodic_client(&mut self, name: &str, memory: usize, reads: PeriodicReads) -> usize {
        assert!(reads.period >= 1, "client {name}: period 0, expected at least 1 (law 4)");
        let client = self.clients.len();
        let mut port = Port::new(name, memory, 0);
        port.deadline = reads.period;
        self.memories[memory].periodic.push(PeriodicClient::new(client, reads));
        self.clients.push(Client { port, cache: None, is_periodic: true, control: None });
        client
    }

    /// Adds a client on the memory of the periodic client `periodic`, and returns its number. Its requests are *flips*: they move no
    /// data, and their address becomes the base of the periodic client (law 4).
    ///
    /// # Panics
    /// If `periodic` is not a periodic client, or the period of the flips is 0.
    pub fn add_flip_client(&mut self, name: &str, periodic: usize, timing: FlipTiming, outstanding: u32) -> usize {
        assert!(timing.period >= 1, "client {name}: period 0, expected at least 1 (law 4)");
        let (memory, place) = self.place_of_periodic(name, periodic);
        if timing.hold > 0 {
            self.memories[memory].periodic[place].blank();
        }
        let client = self.add_client(name, memory, outstanding);
        self.clients[client].control = Some((place, PeriodicControl::Flip(timing)));
        client
    }

    /// Adds a client on the memory of the periodic client `periodic`, and returns its number. Its requests move no data and change
    /// nothing. Each is answered when the hold of the last flip is over (law 4).
    ///
    /// # Panics
    /// If `periodic` is not a periodic client.
    pub fn add_wait_client(&mut self, name: &str, periodic: usize, outstanding: u32) -> usize {
        let (memory, place) = self.place_of_periodic(name, periodic);
        let client = self.add_client(name, memory, outstanding);
        self.clients[client].control = Some((place, PeriodicControl::Wait));
        client
    }

    /// Returns the memory of a periodic client, and its place there.
    fn place_of_periodic(&self, name: &str, periodic: usize) -> (usize, usize) {
        let memory = self.clients[periodic].port.memory;
        let place = self.memories[memory].periodic.iter().position(|p| p.client == periodic);
        (memory, place.unwrap_or_else(|| panic!("client {name} controls client {periodic}, which is not periodic")))
    }

    /// Adds a client whose reads go through its own cache and returns the client's number.
    pub fn add_cached_client(
        &mut self,
        name: &str,
        memory: usize,
        outstanding: u32,
        cache_name: &str,
        cache: &CacheConfig,
    ) -> usize {
        let client = self.add_client(name, memory, outstanding);
        self.clients[client].cache = Some(Cache::new(cache_name, cache));
        client
    }

    /// Replaces the issue rate of a client's port: its requests of one step arrive at so many per cycle; 0 for all at once (law 4).
    pub fn set_issue_rate(&mut self, client: usize, per_cycle: u32) {
        self.clients[client].port.set_issue_rate(per_cycle);
    }

    /// Makes the look-ups of one step arrive at [`CacheConfig::lookups_per_cycle`] per cycle instead of all at once (law 5). Has no
    /// effect on a client without a cache.
    pub fn spread_look_ups(&mut self, client: usize) {
        let Client { port, cache, .. } = &mut self.clients[client];
        if let Some(cache) = cache {
            cache.tags.spreads = true;
            port.is_paced = true;
        }
    }

    /// True if the requests of a client move no data: flips of a periodic client, and waits for it.
    pub(crate) fn controls_periodic(&self, client: usize) -> bool {
        self.clients[client].control.is_some()
    }

    /// Name of a client's port.
    pub fn client_name(&self, client: usize) -> &str {
        &self.port(client).name
    }

    /// Maximum number of requests in flight of a client.
    pub fn outstanding(&self, client: usize) -> u64 {
        self.port(client).outstanding()
    }

    /// Name of the memory behind a client.
    pub fn memory_name(&self, client: usize) -> &str {
        &self.memories[self.port(client).memory].name
    }

    /// Names of all clients, by number.
    pub fn client_names(&self) -> impl Iterator<Item = &str> {
        self.clients.iter().map(|client| client.port.name.as_str())
    }

    /// Names of all memories, by number, each with its burst size in bytes.
    pub fn names_and_bursts(&self) -> impl Iterator<Item = (&str, u32)> {
        self.memories.iter().map(|memory| (memory.name.as_str(), memory.burst_bytes))
    }

    /// Name of the cache in front of a client's port, if it has one.
    pub fn cache_name(&self, client: usize) -> Option<&str> {
        self.clients[client].cache.as_ref().map(|c| c.name.as_str())
    }

    /// Records every request from now on, until it is [taken](Self::take_requests).
    pub fn keep_requests(&mut self) {
        self.memories.iter_mut().for_each(Memory::keep_requests);
    }

    /// Takes the recorded requests, by memory with its name. Each list is in order of (arrival, port number, issue), as in law 4.
    /// Call it between rounds of an engine, so that the record does not grow with the run.
    pub fn take_requests(&mut self) -> impl Iterator<Item = (&str, Vec<MemoryRequest>)> {
        let taken = |memory: &mut Memory| memory.log.as_mut().map(std::mem::take).unwrap_or_default();
        self.memories.iter_mut().map(move |memory| {
            let requests = taken(memory);
            (memory.name.as_str(), requests)
        })
    }

    pub(crate) fn memories(&self) -> &[Memory] {
        &self.memories
    }

    pub(crate) fn clients(&self) -> &[Client] {
        &self.clients
    }

    #[inline]
    fn port(&self, client: usize) -> &Port {
        &self.clients[client].port
    }

    /// Line size of each client's cache in bytes, if it has one.
    pub(crate) fn line_bytes(&self) -> impl Iterator<Item = Option<u32>> {
        self.clients.iter().map(|client| client.cache.as_ref().map(|cache| cache.config.line_bytes))
    }

    /// Memory and port of a client: the order in which the answers of a step are listed.
    pub(crate) fn service_rank(&self, client: usize) -> (usize, usize) {
        (self.port(client).memory, client)
    }

    /// Marks the memories that a single stage uses. `stages` lists the clients of each stage.
    pub(crate) fn find_private<'a>(&mut self, stages: impl Iterator<Item = &'a [usize]> + Clone) {
        for m in 0..self.memories.len() {
            let users = stages.clone().filter(|ids| ids.iter().any(|&c| self.port(c).memory == m)).count();
            self.memories[m].private = users <= 1;
        }
    }

    /// Returns true if one of these clients has a memory that a single stage uses.
    pub(crate) fn has_private(&self, clients: &[usize]) -> bool {
        clients.iter().any(|&client| self.memories[self.port(client).memory].private)
    }

    /// Returns true if there are memories, so that promises are useful.
    pub(crate) fn has_any(&self) -> bool {
        !self.memories.is_empty()
    }

    /// Promises that no later request of this client arrives before `start`.
    #[inline]
    pub(crate) fn promise(&mut self, client: usize, start: Cycle) {
        self.clients[client].port.none_before = start;
    }

    /// Treats all memories as shared, for the ticked engine, which serves them all alike.
    pub(crate) fn share_all(&mut self) {
        self.memories.iter_mut().for_each(|m| m.private = false);
    }

    #[inline(always)]
    pub(crate) fn credits_at(&self, client: usize, credits: u32) -> Cycle {
        self.port(client).credits_at(credits)
    }

    /// Returns the answer time of request `number` of a client.
    #[inline]
    pub(crate) fn answer(&self, client: usize, number: u64) -> Cycle {
        self.port(client).answer(number)
    }

    /// Records the completion of every request of a unit, in the memory of earlier records.
    pub(crate) fn keep_answers(&mut self, memory: Vec<Vec<Completion>>) {
        self.memories.iter_mut().for_each(|memory| memory.notes_bursts = true);
        let units = self.clients.iter_mut().filter(|client| !client.is_periodic);
        for (client, mut memory) in units.zip(memory.into_iter().chain(std::iter::repeat_with(Vec::new))) {
            memory.clear();
            client.port.notes.get_or_insert_default().answered = Some(memory);
        }
    }

    /// Takes the records of completions, by client.
    pub(crate) fn take_answers(&mut self) -> Vec<Vec<Completion>> {
        self.clients.iter_mut().filter_map(|client| client.port.notes.as_mut()?.answered.take()).collect()
    }

    /// Records events of all memories, ports and caches from now on.
    pub(crate) fn keep_events(&mut self) {
        self.memories.iter_mut().for_each(Memory::keep_events);
        for Client { port, cache, .. } in &mut self.clients {
            port.notes.get_or_insert_default().in_flight = Some(Gauge::default());
            cache.iter_mut().for_each(|cache| cache.watch = Some(Box::default()));
        }
    }

    /// Emits the events since the last call to a probe, as far as they are settled, or up to the end of a run.
    pub(crate) fn emit(&mut self, probe: &mut impl Probe, bounds: EventBounds) {
        let mut emit = |event| probe.on_memory_event(event);
        for (number, memory) in self.memories.iter_mut().enumerate() {
            memory.emit(number, bounds, &mut emit);
        }
        for (client, Client { port, cache, .. }) in self.clients.iter_mut().enumerate() {
            if let Some(in_flight) = port.notes.as_mut().and_then(|notes| notes.in_flight.as_mut()) {
                in_flight.emit(bounds, |at, requests| emit(MemoryEvent::InFlight { client, at, requests }));
            }
            if let Some(watch) = cache.as_mut().and_then(|cache| cache.watch.as_mut()) {
                watch.emit(client, bounds.end.is_some(), &mut emit);
            }
        }
    }

    /// Number of requests that a client has issued.
    pub(crate) fn issued(&self, client: usize) -> u64 {
        self.port(client).issued
    }

    /// See [`Port::credit_of`].
    pub(crate) fn credit_of(&self, client: usize, issued: u64, credits: u32) -> u64 {
        self.port(client).credit_of(issued, credits)
    }

    /// Returns the first request of a client with the latest answer by `at`.
    pub(crate) fn last_answered(&self, client: usize, at: Cycle) -> Option<Completion> {
        let answered = self.port(client).notes.as_ref()?.answered.as_deref()?;
        let behind = answered.partition_point(|request| request.answer <= at);
        let answer = answered.get(behind.checked_sub(1)?)?.answer;
        answered.get(answered[..behind].partition_point(|request| request.answer < answer)).copied()
    }

    /// Returns the request of a client whose data a unit got at `at`, through its cache if it has one.
    pub(crate) fn last_received(&self, client: usize, at: Cycle) -> Option<Completion> {
        self.last_answered(client, Cycle(at.since(Cycle(self.hit_latency(client)))))
    }

    /// Returns true if a client got an answer at `at`, through its cache if it has one.
    pub(crate) fn is_answer(&self, client: usize, at: Cycle) -> bool {
        self.last_answered(client, at).is_some_and(|request| request.answer + self.hit_latency(client) >= at)
    }

    /// Cycles that data need to pass the cache of a client; 0 without a cache.
    fn hit_latency(&self, client: usize) -> u64 {
        self.clients[client].cache.as_ref().map_or(0, |cache| cache.config.hit_latency.into())
    }

    /// Number of served requests of a client: all earlier answers are known.
    #[inline]
    pub(crate) fn served(&self, client: usize) -> u64 {
        self.port(client).served
    }

    /// Number of served requests of these clients.
    #[inline(always)]
    pub(crate) fn served_of(&self, clients: &[usize]) -> u64 {
        clients.iter().map(|&client| self.served(client)).sum()
    }

    /// Keeps the answers of a client from request `number` on, for steps in flight.
    #[inline]
    pub(crate) fn keep_from(&mut self, client: usize, number: u64) {
        self.clients[client].port.keep_from = number;
    }

    /// Issues a direct request of a step that starts at `start`. Returns its number and its arrival.
    #[inline]
    pub(crate) fn issue(&mut self, client: usize, start: Cycle, request: &Request) -> (u64, Cycle) {
        let port = &mut self.clients[client].port;
        self.memories[port.memory].arrived += 1;
        let arrival = if port.is_paced { port.next_issue(start) } else { start };
        (port.issue(arrival, request.address, request.bytes, request.write), arrival)
    }

    /// Returns a lower bound of all later answers of a client's memory.
    pub(crate) fn earliest_answer(&mut self, client: usize) -> Cycle {
        let Self { memories, clients } = self;
        memories[clients[client].port.memory].earliest_answer(clients).unwrap_or_default()
    }

    /// Returns the tags of a client's cache and the number of its next request; `None` if it has no cache.
    #[inline(always)]
    pub(crate) fn tags(&mut self, client: usize) -> Option<(&mut CacheTagArray, u64)> {
        let Client { port, cache, .. } = &mut self.clients[client];
        Some((&mut cache.as_mut()?.tags, port.issued))
    }

    /// Serves final choices of a client's memory, if no other stage uses it and this stage makes no step before `horizon`.
    /// Returns true if there was any.
    #[inline]
    pub(crate) fn serve_if_private(&mut self, client: usize, horizon: Cycle) -> bool {
        let memory = &mut self.memories[self.clients[client].port.memory];
        memory.private && !memory.is_idle() && memory.serve(&mut self.clients, horizon)
    }

    /// Serves choices that are final by the stages' promises. Returns true if there was any.
    pub(crate) fn serve_promised(&mut self) -> bool {
        let Self { memories, clients } = self;
        memories.iter_mut().fold(false, |any, memory| serve_promised(memory, clients) | any)
    }

    /// As [`MemorySystem::serve_promised`], for the memory of one client.
    pub(crate) fn serve_promised_of(&mut self, client: usize) -> bool {
        let Self { memories, clients } = self;
        serve_promised(&mut memories[clients[client].port.memory], clients)
    }

    /// Serves final choices without further promises. Returns true if anything waits.
    ///
    /// Call it when no step can start before an answer is known. Then the earliest later step waits, through some chain, for a
    /// request that waits here. It starts no earlier than the earliest answer that any memory can still give, and neither do its
    /// own requests.
    pub(crate) fn serve_safe(&mut self) -> bool {
        let answers = self.memories.iter_mut().filter(|m| !m.is_idle()).filter_map(|m| m.earliest_answer(&self.clients));
        let Some(horizon) = answers.min() else { return false };
        self.serve_before(horizon);
        true
    }

    /// Serves the choices that are final, given that all later requests arrive at `horizon` or later.
    pub(crate) fn serve_before(&mut self, horizon: Cycle) {
        for memory in self.memories.iter_mut().filter(|memory| !memory.is_idle()) {
            memory.serve(&mut self.clients, horizon);
        }
    }

    /// Returns true if no request of a unit waits to be served.
    pub(crate) fn is_idle(&self) -> bool {
        self.memories.iter().all(Memory::is_idle)
    }

    /// Takes in what periodic clients do before the end of a run of `total` cycles.
    pub(crate) fn finish_periodic(&mut self, total: Cycle) {
        let Self { memories, clients } = self;
        memories.iter_mut().for_each(|memory| memory.finish_periodic(clients, total));
    }

    /// The last cycle of any data movement or credit return for a unit, plus one.
    pub(crate) fn data_end(&self) -> Cycle {
        self.memories.iter().map(|m| m.data_end).max().unwrap_or(Cycle::ZERO)
    }

    /// The last answer on any port of a unit.
    pub(crate) fn last_answer(&self) -> Cycle {
        self.clients.iter().filter(|c| !c.is_periodic).map(|c| c.port.last_answer()).max().unwrap_or(Cycle::ZERO)
    }
}

/// Serves choices of a memory that are final by the promises of its users. Returns true if there was any.
fn serve_promised(memory: &mut Memory, clients: &mut [Client]) -> bool {
    if memory.is_idle() {
        return false;
    }
    let none_before = memory.ports.iter().map(|&p| clients[p].port.none_before).min();
    memory.serve(clients, none_before.unwrap_or_default())
}

mod look_ups;
