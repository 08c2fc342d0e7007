//! Memories (law 4): banks of open rows, one data bus, ports served in order of arrival.

use crate::{Cycle, MemoryConfig};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// What a port moved and how it was served.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct PortCounts {
    /// Read requests.
    pub reads: u64,
    /// Write requests.
    pub writes: u64,
    /// Bytes asked for by reads.
    pub read_bytes: u64,
    /// Bytes given by writes.
    pub write_bytes: u64,
    /// Bursts moved; a request that is not aligned moves more bytes than it asks for.
    pub bursts: u64,
    /// Bursts that found their row open.
    pub row_hits: u64,
    /// Bursts that found their bank closed.
    pub row_closed: u64,
    /// Bursts that found another row open.
    pub row_conflicts: u64,
    /// Cycles that requests waited for the command bus or their bank, beyond the one cycle each needs.
    pub wait_cycles: u64,
}

/// A request that has arrived and is not served yet.
#[derive(Clone, Copy, Debug)]
struct Queued {
    arrival: Cycle,
    address: u64,
    bytes: u32,
    write: bool,
}

/// One port of a memory.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    pub(crate) name: String,
    pub(crate) memory: usize,
    outstanding: u64,
    /// Answer times of the last requests, by number of issue; never decreasing.
    answers: Box<[Cycle]>,
    pub(crate) issued: u64,
    pub(crate) served: u64,
    /// The oldest request whose answer a step in flight may still ask for.
    pub(crate) keep_from: u64,
    /// No request to come arrives before, as far as its stage has promised.
    pub(crate) none_before: Cycle,
    last_answer: Cycle,
    queue: VecDeque<Queued>,
    pub(crate) counts: PortCounts,
}

impl Port {
    pub(crate) fn new(name: &str, memory: usize, outstanding: u32) -> Self {
        let ring = (outstanding as usize).max(1).next_power_of_two();
        Self {
            name: name.into(),
            memory,
            outstanding: u64::from(outstanding),
            answers: vec![Cycle::ZERO; ring].into(),
            issued: 0,
            served: 0,
            keep_from: u64::MAX,
            none_before: Cycle::ZERO,
            last_answer: Cycle::ZERO,
            queue: VecDeque::new(),
            counts: PortCounts::default(),
        }
    }

    /// Credits in all.
    pub(crate) fn outstanding(&self) -> u64 {
        self.outstanding
    }

    /// The first cycle with at least `credits` free credits; unknown while that depends on an answer not known yet.
    #[inline(always)]
    pub(crate) fn credits_at(&self, credits: u32) -> Cycle {
        match (self.issued + u64::from(credits)).checked_sub(self.outstanding) {
            None | Some(0) => Cycle::ZERO,
            Some(returns) => self.answer(returns - 1),
        }
    }

    /// Answer time of request `number`; unknown until it is served. A request that left the ring was answered before
    /// the start of any step that may still ask (it needed that credit), so its time is as good as 0.
    #[inline(always)]
    pub(crate) fn answer(&self, number: u64) -> Cycle {
        if number >= self.served {
            Cycle::UNKNOWN
        } else if number + (self.answers.len() as u64) < self.issued {
            Cycle::ZERO
        } else {
            self.answers[number as usize & (self.answers.len() - 1)]
        }
    }

    #[inline]
    pub(crate) fn issue(&mut self, arrival: Cycle, address: u64, bytes: u32, write: bool) -> u64 {
        if self.issued.saturating_sub(self.keep_from) >= self.answers.len() as u64 {
            self.grow();
        }
        self.queue.push_back(Queued { arrival, address, bytes: bytes.max(1), write });
        self.issued += 1;
        self.issued - 1
    }

    /// Doubles the ring. A step that waits for one client may hold back others that have long been answered by
    /// another, and a merged look-up may refer to a request older than the credits in use: so the credits alone do not
    /// bound what may be asked for.
    #[cold]
    fn grow(&mut self) {
        let mut ring = vec![Cycle::ZERO; 2 * self.answers.len()];
        for number in self.issued.saturating_sub(self.answers.len() as u64)..self.served {
            let slot = number as usize & (ring.len() - 1);
            ring[slot] = self.answers[number as usize & (self.answers.len() - 1)];
        }
        self.answers = ring.into();
    }

    #[inline]
    pub(crate) fn next_arrival(&self) -> Option<Cycle> {
        self.queue.front().map(|q| q.arrival)
    }

    pub(crate) fn last_answer(&self) -> Cycle {
        self.last_answer
    }
}

/// One bank: its open row and when it is free.
#[derive(Clone, Copy, Debug, Default)]
struct Bank {
    free: Cycle,
    row: Option<u64>,
}

/// Splits a number by a divisor fixed at construction: a shift where the divisor is a power of two, as it nearly
/// always is (a division costs ten times as much).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Divisor {
    by: u64,
    shift: Option<u32>,
}

impl Divisor {
    pub(crate) fn new(by: u32) -> Self {
        let by = u64::from(by.max(1));
        Self { by, shift: by.is_power_of_two().then(|| by.trailing_zeros()) }
    }

    #[inline(always)]
    pub(crate) fn split(self, n: u64) -> (u64, u64) {
        match self.shift {
            Some(s) => (n >> s, n & (self.by - 1)),
            None => (n / self.by, n % self.by),
        }
    }
}

/// One memory.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(crate) name: String,
    config: MemoryConfig,
    /// Its ports, in order of number.
    pub(crate) ports: Vec<usize>,
    /// Requests that have arrived and are not served yet.
    pub(crate) queued: u64,
    burst: Divisor,
    row: Divisor,
    banks_by: Divisor,
    banks: Vec<Bank>,
    command: Option<Cycle>,
    bus: Cycle,
    /// End of the last burst: the memory moved data up to the cycle before.
    pub(crate) data_end: Cycle,
    /// Whether a single stage uses it, so that nothing need be ordered against others.
    pub(crate) private: bool,
}

impl Memory {
    pub(crate) fn new(name: &str, config: &MemoryConfig) -> Self {
        Self {
            name: name.into(),
            ports: Vec::new(),
            queued: 0,
            burst: Divisor::new(config.burst_bytes),
            row: Divisor::new(config.row_bytes),
            banks_by: Divisor::new(config.banks),
            banks: vec![Bank::default(); config.banks.max(1) as usize],
            config: config.clone(),
            command: None,
            bus: Cycle::ZERO,
            data_end: Cycle::ZERO,
            private: false,
        }
    }

    /// No answer to come, of requests that arrive at `earliest` or later, is there before: a command takes its cycle, the
    /// column its access, and the bus must be free for the burst.
    pub(crate) fn earliest_answer(&self, earliest: Cycle) -> Cycle {
        (earliest + 1 + u64::from(self.config.cas)).max(self.bus) + u64::from(self.config.burst_cycles)
    }

    /// Serves the oldest request of `port`.
    pub(crate) fn serve(&mut self, port: &mut Port) {
        let Some(q) = port.queue.pop_front() else { return };
        self.queued -= 1;
        let (first, _) = self.burst.split(q.address);
        let (last, _) = self.burst.split(q.address + u64::from(q.bytes) - 1);
        let mut end = Cycle::ZERO;
        for burst in first..=last {
            let (command, burst_end) = self.burst(q.arrival, burst, &mut port.counts);
            if burst == first {
                port.counts.wait_cycles += command.since(q.arrival + 1);
            }
            end = burst_end;
        }
        port.counts.bursts += last - first + 1;
        let (requests, bytes) = if q.write {
            (&mut port.counts.writes, &mut port.counts.write_bytes)
        } else {
            (&mut port.counts.reads, &mut port.counts.read_bytes)
        };
        *requests += 1;
        *bytes += u64::from(q.bytes);
        self.data_end = self.data_end.max(end);
        port.last_answer = port.last_answer.max(end);
        let slot = port.served as usize & (port.answers.len() - 1);
        port.answers[slot] = port.last_answer;
        port.served += 1;
    }

    /// Moves one burst: its command cycle and its end.
    #[inline]
    fn burst(&mut self, arrival: Cycle, burst: u64, counts: &mut PortCounts) -> (Cycle, Cycle) {
        let (row_number, _) = self.row.split(burst * self.burst.by);
        let (row, bank) = self.banks_by.split(row_number);
        let bank = &mut self.banks[bank as usize];
        let c = &self.config;
        let (count, wait) = match bank.row {
            Some(open) if open == row => (&mut counts.row_hits, c.cas),
            None => (&mut counts.row_closed, c.rcd + c.cas),
            Some(_) => (&mut counts.row_conflicts, c.rp + c.rcd + c.cas),
        };
        *count += 1;
        let after_last = self.command.map_or(Cycle::ZERO, |last| last + 1);
        let command = (arrival + 1).max(after_last).max(bank.free);
        let end = (command + u64::from(wait)).max(self.bus) + u64::from(c.burst_cycles);
        self.command = Some(command);
        self.bus = end;
        *bank = Bank { free: end, row: Some(row) };
        (command, end)
    }
}
