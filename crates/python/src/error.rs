//! Errors as Python exceptions, with the messages of the command line.

pub use basrelief_sim::{CommandError, CommandResult};

use basrelief_input::MemoryPool;
use basrelief_sim::RecordingError;
use pyo3::exceptions::PyException;
use pyo3::{PyErr, create_exception};

create_exception!(basrelief, Error, PyException, "Base class of all errors.");
create_exception!(basrelief, UsageError, Error, "Wrong arguments; exit code 2 of the command line.");
create_exception!(basrelief, InputError, Error, "Bad input; exit code 1 of the command line.");

/// Python exception, made from a failure of the simulator or raised by Python itself.
pub struct PythonError(PyErr);

/// Result of a function that Python calls.
pub type PythonResult<T> = Result<T, PythonError>;

impl From<CommandError> for PythonError {
    fn from(failure: CommandError) -> Self {
        Self(match failure {
            CommandError::Usage(text) => UsageError::new_err(text),
            CommandError::BadInput(text) => InputError::new_err(text),
        })
    }
}

impl From<PyErr> for PythonError {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<PythonError> for PyErr {
    fn from(PythonError(error): PythonError) -> Self {
        error
    }
}

/// Converts an error of a recording or of the new parameters.
pub fn of_recording(error: RecordingError) -> CommandError {
    let unreadable = |error| match error {
        // The decoder reports damage in its own words.
        RecordingError::Read(_) => not_a_recording(),
        _ => CommandError::bad_input(error),
    };
    CommandError::of_resimulation(unreadable)(error)
}

/// Makes the error of an invalid recording.
pub fn not_a_recording() -> CommandError {
    CommandError::bad_input("not a recording, or damaged; Result.recording is one")
}

/// Makes a memory limit for input data.
pub fn budget(limit: u64) -> MemoryPool {
    MemoryPool::with_advice(limit, "give more with memory_limit, if this input is to be trusted")
}
