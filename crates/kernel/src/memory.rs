//! Memories (law 4): ports that requests arrive at, and channels that serve their bursts.

use crate::channel::{Burst, Channel};
use crate::counts::{Bus, ChannelCounts, PortCounts};
use crate::memory_system::Client;
use crate::{Cycle, MemoryConfig};
use std::collections::VecDeque;

/// A request that has arrived and is not split into bursts yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrived {
    pub(crate) arrival: Cycle,
    pub(crate) address: u64,
    pub(crate) bytes: u32,
    pub(crate) write: bool,
}

/// A request some of whose bursts are not served yet, or one ahead of it on its port.
#[derive(Clone, Copy, Debug)]
struct Open {
    arrival: Cycle,
    /// Bursts not served.
    left: u64,
    /// The end of those that are.
    end: Cycle,
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
    queue: VecDeque<Arrived>,
    /// From request `served` on.
    open: VecDeque<Open>,
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
            open: VecDeque::new(),
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
        self.queue.push_back(Arrived { arrival, address, bytes: bytes.max(1), write });
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

    /// Takes in that a burst of request `number` has moved its data by `end`; an answer is there when all its bursts have,
    /// not before the answer ahead of it.
    #[inline]
    fn moved(&mut self, number: u64, end: Cycle) {
        let request = &mut self.open[(number - self.served) as usize];
        request.left -= 1;
        request.end = request.end.max(end);
        while let Some(first) = self.open.front().filter(|first| first.left == 0) {
            self.last_answer = self.last_answer.max(first.end);
            self.counts.answered(first.arrival, self.last_answer);
            self.open.pop_front();
            let slot = self.served as usize & (self.answers.len() - 1);
            self.answers[slot] = self.last_answer;
            self.served += 1;
        }
    }
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
    /// Its ports, in order of number.
    pub(crate) ports: Vec<usize>,
    /// Requests that are not split into bursts yet.
    pub(crate) arrived: u64,
    /// Bursts that are not served yet.
    bursts: u64,
    burst: Divisor,
    interleave: Divisor,
    channels_by: Divisor,
    row: Divisor,
    banks_by: Divisor,
    channels: Vec<Channel>,
    burst_cycles: u64,
    pub(crate) bus: Bus,
    /// From a column command to the end of its data, at least.
    least_latency: u64,
    /// The end of the last data: the memory moved some up to the cycle before.
    pub(crate) data_end: Cycle,
    /// Whether a single stage uses it, so that nothing need be ordered against others.
    pub(crate) private: bool,
}

impl Memory {
    pub(crate) fn new(name: &str, config: &MemoryConfig) -> Self {
        Self {
            name: name.into(),
            ports: Vec::new(),
            arrived: 0,
            bursts: 0,
            burst: Divisor::new(config.burst_bytes),
            interleave: Divisor::new(config.channel_bytes),
            channels_by: Divisor::new(config.channels),
            row: Divisor::new(config.row_bytes),
            banks_by: Divisor::new(config.banks),
            channels: vec![Channel::new(config); config.channels.max(1) as usize],
            burst_cycles: config.burst_cycles.into(),
            bus: Bus::default(),
            least_latency: u64::from(config.burst_cycles) + u64::from(config.cl.min(config.cwl)),
            data_end: Cycle::ZERO,
            private: false,
        }
    }

    /// Whether anything waits here.
    #[inline]
    pub(crate) fn is_idle(&self) -> bool {
        self.arrived + self.bursts == 0
    }

    /// Splits a request, the next in order of (arrival, port number, issue), into bursts in their channels.
    #[inline]
    fn split(&mut self, client: usize, port: &mut Port) {
        let Some(r) = port.queue.pop_front() else { return };
        self.arrived -= 1;
        port.counts.arrived(r.write, r.bytes);
        let (first, _) = self.burst.split(r.address);
        let (last, _) = self.burst.split(r.address + u64::from(r.bytes) - 1);
        let request = port.served + port.open.len() as u64;
        port.open.push_back(Open { arrival: r.arrival, left: last - first + 1, end: Cycle::ZERO });
        self.bursts += last - first + 1;
        for number in first..=last {
            let (piece, offset) = self.interleave.split(number * self.burst.by);
            let (inner, channel) = self.channels_by.split(piece);
            let (row_number, _) = self.row.split(inner * self.interleave.by + offset);
            let (row, bank) = self.banks_by.split(row_number);
            let (bank, client) = (bank as u32, client as u32);
            let burst = Burst { bank, row, write: r.write, arrival: r.arrival, client, request };
            self.channels[channel as usize].push(burst);
        }
    }

    /// Splits what arrived before `horizon`, in order; the numbers of this memory's ports are those of their clients.
    fn split_before(&mut self, clients: &mut [Client], horizon: Cycle) {
        while self.arrived > 0 {
            let waiting = self.ports.iter().filter_map(|&p| Some((clients[p].port.next_arrival()?, p)));
            // `min_by_key` returns the first of equals, and ports stand in order of number.
            match waiting.min_by_key(|&(arrival, _)| arrival) {
                Some((arrival, client)) if arrival < horizon => self.split(client, &mut clients[client].port),
                _ => break,
            }
        }
    }

    /// Serves whatever is final when all that is still to come arrives at `horizon` or later; whether there was any.
    pub(crate) fn serve(&mut self, clients: &mut [Client], horizon: Cycle) -> bool {
        self.split_before(clients, horizon);
        let waiting = self.bursts;
        for channel in &mut self.channels {
            while let Some((burst, row, column, end)) = channel.serve(horizon) {
                self.bursts -= 1;
                self.data_end = self.data_end.max(end);
                self.bus.moved(Cycle(end.0 - self.burst_cycles), end);
                let port = &mut clients[burst.client as usize].port;
                port.counts.rows.count(row);
                port.counts.queue_wait += column.since(burst.arrival + 1);
                port.moved(burst.request, end);
            }
        }
        self.bursts < waiting
    }

    /// No answer to come is there before; none where nothing waits.
    pub(crate) fn earliest_answer(&mut self, clients: &[Client]) -> Option<Cycle> {
        let arrival = self.ports.iter().filter_map(|&p| clients[p].port.next_arrival()).min();
        let columns = self.channels.iter_mut().filter_map(Channel::next_column);
        let first = columns.chain(arrival.map(|arrival| arrival + 1)).min()?;
        Some(first + self.least_latency)
    }

    /// What each channel moved in a run of `total` cycles.
    pub(crate) fn channel_counts(&self, total: u64) -> Vec<ChannelCounts> {
        let of = |channel: &Channel| ChannelCounts { refreshes: channel.refreshes(total), ..channel.counts };
        self.channels.iter().map(of).collect()
    }
}
