//! Result and errors of a run.

use crate::analysis::costs::RunCosts;
use basrelief_input::OverBudget;
use basrelief_kernel::RunReport;
use basrelief_machines::ConfigProblem;
use basrelief_report::Report;
use basrelief_trace::{ExpectedResults, TraceError};

/// Error that prevents a report.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Error in the trace.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// Parameters that do not fit together.
    #[error(transparent)]
    Config(#[from] ConfigProblem),
    /// The memory limit is exceeded.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// Fault in a unit.
    #[error("{0}")]
    Fault(String),
    /// Error of the observer.
    #[error("{0}")]
    Observer(String),
    /// The machine has no short cuts for an ablation.
    #[error("machine `{0}` has no short cuts to disable; use --machine {1}")]
    NoShortcuts(&'static str, String),
    /// The machine has no methods to compare.
    #[error("machine `{0}` has no methods to compare; use --machine {1}")]
    NoMethods(&'static str, String),
    /// The user acts at given times, but the functional model has no time.
    #[error(
        "the user acts at given times, but a functional run has no time; run with an engine, or set `defer.left_at_tile` instead of times"
    )]
    NoTimes,
    /// A run in a table of runs did not finish, so that its cycles cannot be compared.
    #[error("{0}")]
    Incomplete(String),
}

/// Result of a run.
#[derive(Debug)]
pub struct RunResult {
    /// The report, without host figures.
    pub report: Report,
    /// Report of the engine; `None` for the functional model.
    pub timing: Option<RunReport>,
    /// Costs, if selected by [`RunOptions::costs`](crate::RunOptions::costs).
    pub costs: Option<RunCosts>,
    /// Cycles of the critical path by group of steps.
    pub(crate) path_groups: Vec<(u32, u64)>,
    /// True if the observer received a complete recording.
    pub recording_is_complete: bool,
    /// Expectations in the trace.
    pub expectations: Vec<ExpectedResults>,
    /// Time of simulation on the host, without reading, exact drawing, metrics and writing \[s\].
    pub simulate_s: f64,
}

impl RunResult {
    /// Returns the report with the host figures. `wall_s` is the total time \[s\].
    pub fn with_host(self, wall_s: f64) -> Report {
        self.report.with_host(wall_s, self.simulate_s)
    }
}
