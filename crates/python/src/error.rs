//! Errors as Python exceptions, with the messages of the command line.

use basrelief_input::Budget;
use basrelief_sim::{RecordingError, RunError};
use pyo3::exceptions::PyException;
use pyo3::{PyErr, create_exception};
use std::fmt::{self, Display, Formatter};

create_exception!(basrelief, Error, PyException, "Base class of all errors.");
create_exception!(basrelief, UsageError, Error, "Wrong arguments; exit code 2 of the command line.");
create_exception!(basrelief, InputError, Error, "Bad input; exit code 1 of the command line.");

/// An error before it becomes a Python exception.
#[derive(Debug)]
pub enum Failure {
    /// Becomes a `UsageError`.
    Usage(String),
    /// Becomes an `InputError`.
    Bad(String),
}

/// Result with such an error.
pub type Done<T> = Result<T, Failure>;

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Usage(text) => UsageError::new_err(text),
            Failure::Bad(text) => InputError::new_err(text),
        }
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (Self::Usage(text) | Self::Bad(text)) = self;
        f.write_str(text)
    }
}

/// Makes a usage error.
pub fn usage(error: impl Display) -> Failure {
    Failure::Usage(error.to_string())
}

/// Makes an input error.
pub fn bad(error: impl Display) -> Failure {
    Failure::Bad(error.to_string())
}

/// Converts an error in the input of this name.
pub fn within<E: Display>(name: &str) -> impl Fn(E) -> Failure {
    move |error| bad(format_args!("{name}: {error}"))
}

/// Converts an error of a run with the input of this name.
pub fn of_run(name: &str) -> impl Fn(RunError) -> Failure {
    move |error| match error {
        RunError::Trace(_) | RunError::OverBudget(_) | RunError::Fault(_) => within(name)(error),
        RunError::NoTimes => usage(error),
        _ => bad(error),
    }
}

/// Converts an error of a recording or of the new parameters.
pub fn of_tape(error: RecordingError) -> Failure {
    match error {
        RecordingError::Work(_) | RecordingError::OtherWork(_) | RecordingError::Config(_) => usage(error),
        // The decoder reports damage in its own words.
        RecordingError::Read(_) => not_a_tape(),
        _ => bad(error),
    }
}

/// Makes the error of an invalid recording.
pub fn not_a_tape() -> Failure {
    bad("not a recording, or truncated; Result.recording is one")
}

/// Makes a memory limit for input data.
pub fn budget(limit: u64) -> Budget {
    Budget::with_advice(limit, "give more with memory_limit, if this input is to be trusted")
}
