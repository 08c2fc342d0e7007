//! Workloads, independent of the measuring method: criterion, ratios, or instruction counts.

use std::time::{Duration, Instant};

/// Unit of a workload's throughput.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThroughputUnit {
    /// A token in a stage.
    TokenStages,
    /// A fragment, or a dot of the shading device.
    Fragments,
    /// A byte of the JSON Lines with the same content, whatever the form of the trace.
    Bytes,
    /// A triangle of a model.
    Triangles,
    /// A pixel of the picture.
    Pixels,
    /// A step of a unit.
    Steps,
}

/// Result of one measured run.
#[derive(Clone, Copy, Debug)]
pub struct RunSample {
    /// Time of the measured part.
    pub time: Duration,
    /// Amount of work in that time.
    pub count: u64,
}

impl RunSample {
    /// Returns the time per unit of work \[ns\].
    pub fn nanoseconds(self) -> f64 {
        self.time.as_secs_f64() * 1e9 / self.count as f64
    }
}

/// A prepared workload: each call is a run from fresh state, of which only the relevant part is measured.
pub type PreparedRun = Box<dyn FnMut() -> RunSample>;

/// A workload.
pub struct Workload {
    /// Group and name, for example `machine/w1/timed`.
    pub name: String,
    /// Unit of its throughput.
    pub counted: ThroughputUnit,
    prepare: Box<dyn Fn() -> PreparedRun>,
}

impl Workload {
    /// Creates a workload from its `prepare` function.
    pub fn new<R: FnMut() -> RunSample + 'static>(
        name: impl Into<String>,
        counted: ThroughputUnit,
        prepare: impl Fn() -> R + 'static,
    ) -> Self {
        Self { name: name.into(), counted, prepare: Box::new(move || Box::new(prepare())) }
    }

    /// Prepares the workload.
    pub fn prepare(&self) -> PreparedRun {
        (self.prepare)()
    }
}

/// Size of the workloads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkloadSize {
    /// For time measurements.
    Full,
    /// For instruction counts: the same work, but less of it.
    Small,
}

impl WorkloadSize {
    /// Selects one of two values.
    pub fn of<T>(self, full: T, small: T) -> T {
        match self {
            Self::Full => full,
            Self::Small => small,
        }
    }
}

/// Runs `work` and times it. Only measured work runs in here, because callgrind counts the instructions of this function by its
/// name.
#[inline(never)]
pub fn measured<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let began = Instant::now();
    let value = work();
    (value, began.elapsed())
}
