//! What goes wrong, as Python's exceptions, with the words of the command line.

use basrelief_input::Budget;
use basrelief_sim::{RecordingError, RunError};
use pyo3::exceptions::PyException;
use pyo3::{PyErr, create_exception};
use std::fmt::{self, Display, Formatter};

create_exception!(basrelief, Error, PyException, "What goes wrong.");
create_exception!(basrelief, UsageError, Error, "What was asked for makes no sense: the command line's exit code 2.");
create_exception!(basrelief, InputError, Error, "Bad input: the command line's exit code 1.");

/// What goes wrong, ahead of Python.
#[derive(Debug)]
pub enum Failure {
    /// Becomes a `UsageError`.
    Usage(String),
    /// Becomes an `InputError`.
    Bad(String),
}

/// What may go wrong.
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

/// Wrong usage.
pub fn usage(error: impl Display) -> Failure {
    Failure::Usage(error.to_string())
}

/// Bad input.
pub fn bad(error: impl Display) -> Failure {
    Failure::Bad(error.to_string())
}

/// Something wrong with or in what has this name.
pub fn within<E: Display>(name: &str) -> impl Fn(E) -> Failure {
    move |error| bad(format_args!("{name}: {error}"))
}

/// What keeps a run of this input from giving a report.
pub fn of_run(name: &str) -> impl Fn(RunError) -> Failure {
    move |error| match error {
        RunError::Trace(_) | RunError::OverBudget(_) | RunError::Fault(_) => within(name)(error),
        RunError::NoTimes => usage(error),
        _ => bad(error),
    }
}

/// What is wrong with a tape, or with what it is to be timed with.
pub fn of_tape(error: RecordingError) -> Failure {
    match error {
        RecordingError::Work(_) | RecordingError::OtherWork(_) | RecordingError::Config(_) => usage(error),
        // What the decoder says in its own words.
        RecordingError::Read(_) => not_a_tape(),
        _ => bad(error),
    }
}

/// A tape that is none.
pub fn not_a_tape() -> Failure {
    bad("not a recording, or incomplete; use Result.tape")
}

/// Memory for what is read.
pub fn budget(limit: u64) -> Budget {
    Budget::with_advice(limit, "give more with memory_limit, if this input is to be trusted")
}
