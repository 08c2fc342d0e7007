//! The critical path of a run: the chain of waits and work from its end back to its beginning.

/// A phase of a memory request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RequestPhase {
    /// The request travels to the memory's view.
    Arrival,
    /// It waits in the queue: for other bursts, or for the bus.
    Bus,
    /// It waits for its row to open.
    Bank,
    /// From its column command to the end of its data.
    Data,
    /// It waits for a previous answer, or for the credit that comes with that answer.
    Order,
    /// The data pass the cache.
    Cache,
    /// A flip waits for its time, or a wait for the end of a hold (law 4).
    Periodic,
}

impl RequestPhase {
    /// All phases, in order.
    pub(crate) const ALL: [Self; 7] =
        [Self::Arrival, Self::Bus, Self::Bank, Self::Data, Self::Order, Self::Cache, Self::Periodic];
}

/// The resource that a segment of the path uses, by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathSegment {
    /// A step occupies a unit.
    Occupancy(String),
    /// From the start of a unit's step to its delivery.
    Latency(String),
    /// A token passes a FIFO: its latency, and one token per cycle.
    Fifo(String),
    /// A slot of a FIFO becomes free.
    Slot(String),
    /// A request of a memory client.
    Memory(String, RequestPhase),
    /// The rest, in flight at the end.
    Rest,
}

/// All segments of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPart {
    /// The resource of the segments.
    pub stretch: PathSegment,
    /// Sum of their cycles.
    pub cycles: u64,
    /// These cycles from mark to mark; one entry with all cycles if the run has no marks.
    pub by_mark: Vec<u64>,
}

/// A chain of waits and work, without gap or overlap, from the first cycle to the last mark, or to the end of a run without
/// marks. The critical path is not unique: another may be equally long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CriticalPath {
    /// Length: the sum of all parts.
    pub cycles: u64,
    /// Parts, longest first.
    pub parts: Vec<PathPart>,
    /// The same cycles by group number, if steps have [`StageGroups`]. A segment belongs to the step with which it begins.
    pub by_group: Vec<(u32, u64)>,
}

/// Groups of the steps of one stage, as the caller numbers them: runs of steps of the same group, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StageGroups(Vec<(u32, u32)>);

impl StageGroups {
    /// The group of steps that belong to no group.
    pub const NONE: u32 = u32::MAX;

    /// Appends a step of this group. Returns true if it begins a new run.
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

    /// Iterates over the groups of all steps.
    pub(crate) fn into_steps(self) -> impl Iterator<Item = u32> {
        self.0.into_iter().flat_map(|(steps, group)| std::iter::repeat_n(group, steps as usize))
    }
}
