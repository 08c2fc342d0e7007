//! Errors of commands and their exit codes.

use crate::terminal;
use basrelief_sim::RunError;
use std::io::{self, IsTerminal as _, Write};
use std::path::Path;

/// Error of a command.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Wrong usage: exit code 2.
    #[error("{0}\nFor help, try --help.")]
    Usage(String),
    /// Bad input or a failed check: exit code 1.
    #[error("{0}")]
    Bad(String),
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::NoShortcuts(_) | RunError::NoMethods(..) | RunError::NoTimes => Self::Usage(error.to_string()),
            _ => Self::bad(error),
        }
    }
}

impl Failure {
    /// Returns the exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Bad(_) => 1,
        }
    }

    /// Makes an input error.
    pub fn bad(error: impl std::fmt::Display) -> Self {
        Self::Bad(error.to_string())
    }

    /// Makes an input error in the file or stream of this name.
    pub fn within<E: std::fmt::Display>(name: &str) -> impl Fn(E) -> Self + use<E> {
        let name = name.to_owned();
        move |e| Self::Bad(format!("{name}: {e}"))
    }

    /// Makes the error of a file that cannot be read or written.
    pub fn file(path: &Path, doing: &str) -> impl Fn(io::Error) -> Self + use<> {
        let what = format!("{}: cannot {doing}", path.display());
        move |e| Self::Bad(format!("{what}: {e}"))
    }
}

/// Result of a command.
pub type Done<T = ()> = Result<T, Failure>;

/// Prints to standard output. A closed pipe (`| head`) is no error: the command continues to its own exit code.
pub fn print(text: &str) -> Done {
    let mut out = io::stdout();
    let text = terminal::safe(text, out.is_terminal());
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Bad(format!("standard output: cannot be written: {e}"))),
        _ => Ok(()),
    }
}
