//! The critical path of a run: what it waited for, from its end back to its beginning.

/// A phase of a memory request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RequestPhase {
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
pub enum PathSegment {
    /// A unit is kept by its steps.
    Occupancy(String),
    /// From the start of a unit's step to its delivery.
    Latency(String),
    /// A token passes a FIFO: its latency, and one token per cycle.
    Fifo(String),
    /// A slot of a FIFO becomes free.
    Slot(String),
    /// A request of a memory client.
    Memory(String, RequestPhase),
    /// What is left in flight at the end.
    Rest,
}

/// All stretches of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPart {
    /// What they are spent on.
    pub stretch: PathSegment,
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
    /// The same cycles by group, each with its number, where steps have [`StageGroups`]: each stretch is of the step that it begins with.
    pub by_group: Vec<(u32, u64)>,
}

/// What the steps of one stage are for, as the caller numbers it: runs of steps of one group, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StageGroups(Vec<(u32, u32)>);

impl StageGroups {
    /// What no step is for.
    pub const NONE: u32 = u32::MAX;

    /// The next step is of this group; whether that begins one more run.
    pub fn push(&mut self, group: u32) -> bool {
        match self.0.last_mut() {
            Some((steps, of)) if *of == group && *steps < u32::MAX => {
                *steps += 1;
                false
            }
            _ => {
                self.0.push((1, group));
                true
            }
        }
    }

    /// The groups of all steps, one after the other.
    pub(crate) fn into_steps(self) -> impl Iterator<Item = u32> {
        self.0.into_iter().flat_map(|(steps, group)| std::iter::repeat_n(group, steps as usize))
    }
}
