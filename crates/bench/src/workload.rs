//! What is measured, whatever measures it: criterion, the ratios, or the count of instructions.

use std::time::{Duration, Instant};

/// What a workload's throughput is counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// A token in a stage.
    TokenStages,
    /// A fragment, or a dot of the shading device.
    Fragments,
    /// A byte; of the JSON Lines with the same content, in whatever form a trace is.
    Bytes,
    /// A triangle of a model.
    Triangles,
    /// A pixel of the picture.
    Pixels,
    /// A step of a unit.
    Steps,
}

/// One measured run.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Time of the measured part.
    pub time: Duration,
    /// How much was done in it.
    pub count: u64,
}

/// A workload made ready: each call is a run from fresh state, of which only what matters is measured.
pub type Ready = Box<dyn FnMut() -> Sample>;

/// Something to measure.
pub struct Workload {
    /// Group and name, such as `machine/w1/timed`.
    pub name: String,
    /// What is counted.
    pub counted: Counted,
    prepare: Box<dyn Fn() -> Ready>,
}

impl Workload {
    /// A workload that `prepare` makes ready.
    pub fn new<R: FnMut() -> Sample + 'static>(
        name: impl Into<String>,
        counted: Counted,
        prepare: impl Fn() -> R + 'static,
    ) -> Self {
        Self { name: name.into(), counted, prepare: Box::new(move || Box::new(prepare())) }
    }

    /// Makes it ready.
    pub fn prepare(&self) -> Ready {
        (self.prepare)()
    }
}

/// How large the workloads are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// For measuring time.
    Full,
    /// For counting instructions: the same work, less of it.
    Small,
}

impl Size {
    /// One of two values.
    pub fn of<T>(self, full: T, small: T) -> T {
        match self {
            Self::Full => full,
            Self::Small => small,
        }
    }
}

/// Runs `work` and times it. All that is measured runs in here and nothing else does: callgrind counts the instructions of
/// this function, by its name.
#[inline(never)]
pub fn measured<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let began = Instant::now();
    let value = work();
    (value, began.elapsed())
}
