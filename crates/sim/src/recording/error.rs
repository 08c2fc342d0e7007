//! Errors of recordings.

use basrelief_input::OverBudget;
use basrelief_kernel::ResimulateError;
use std::io;

/// Error in a recording, or in the parameters that it is resimulated with.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The recording cannot be read.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// The file is not a recording, or is damaged or incomplete.
    #[error("not a recording, or damaged: {0}; make one with `basrelief run --recording FILE`")]
    Format(String),
    /// The recorded steps do not belong to this machine.
    #[error(transparent)]
    Retime(ResimulateError),
    /// The work of the recorded run depends on its timing.
    #[error("the user of this run acts at times, so its work depends on its timing; run the machine again instead")]
    ActsAtTimes,
    /// A parameter that changes the work of the units.
    #[error("`{0}` changes the work of the units, which a recording fixes; run the machine with this parameter instead")]
    Work(String),
    /// Parameters that change the work of the units only in combination.
    #[error("under these parameters the machine does other work than was recorded: {0}; run the machine with them instead")]
    OtherWork(String),
    /// Parameters that are unknown, out of range, or that do not fit together.
    #[error("{0}")]
    Config(String),
    /// An error in one of several recordings.
    #[error("{error}")]
    OneOf {
        /// Number of the recording, from 0.
        number: usize,
        /// The error.
        error: Box<Self>,
    },
    /// Recordings of different machines or parameters.
    #[error("{difference}; all inputs must have the same machine and parameters")]
    Different {
        /// Number of the recording that differs from the first one, from 0.
        number: usize,
        /// The first difference.
        difference: String,
    },
    /// The run does not finish, so that its pictures and counts would be different.
    #[error("under these parameters the run does not finish: {0}")]
    Incomplete(String),
    /// Another build of the simulator made the recording, and this build cannot use it.
    #[error("build {build} of basrelief made the recording, and this build cannot use it: {reason}; run the machine again")]
    OtherBuild {
        /// Build that made the recording.
        build: String,
        /// Reason.
        reason: String,
    },
    /// The recording and the report next to it belong to different runs.
    #[error("the recording and the report next to it belong to different runs")]
    OtherRun,
    /// The memory limit is exceeded.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

impl From<ResimulateError> for RecordingError {
    fn from(error: ResimulateError) -> Self {
        match error {
            ResimulateError::Recording(damage) => Self::Format(damage.to_string()),
            other => Self::Retime(other),
        }
    }
}
