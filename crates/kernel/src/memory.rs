//! Memories (law 4): requests of several ports, in order, become bursts of several channels.

use crate::channel::{Burst, Channel};
use crate::client::Client;
use crate::counts::{BusActivity, ChannelCounts, RowOutcome};
use crate::diagram::MemoryTopology;
use crate::divisor::Divisor;
use crate::memory_events::MemoryEvent;
use crate::port::{ArrivedRequest, Completion, Port};
use crate::{Cycle, MemoryConfig};

/// A request, as the memory took it in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryRequest {
    /// When it arrived.
    pub arrival: Cycle,
    /// Number of the client.
    pub client: usize,
    /// Posted write rather than read.
    pub write: bool,
    /// Byte address.
    pub address: u64,
    /// Bytes, >= 1.
    pub bytes: u32,
}

impl MemoryRequest {
    /// Addresses of the aligned bursts of `burst_bytes` (>= 1) into which it is split, ascending.
    pub fn bursts(&self, burst_bytes: u32) -> impl Iterator<Item = u64> + use<> {
        let burst = Divisor::new(burst_bytes);
        let (first, last) = burst.touched(self.address, self.bytes);
        (first..=last).map(move |number| number * burst.by)
    }
}

/// Notes how a burst was served.
#[cold]
fn note_burst(
    channel: &mut Channel,
    port: &mut Port,
    (burst, row): (Burst, RowOutcome),
    column: Cycle,
    (data, end): (Cycle, Cycle),
) {
    if let Some(watch) = &mut channel.watch {
        watch.serve(burst, column, (data, end));
    }
    let row = Cycle(column.0.saturating_sub(channel.row_cycles(row)));
    port.note(burst.request, Completion { arrival: burst.arrival, row, column, end, answer: Cycle::UNKNOWN });
}

/// One memory.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(crate) name: String,
    /// Its ports, in order of number.
    pub(crate) ports: Vec<usize>,
    /// Requests that are not split into bursts yet.
    pub(crate) arrived: u64,
    pub(crate) burst_bytes: u32,
    /// Bursts that are not served yet.
    bursts: u64,
    burst: Divisor,
    interleave: Divisor,
    channels_by: Divisor,
    row: Divisor,
    banks_by: Divisor,
    channels: Vec<Channel>,
    burst_cycles: u64,
    pub(crate) bus: BusActivity,
    /// What arrived since it was last taken, in order; none where nobody asked for it.
    pub(crate) log: Option<Vec<MemoryRequest>>,
    /// Whether anything is to be noted of what arrives: it is logged, or watched.
    pub(crate) notes_arrivals: bool,
    /// Whether anything is to be noted of what is served: it is watched, or answers are kept.
    pub(crate) notes_bursts: bool,
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
            burst_bytes: config.burst_bytes,
            bursts: 0,
            burst: Divisor::new(config.burst_bytes),
            interleave: Divisor::new(config.channel_bytes),
            channels_by: Divisor::new(config.channels),
            row: Divisor::new(config.row_bytes),
            banks_by: Divisor::new(config.banks),
            channels: vec![Channel::new(config); config.channels.max(1) as usize],
            burst_cycles: config.burst_cycles.into(),
            bus: BusActivity::default(),
            log: None,
            notes_arrivals: false,
            notes_bursts: false,
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

    /// The channel of an address, and the address there.
    #[inline]
    fn place(&self, address: u64) -> (usize, u64) {
        if self.channels.len() == 1 {
            return (0, address);
        }
        let (piece, offset) = self.interleave.split(address);
        let (inner, channel) = self.channels_by.split(piece);
        (channel as usize, inner * self.interleave.by + offset)
    }

    /// Splits what arrived before `horizon`, in order; the numbers of this memory's ports are those of their clients.
    fn split_before(&mut self, clients: &mut [Client], horizon: Cycle) {
        if let [client] = self.ports[..] {
            return self.split_from(client, &mut clients[client].port, horizon);
        }
        while self.arrived > 0 {
            let Some((client, until)) = self.next_port(clients, horizon) else { return };
            self.split_from(client, &mut clients[client].port, until);
        }
    }

    /// The port whose request is the next in order of (arrival, port number, issue), and until when its requests go ahead of those
    /// of the others; none where the next arrived at `horizon` or later.
    fn next_port(&self, clients: &[Client], horizon: Cycle) -> Option<(usize, Cycle)> {
        let mut next = None;
        let mut until = horizon;
        for &client in &self.ports {
            let Some(arrival) = clients[client].port.next_arrival() else { continue };
            match next {
                // Ports stand in order of number: of equals the one before goes first.
                Some((_, first)) if first <= arrival => until = until.min(arrival + 1),
                Some((_, first)) => (next, until) = (Some((client, arrival)), until.min(first)),
                None => next = Some((client, arrival)),
            }
        }
        next.filter(|(_, arrival)| *arrival < horizon).map(|(client, _)| (client, until))
    }

    /// Splits the requests of a port that arrived before `until` into bursts in their channels.
    #[inline]
    fn split_from(&mut self, client: usize, port: &mut Port, until: Cycle) {
        while let Some((request, r, (first, last))) = port.split(until, self.burst) {
            self.arrived -= 1;
            if self.notes_arrivals {
                self.note_arrival(client, port, &r, (first, last));
            }
            self.bursts += last - first + 1;
            // Not a range: mostly it is one burst, and a range asks twice whether it is over.
            let mut number = first;
            loop {
                self.push(number, client, request, &r);
                if number == last {
                    break;
                }
                number += 1;
            }
        }
    }

    /// Keeps every request from now on, until it is taken.
    pub(crate) fn keep_requests(&mut self) {
        (self.log, self.notes_arrivals) = (Some(Vec::new()), true);
    }

    /// Keeps what it does from now on, until it is told.
    pub(crate) fn keep_events(&mut self) {
        (self.notes_arrivals, self.notes_bursts) = (true, true);
        self.channels.iter_mut().for_each(Channel::keep_events);
    }

    /// Tells what it did since the last call, or up to the `end` of a run; it is memory `number`.
    pub(crate) fn emit(&mut self, number: usize, end: Option<Cycle>, emit: &mut impl FnMut(MemoryEvent)) {
        for (channel, place) in self.channels.iter_mut().zip(0..) {
            channel.emit([number, place], end, &mut *emit);
        }
    }

    /// Notes a request that is split into these bursts.
    #[cold]
    fn note_arrival(&mut self, client: usize, port: &mut Port, r: &ArrivedRequest, (first, last): (u64, u64)) {
        if let Some(log) = &mut self.log {
            log.push(MemoryRequest { arrival: r.arrival, client, write: r.write, address: r.address, bytes: r.bytes });
        }
        if let Some(in_flight) = port.notes.as_mut().and_then(|notes| notes.in_flight.as_mut()) {
            in_flight.up(r.arrival);
        }
        for number in first..=last {
            let (channel, _) = self.place(number * self.burst.by);
            if let Some(watch) = &mut self.channels[channel].watch {
                watch.queue.up(r.arrival);
            }
        }
    }

    /// Hands a burst of a request to its channel.
    #[inline(always)]
    fn push(&mut self, number: u64, client: usize, request: u64, r: &ArrivedRequest) {
        let (channel, address) = self.place(number * self.burst.by);
        let (row_number, _) = self.row.split(address);
        let (row, bank) = self.banks_by.split(row_number);
        let (bank, client) = (bank as u32, client as u32);
        self.channels[channel].push(Burst { bank, row, write: r.write, arrival: r.arrival, client, request });
    }

    /// Serves whatever is final when all that is still to come arrives at `horizon` or later; whether there was any.
    pub(crate) fn serve(&mut self, clients: &mut [Client], horizon: Cycle) -> bool {
        if self.arrived > 0 {
            self.split_before(clients, horizon);
        }
        let waiting = self.bursts;
        for channel in &mut self.channels {
            while let Some((burst, row, column, end)) = channel.serve(horizon) {
                self.bursts -= 1;
                self.data_end = self.data_end.max(end);
                let data = Cycle(end.0 - self.burst_cycles);
                self.bus.moved(data, end);
                let port = &mut clients[burst.client as usize].port;
                port.counts.rows.count(row);
                port.counts.queue_wait += column.since(burst.arrival) - 1;
                if self.notes_bursts {
                    note_burst(channel, port, (burst, row), column, (data, end));
                }
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

    /// What it is, for who looks on.
    pub(crate) fn topology(&self) -> MemoryTopology {
        MemoryTopology {
            name: self.name.clone(),
            channels: self.channels.len(),
            banks: self.channels.first().map_or(0, Channel::banks),
            burst_bytes: self.burst_bytes,
            burst_cycles: self.burst_cycles,
        }
    }

    /// What each channel moved in a run of `total` cycles.
    pub(crate) fn channel_counts(&self, total: u64) -> Vec<ChannelCounts> {
        self.channels.iter().map(|channel| channel.counts(total)).collect()
    }
}
