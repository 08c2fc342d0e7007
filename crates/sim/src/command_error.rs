//! Errors of the programs around a run.

use crate::{RecordingError, RunError};
use std::fmt::Display;
use std::io;
use std::path::Path;

/// Error of a program, by the party that can mend it.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// Wrong usage of the program, for example an unknown option or parameter.
    #[error("{0}")]
    Usage(String),
    /// Bad input or a failed check.
    #[error("{0}")]
    BadInput(String),
}

/// Result of a program.
pub type CommandResult<T = ()> = Result<T, CommandError>;

impl From<RunError> for CommandError {
    fn from(error: RunError) -> Self {
        match error {
            RunError::NoShortcuts(_) | RunError::NoMethods(..) | RunError::NoTimes => Self::usage(error),
            _ => Self::bad_input(error),
        }
    }
}

impl CommandError {
    /// Makes a usage error.
    pub fn usage(error: impl Display) -> Self {
        Self::Usage(error.to_string())
    }

    /// Makes an input error.
    pub fn bad_input(error: impl Display) -> Self {
        Self::BadInput(error.to_string())
    }

    /// Makes an input error in the file or stream of this name.
    pub fn in_input<E: Display>(name: &str) -> impl Fn(E) -> Self + use<E> {
        let name = name.to_owned();
        move |error| Self::BadInput(format!("{name}: {error}"))
    }

    /// Makes the error of a file that cannot be read or written.
    pub fn at_file(path: &Path, doing: &str) -> impl Fn(io::Error) -> Self + use<> {
        let within = Self::in_input(&format!("{}: cannot {doing}", path.display()));
        // Commands that accept standard input do not open this path.
        let is_stdin = path == Path::new("-") && doing == "be read";
        let cure = if is_stdin { "; standard input is not accepted here, expected a file" } else { "" };
        move |error| within(format!("{error}{cure}"))
    }

    /// Converts an error of a run. It names the input, unless a parameter or an output is at fault.
    pub fn of_run(input: &str) -> impl Fn(RunError) -> Self + use<> {
        let within = Self::in_input(input);
        move |error| match error {
            RunError::Trace(_) | RunError::OverBudget(_) | RunError::Fault(_) => within(error),
            _ => error.into(),
        }
    }

    /// Converts an error of a resimulation: the changed parameters are at fault, or the recording, which `unreadable` converts.
    pub fn of_resimulation(unreadable: impl Fn(RecordingError) -> Self) -> impl Fn(RecordingError) -> Self {
        move |error| match error {
            RecordingError::Work(_) | RecordingError::OtherWork(_) | RecordingError::Config(_) => Self::usage(error),
            _ => unreadable(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fault_of_a_run_names_input_and_wrong_usage_does_not() {
        let of_run = CommandError::of_run("a.bdl");
        assert!(matches!(of_run(RunError::Fault("overflow".into())), CommandError::BadInput(text) if text == "a.bdl: overflow"));
        assert!(
            matches!(of_run(RunError::NoShortcuts("shade")), CommandError::Usage(text) if text.starts_with("machine `shade`"))
        );
    }

    #[test]
    fn changed_work_is_wrong_usage_and_damage_is_bad_input() {
        let of = CommandError::of_resimulation(CommandError::in_input("run.recording"));
        assert!(matches!(of(RecordingError::Work("replacement.entries".into())), CommandError::Usage(_)));
        assert!(matches!(of(RecordingError::OtherRun), CommandError::BadInput(text) if text.starts_with("run.recording: ")));
    }
}
