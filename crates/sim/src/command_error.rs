//! Errors of the programs around a run.

use crate::{RecordingError, RunError};
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

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
        let (path, doing) = (path.to_path_buf(), doing.to_owned());
        move |error| Self::BadInput(format!("{}: cannot {doing}: {}", path.display(), reason_and_cure(&path, &doing, &error)))
    }

    /// Checks that a folder exists or can be made.
    ///
    /// # Errors
    /// A file in its place, or in the place of a folder above it.
    pub fn check_folder(path: &Path) -> CommandResult {
        let blocked = |file: PathBuf| format!("{}: cannot be written: {}", path.display(), expected_folder(&file));
        blocking_file(path).map_or(Ok(()), |file| Err(Self::BadInput(blocked(file))))
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

/// Returns the reason of an error with a file, and its cure.
fn reason_and_cure(path: &Path, doing: &str, error: &io::Error) -> String {
    let (is_output, is_input) = (doing == "be written", doing == "be read");
    if let Some(folder) = path.parent().filter(|folder| is_output && is_missing(folder)) {
        return format!("{error}; create the folder {} first", folder.display());
    }
    match error.kind() {
        io::ErrorKind::IsADirectory => format!("{error}; expected a file"),
        // Only making a folder, or a file below a file, fails in these ways.
        io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
            let file = blocking_file(path).filter(|_| is_output);
            file.map_or_else(|| format!("{error}; expected a folder"), |file| expected_folder(&file))
        }
        // Commands that accept standard input do not open this path.
        _ if is_input && path == Path::new("-") => format!("{error}; standard input is not accepted here, expected a file"),
        _ => error.to_string(),
    }
}

fn expected_folder(file: &Path) -> String {
    format!("{} is a file, expected a folder; choose another folder", file.display())
}

/// Returns the file in the place of this folder or of a folder above it.
fn blocking_file(folder: &Path) -> Option<PathBuf> {
    folder.ancestors().find(|path| path.exists()).filter(|path| !path.is_dir()).map(Path::to_path_buf)
}

/// Returns true for a folder that does not exist. An empty path is the working directory.
fn is_missing(folder: &Path) -> bool {
    !folder.as_os_str().is_empty() && matches!(folder.try_exists(), Ok(false))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_into_missing_folder_names_folder_and_cure() {
        let error = |kind: io::ErrorKind, path, doing| CommandError::at_file(Path::new(path), doing)(kind.into()).to_string();
        let text = |path, doing| error(io::ErrorKind::NotFound, path, doing);
        assert_eq!(
            text("none/deep/x", "be written"),
            "none/deep/x: cannot be written: entity not found; create the folder none/deep first"
        );
        assert_eq!(text("x", "be written"), "x: cannot be written: entity not found");
        assert_eq!(text("none/x", "be read"), "none/x: cannot be read: entity not found");
        assert_eq!(error(io::ErrorKind::IsADirectory, "src", "be read"), "src: cannot be read: is a directory; expected a file");
        assert_eq!(
            error(io::ErrorKind::AlreadyExists, "a.png", "be written"),
            "a.png: cannot be written: entity already exists; expected a folder"
        );
    }

    #[test]
    fn file_in_the_place_of_a_folder_is_named_with_the_cure() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let below = file.join("a").join("b");
        for (path, kind) in [(&file, io::ErrorKind::AlreadyExists), (&below, io::ErrorKind::NotADirectory)] {
            let text = CommandError::at_file(path, "be written")(kind.into()).to_string();
            let cure = format!("{} is a file, expected a folder; choose another folder", file.display());
            assert_eq!(text, format!("{}: cannot be written: {cure}", path.display()));
            assert_eq!(CommandError::check_folder(path).unwrap_err().to_string(), text);
        }
        assert!([folder.path(), &folder.path().join("new")].map(CommandError::check_folder).iter().all(Result::is_ok));
    }

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
