//! What a run comes to.

use crate::costs::Costs;
use basrelief_input::OverBudget;
use basrelief_kernel::RunReport;
use basrelief_machines::ConfigProblem;
use basrelief_report::Report;
use basrelief_trace::{Expectation, TraceError};

/// What can keep a run from giving a report.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// Parameters that do not fit together.
    #[error(transparent)]
    Config(#[from] ConfigProblem),
    /// More than may be held, of a scene or of what a run remembers.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// A unit could not go on.
    #[error("{0}")]
    Fault(String),
    /// The observer could not take a frame.
    #[error("{0}")]
    Observer(String),
    /// Nothing to switch off in an ablation.
    #[error("machine `{0}` has no short cuts that could be switched off")]
    NoShortCuts(&'static str),
    /// No methods to compare.
    #[error("machine `{0}` has no methods to compare; --machine {1} has")]
    NoMethods(&'static str, String),
    /// A user who acts at times, of a run that has none.
    #[error(
        "the user acts at times, and a functional run has none: run with time, or set `defer.left_at_tile` in place of times"
    )]
    NoTimes,
    /// A run of a table of runs whose cycles mean nothing.
    #[error("{0}")]
    Incomplete(String),
}

/// What a run came to.
#[derive(Debug)]
pub struct Run {
    /// The report, without host figures.
    pub report: Report,
    /// What the engine came to; `None` for the functional model.
    pub timing: Option<RunReport>,
    /// What it has cost, for whom, where [`RunOptions::costs`](crate::RunOptions::costs) asks for it.
    pub costs: Option<Costs>,
    /// Cycles of the critical path by group of steps.
    pub(crate) path_groups: Vec<(u32, u64)>,
    /// Whether the observer was shown a whole tape: the run was recorded to its end.
    pub tape_is_whole: bool,
    /// What a trace expects of its replay.
    pub expectations: Vec<Expectation>,
    /// From the first to the last simulated step, without reading, exact drawing, metrics and writing \[s\].
    pub simulate_s: f64,
}

impl Run {
    /// The report with the host's figures: `wall_s` is the time of everything \[s\].
    pub fn with_host(self, wall_s: f64) -> Report {
        self.report.with_host(wall_s, self.simulate_s)
    }
}
