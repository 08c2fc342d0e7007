//! What can go wrong, and the exit code it means.

use std::io;
use std::path::Path;

/// A failed command.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command line makes no sense: exit code 2.
    #[error("{0}\nFor help, try --help.")]
    Usage(String),
    /// Bad input, or a check that failed: exit code 1.
    #[error("{0}")]
    Bad(String),
    /// Whoever read our output has gone.
    #[error("broken pipe")]
    BrokenPipe,
}

impl Failure {
    /// See the crate's documentation.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Bad(_) => 1,
            Self::BrokenPipe => 0,
        }
    }

    /// Bad input, from any error.
    pub fn bad(error: impl std::fmt::Display) -> Self {
        Self::Bad(error.to_string())
    }

    /// A file that cannot be read or written.
    pub fn file(path: &Path, doing: &str) -> impl FnOnce(io::Error) -> Self {
        let place = if path == Path::new("-") { "standard stream".to_owned() } else { path.display().to_string() };
        let doing = doing.to_owned();
        move |e| if e.kind() == io::ErrorKind::BrokenPipe { Self::BrokenPipe } else { Self::Bad(format!("{place}: cannot {doing}: {e}")) }
    }
}

/// Result of a command.
pub type Done<T = ()> = Result<T, Failure>;

/// Prints to standard output.
pub fn print(text: &str) -> Done {
    use io::Write;
    io::stdout().write_all(text.as_bytes()).and_then(|()| io::stdout().flush()).map_err(Failure::file(Path::new("-"), "write"))
}
