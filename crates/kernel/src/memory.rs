//! Memories (law 4): requests of several ports, in order, become bursts of several channels.

use crate::burst::Burst;
use crate::channel::{Channel, ServedBurst};
use crate::client::Client;
use crate::counts::{BusActivity, ChannelCounts, RowOutcome};
use crate::diagram::MemoryTopology;
use crate::divisor::Divisor;
use crate::memory_events::{EventBounds, MemoryEvent};
use crate::periodic::{LateData, PeriodicClient};
use crate::port::{ArrivedRequest, Completion, Port};
use crate::{Cycle, MemoryConfig};

/// A request as it arrived at the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryRequest {
    /// Cycle of arrival.
    pub arrival: Cycle,
    /// Number of the client.
    pub client: usize,
    /// True for a posted write, false for a read.
    pub write: bool,
    /// Byte address.
    pub address: u64,
    /// Bytes, >= 1.
    pub bytes: u32,
}

impl MemoryRequest {
    /// Returns the addresses of the aligned bursts of `burst_bytes` (>= 1) of this request, in ascending order.
    pub fn bursts(&self, burst_bytes: u32) -> impl Iterator<Item = u64> + use<> {
        let burst = Divisor::new(burst_bytes);
        let (first, last) = burst.touched(self.address, self.bytes);
        (first..=last).map(move |number| number * burst.by)
    }
}

mod among_periodic;

/// Records how a burst was served. Its data begin in cycle `data`.
#[cold]
fn note_burst(channel: &mut Channel, port: &mut Port, burst: Burst, row: RowOutcome, column: Cycle, data: Cycle, end: Cycle) {
    if let Some(watch) = &mut channel.watch {
        watch.serve(burst, column, data, end);
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
    /// Its periodic clients, in order of number.
    pub(crate) periodic: Vec<PeriodicClient>,
    /// Number of unserved bursts of periodic clients.
    periodic_bursts: u64,
    /// Data of periodic clients that may move after the end of the run.
    late_data: Vec<LateData>,
    /// The cycle after the last request that controls a periodic client.
    last_control: Cycle,
    /// Number of requests of units that are not split into bursts yet.
    pub(crate) arrived: u64,
    pub(crate) burst_bytes: u32,
    /// Issue rate of its ports \[requests/cycle\]; 0 for all at once.
    pub(crate) issue: u32,
    /// Number of unserved bursts of units.
    bursts: u64,
    burst: Divisor,
    interleave: Divisor,
    channels_by: Divisor,
    /// Bursts in `channel_bytes`; `None` if there are several channels and it is no whole number.
    piece: Option<Divisor>,
    row: Divisor,
    banks_by: Divisor,
    channels: Vec<Channel>,
    burst_cycles: u64,
    pub(crate) bus: BusActivity,
    /// Requests since they were last taken, in order; `None` if no caller asked for them.
    pub(crate) log: Option<Vec<MemoryRequest>>,
    /// True if arrivals are recorded, for a log or a probe.
    pub(crate) notes_arrivals: bool,
    /// True if served bursts are recorded, for a probe or the critical path.
    pub(crate) notes_bursts: bool,
    /// True if bursts of periodic clients are recorded too, for a probe.
    notes_periodic: bool,
    /// Least latency from a column command to the end of its data.
    least_latency: u64,
    /// End of the last data: the memory moved data up to the cycle before.
    pub(crate) data_end: Cycle,
    /// True if a single stage uses it, so no order between stages is needed.
    pub(crate) private: bool,
}

impl Memory {
    pub(crate) fn new(name: &str, config: &MemoryConfig) -> Self {
        Self {
            name: name.into(),
            ports: Vec::new(),
            periodic: Vec::new(),
            periodic_bursts: 0,
            late_data: Vec::new(),
            last_control: Cycle::ZERO,
            arrived: 0,
            burst_bytes: config.burst_bytes,
            issue: config.issue,
            bursts: 0,
            burst: Divisor::new(config.burst_bytes),
            interleave: Divisor::new(config.channel_bytes),
            channels_by: Divisor::new(config.channels),
            piece: (config.channels <= 1 || config.channel_bytes.is_multiple_of(config.burst_bytes))
                .then(|| Divisor::new(config.channel_bytes / config.burst_bytes.max(1))),
            row: Divisor::new(config.row_bytes),
            banks_by: Divisor::new(config.banks),
            channels: vec![Channel::new(config); config.channels.max(1) as usize],
            burst_cycles: config.burst_cycles.into(),
            bus: BusActivity::default(),
            log: None,
            notes_arrivals: false,
            notes_bursts: false,
            notes_periodic: false,
            least_latency: u64::from(config.burst_cycles) + u64::from(config.cl.min(config.cwl)),
            data_end: Cycle::ZERO,
            private: false,
        }
    }

    /// Returns true if no request and no burst of a unit waits.
    #[inline]
    pub(crate) fn is_idle(&self) -> bool {
        self.arrived + self.bursts == 0
    }

    /// Returns the channel of an address, and the address within that channel.
    #[inline]
    fn place(&self, address: u64) -> (usize, u64) {
        if self.channels.len() == 1 {
            return (0, address);
        }
        let (piece, offset) = self.interleave.split(address);
        let (inner, channel) = self.channels_by.split(piece);
        (channel as usize, inner * self.interleave.by + offset)
    }

    /// Splits the requests that arrived before `horizon`, in order. Ports of this memory have the numbers of their clients.
    fn split_before(&mut self, clients: &mut [Client], horizon: Cycle) {
        if let [client] = self.ports[..] {
            return self.split_from(client, &mut clients[client].port, horizon);
        }
        while self.arrived > 0 {
            let Some((client, until)) = self.next_port(clients, horizon) else { return };
            self.split_from(client, &mut clients[client].port, until);
        }
    }

    /// Returns the port of the next request in order of (arrival, port number, issue), and the cycle until which its requests
    /// precede the others. Returns `None` if the next request arrived at `horizon` or later.
    fn next_port(&self, clients: &[Client], horizon: Cycle) -> Option<(usize, Cycle)> {
        let (client, arrival, until) = self.first_ports(clients)?;
        (arrival < horizon).then_some((client, until.min(horizon)))
    }

    /// Returns the port of the next request in order, its arrival, and the cycle until which its requests precede the others.
    #[inline]
    fn first_ports(&self, clients: &[Client]) -> Option<(usize, Cycle, Cycle)> {
        let mut next = None;
        let mut until = Cycle::UNKNOWN;
        for &client in &self.ports {
            let Some(arrival) = clients[client].port.next_arrival() else { continue };
            match next {
                // Ports are in order of number: the earlier port wins a tie.
                Some((_, first)) if first <= arrival => until = until.min(arrival + 1),
                Some((_, first)) => (next, until) = (Some((client, arrival)), until.min(first)),
                None => next = Some((client, arrival)),
            }
        }
        next.map(|(client, arrival)| (client, arrival, until))
    }

    /// Splits the requests of a port that arrived before `until` into bursts of their channels.
    #[inline]
    fn split_from(&mut self, client: usize, port: &mut Port, until: Cycle) {
        while let Some((request, r, (first, last))) = port.split(until, self.burst) {
            self.arrived -= 1;
            if self.notes_arrivals {
                self.note_arrival(client, port, &r, first, last);
            }
            self.bursts += last - first + 1;
            // Not a range: usually there is one burst, and a range checks its end twice.
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

    /// Records every request from now on, until it is taken.
    pub(crate) fn keep_requests(&mut self) {
        (self.log, self.notes_arrivals) = (Some(Vec::new()), true);
    }

    /// Records events from now on.
    pub(crate) fn keep_events(&mut self) {
        (self.notes_arrivals, self.notes_bursts, self.notes_periodic) = (true, true, true);
        self.channels.iter_mut().for_each(Channel::keep_events);
    }

    /// Emits the events since the last call, or up to the end of a run. This is memory `number`.
    pub(crate) fn emit(&mut self, number: usize, bounds: EventBounds, emit: &mut impl FnMut(MemoryEvent)) {
        for (channel, place) in self.channels.iter_mut().zip(0..) {
            channel.emit([number, place], self.data_end, bounds, &mut *emit);
        }
    }

    /// Records a request that is split into the bursts `first` to `last`.
    #[cold]
    fn note_arrival(&mut self, client: usize, port: &mut Port, r: &ArrivedRequest, first: u64, last: u64) {
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

    /// Appends a burst of a request to its channel.
    #[inline(always)]
    fn push(&mut self, number: u64, client: usize, request: u64, r: &ArrivedRequest) {
        let (channel, address) = self.place(number * self.burst.by);
        let burst = self.burst_in(address, client, request, r);
        self.channels[channel].push(burst);
    }

    /// Returns a burst of a request at an address within its channel.
    #[inline(always)]
    fn burst_in(&self, address: u64, client: usize, request: u64, r: &ArrivedRequest) -> Burst {
        let (row_number, _) = self.row.split(address);
        let (row, bank) = self.banks_by.split(row_number);
        Burst { bank: bank as u32, row, write: r.write, arrival: r.arrival, client: client as u32, request }
    }

    /// Returns burst `number` of a request.
    fn burst_at(&self, number: u64, client: usize, request: u64, r: &ArrivedRequest) -> Burst {
        self.burst_in(self.place(number * self.burst.by).1, client, request, r)
    }

    /// Serves every choice that is final, given that all later requests arrive at `horizon` or later. Returns true if there was
    /// any.
    pub(crate) fn serve(&mut self, clients: &mut [Client], horizon: Cycle) -> bool {
        if !self.periodic.is_empty() {
            return self.serve_among_periodic(clients, horizon);
        }
        if self.arrived > 0 {
            self.split_before(clients, horizon);
        }
        let waiting = self.bursts;
        for channel in 0..self.channels.len() {
            while let Some(served) = self.channels[channel].serve(horizon) {
                self.moved(channel, clients, served, Cycle::ZERO);
            }
        }
        self.bursts < waiting
    }

    /// Accounts for a burst that a channel has served. `known_end`: a lower bound of the end of the memory.
    #[inline(always)]
    fn moved(&mut self, channel: usize, clients: &mut [Client], served: ServedBurst, known_end: Cycle) {
        let ServedBurst { burst, row, column, end } = served;
        let Client { port, is_periodic, .. } = &mut clients[burst.client as usize];
        let data = Cycle(end.0 - self.burst_cycles);
        if *is_periodic {
            self.periodic_bursts -= 1;
            self.channels[channel].periodic -= 1;
            self.count_data(LateData { channel, from: data, to: end }, self.data_end.max(known_end));
        } else {
            self.bursts -= 1;
            self.data_end = self.data_end.max(end);
            self.bus.count_transfer(data, end);
        }
        port.counts.rows.count(row);
        port.counts.queue_wait += column.since(burst.arrival) - 1;
        if self.notes_bursts {
            note_burst(&mut self.channels[channel], port, burst, row, column, data, end);
        }
        port.moved(burst.request, 1, end);
    }

    /// Returns a lower bound of all answers to come; `None` if nothing waits.
    pub(crate) fn earliest_answer(&mut self, clients: &[Client]) -> Option<Cycle> {
        let arrival = self.ports.iter().filter_map(|&p| clients[p].port.next_arrival()).min();
        let channels = self.channels.iter_mut().filter(|channel| channel.has_units());
        let columns = channels.filter_map(Channel::next_column);
        let first = columns.chain(arrival.map(|arrival| arrival + 1)).min()?;
        Some(first + self.least_latency)
    }

    /// Describes the memory for probes.
    pub(crate) fn topology(&self) -> MemoryTopology {
        MemoryTopology {
            name: self.name.clone(),
            channels: self.channels.len(),
            banks: self.channels.first().map_or(0, Channel::banks),
            burst_bytes: self.burst_bytes,
            burst_cycles: self.burst_cycles,
        }
    }

    /// Returns the counts of each channel in a run of `total` cycles.
    pub(crate) fn channel_counts(&self, total: u64) -> Vec<ChannelCounts> {
        self.channels.iter().map(|channel| channel.counts(total)).collect()
    }
}
