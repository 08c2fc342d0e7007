//! Counters that hold a value until the next one, and the channels and banks of all memories, numbered consecutively.

use crate::layout::TimelineLayout;

/// Cycles over which rates are taken.
pub const RATE_CYCLES: u64 = 256;

/// Value of a counter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CounterValue {
    /// Number of items.
    Count(u64),
    /// Measured value.
    Real(f64),
}

/// A channel of a memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelCounters {
    /// `memory graphics`, with the number of the channel behind if there are several.
    pub name: String,
    /// Number of the memory.
    pub memory: usize,
    /// Banks of all channels before it.
    pub first_bank: usize,
    /// True if it is shown.
    pub is_shown: bool,
}

/// A level.
#[derive(Clone, Debug, PartialEq)]
pub struct CounterInfo {
    /// Owner: name of the FIFO or channel, `client NAME` or `cache NAME`.
    pub of: String,
    /// Name of the counter.
    pub what: &'static str,
    /// Unit of measure.
    pub unit: &'static str,
    /// Value in cycle 0.
    pub start: CounterValue,
    /// The most that it can hold, where it is a count.
    pub most: u64,
    /// True if it is shown.
    pub is_shown: bool,
}

impl CounterInfo {
    fn new(of: String, what: &'static str, unit: &'static str, is_shown: bool) -> Self {
        Self { of, what, unit, start: CounterValue::Count(0), most: u32::MAX.into(), is_shown }
    }

    fn rate(of: String, what: &'static str, unit: &'static str, is_shown: bool) -> Self {
        Self { start: CounterValue::Real(0.0), ..Self::new(of, what, unit, is_shown) }
    }
}

/// All levels of a machine: one per FIFO, in order; three per channel, one per client, one more per client, for its cache, and one more
/// per FIFO, for its visible tokens.
#[derive(Clone, Debug)]
pub struct CounterList {
    /// The channels of all memories, in order.
    pub channels: Vec<ChannelCounters>,
    /// Banks of all channels.
    pub banks: usize,
    /// The levels.
    pub all: Vec<CounterInfo>,
    /// Number of the first channel of each memory.
    first_channels: Vec<usize>,
    /// Numbers of the first level of a channel and of a client.
    of_channels: usize,
    of_clients: usize,
    clients: usize,
}

impl CounterList {
    /// Creates the counters of a layout.
    pub fn new(board: &TimelineLayout) -> Self {
        let diagram = &board.diagram;
        let (mut channels, mut first_channels, mut banks) = (vec![], vec![], 0);
        for (number, memory) in diagram.memories.iter().enumerate() {
            first_channels.push(channels.len());
            for channel in 0..memory.channels {
                let suffix = if memory.channels > 1 { format!(" {channel}") } else { String::new() };
                let (name, is_shown) = (format!("memory {}{suffix}", memory.name), board.shows_memory(number));
                channels.push(ChannelCounters { name, memory: number, first_bank: banks, is_shown });
                banks += memory.banks;
            }
        }
        let fifo = |(number, fifo): (usize, &basrelief_kernel::FifoTopology)| CounterInfo {
            most: fifo.depth as u64,
            ..CounterInfo::new(fifo.name.clone(), "fill", "slots", board.shows_fifo(number))
        };
        let mut all: Vec<CounterInfo> = diagram.fifos.iter().enumerate().map(fifo).collect();
        let of_channels = all.len();
        for ChannelCounters { name, is_shown, .. } in &channels {
            all.push(CounterInfo::new(name.clone(), "queue", "bursts", *is_shown));
            all.push(CounterInfo::rate(name.clone(), "bytes per cycle", "bytes/cycle", *is_shown));
            all.push(CounterInfo::rate(name.clone(), "bus use", "%", *is_shown));
        }
        let of_clients = all.len();
        for (number, client) in diagram.clients.iter().enumerate() {
            let credits = CounterInfo::new(format!("client {}", client.name), "credits", "credits", board.shows_client(number));
            all.push(CounterInfo { start: CounterValue::Count(client.credits), most: client.credits, ..credits });
        }
        for (number, client) in diagram.clients.iter().enumerate() {
            let (name, is_shown) =
                (client.cache.clone().unwrap_or_default(), client.cache.is_some() && board.shows_client(number));
            all.push(CounterInfo::rate(format!("cache {name}"), "hit rate", "%", is_shown));
        }
        for (number, fifo) in diagram.fifos.iter().enumerate() {
            let valid = CounterInfo::new(fifo.name.clone(), "valid", "", board.shows_fifo(number));
            all.push(CounterInfo { most: 1, ..valid });
        }
        Self { channels, banks, all, first_channels, of_channels, of_clients, clients: diagram.clients.len() }
    }

    /// Number of a channel.
    pub fn channel(&self, memory: usize, channel: usize) -> usize {
        self.first_channels[memory] + channel
    }

    /// Number of the level of a channel's queue; the bytes per cycle and the use of its bus follow.
    pub fn queue(&self, channel: usize) -> usize {
        self.of_channels + 3 * channel
    }

    /// Number of the level of a client's credits.
    pub fn credits(&self, client: usize) -> usize {
        self.of_clients + client
    }

    /// Number of the level of the hit rate of a client's cache.
    pub fn hit_rate(&self, client: usize) -> usize {
        self.of_clients + self.clients + client
    }

    /// Number of the level of a FIFO that is 1 while a token is visible. Only waves show it.
    pub fn valid(&self, fifo: usize) -> usize {
        self.of_clients + 2 * self.clients + fifo
    }
}
