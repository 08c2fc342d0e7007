//! The critical path of a run: what it waited for, from its end back to its beginning.

/// A phase of a memory request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Phase {
    /// On its way to the memory's view.
    Arrival,
    /// In the queue: for others ahead of it, or for the bus.
    Bus,
    /// For its row to be opened.
    Bank,
    /// From its column command to the end of its data.
    Data,
    /// For an answer ahead of it, or the credit that comes with it.
    Order,
    /// Through the cache.
    Cache,
}

/// What a stretch of the path is spent on, by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stretch {
    /// A unit is kept by its steps.
    Occupancy(String),
    /// From the start of a unit's step to its delivery.
    Latency(String),
    /// A token passes a FIFO: its latency, and one token per cycle.
    Fifo(String),
    /// A slot of a FIFO becomes free.
    Slot(String),
    /// A request of a memory client.
    Memory(String, Phase),
    /// What is left in flight at the end.
    Rest,
}

/// All stretches of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPart {
    /// What they are spent on.
    pub stretch: Stretch,
    /// Their cycles.
    pub cycles: u64,
    /// Of these, the cycles up to each mark from the one before; where there is none, all of them.
    pub by_mark: Vec<u64>,
}

/// A chain of waits and work, without gap or overlap, from the first cycle to the last mark; where nothing passes one,
/// to the end of the run. Paths are not unique: another may be as long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CriticalPath {
    /// Its length: the sum of all parts.
    pub cycles: u64,
    /// Longest first.
    pub parts: Vec<PathPart>,
}
