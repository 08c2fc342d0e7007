//! Errors of the programs around a run.

use crate::file_cure::{blocking_file, expected_folder, reason_and_cure};
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
            RunError::NoShortcuts(..) | RunError::NoMethods(..) | RunError::NoTimes => Self::usage(error),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn error(kind: io::ErrorKind, path: &Path, doing: &str) -> String {
        let text = CommandError::at_file(path, doing)(kind.into()).to_string();
        text.strip_prefix(&format!("{}: cannot {doing}: ", path.display())).unwrap().to_owned()
    }

    #[test]
    fn output_into_missing_folder_names_folder_and_cure() {
        let error = |kind, path: &str, doing| error(kind, Path::new(path), doing);
        let text = |path| error(io::ErrorKind::NotFound, path, "be written");
        assert_eq!(text("none/deep/x"), "entity not found; create the folder none/deep first");
        assert_eq!(text("x"), "entity not found: the folder . takes no new files; choose another folder");
        assert_eq!(error(io::ErrorKind::IsADirectory, "src", "be read"), "is a directory; expected a file; name one");
        assert_eq!(error(io::ErrorKind::AlreadyExists, "a.png", "be written"), "entity already exists; expected a folder");
    }

    #[test]
    fn missing_input_names_similar_file_or_demo() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["patch.gltf", "board.glb", ".hidden.glb", "zzzz.html"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let text = |path: &Path| error(io::ErrorKind::NotFound, path, "be read");
        let meant = |path: &str, check: &str| {
            format!("entity not found; expected an existing file; did you mean `{path}`? Otherwise check the name{check}")
        };
        for (given, file) in [("patch.obj", "patch.gltf"), ("patch", "patch.gltf"), ("baord.glb", "board.glb")] {
            let expected = meant(&folder.path().join(file).display().to_string(), "");
            assert_eq!(text(&folder.path().join(given)), expected, "{given}");
        }
        let in_its_place = error(io::ErrorKind::IsADirectory, folder.path(), "be read");
        let model = folder.path().join("board.glb");
        assert_eq!(in_its_place, format!("is a directory; expected a file, such as {}", model.display()));
        // A page is an output.
        assert!(!text(&folder.path().join("zzzz.gltf")).contains("did you mean"));
        for demo in ["golf-ball", "goblet@8"] {
            assert_eq!(text(Path::new(demo)), meant(&format!("demo:{demo}"), ", which is looked up from the current folder"));
        }
        for far in ["batch.gltf", "pot.gltf", "p.toml", "boar.glb", "bard.glb"] {
            let is_near = ["batch.gltf", "boar.glb", "bard.glb"].contains(&far);
            assert_eq!(text(&folder.path().join(far)).contains("did you mean"), is_near, "{far}");
        }
    }

    #[test]
    fn missing_input_without_similar_file_has_a_cure() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("board.glb"), "").unwrap();
        let text = |path: &Path| error(io::ErrorKind::NotFound, path, "be read");
        let absolute = text(&folder.path().join("zzz.glb"));
        assert_eq!(absolute, "entity not found; expected an existing file; check the name");
        let cure = "check the name, which is looked up from the current folder";
        assert_eq!(text(Path::new("zzzzz.glb")), format!("entity not found; expected an existing file; {cure}"));
        assert_eq!(text(Path::new("none/deep/x")), format!("entity not found; the folder none does not exist; {cure}"));
    }

    #[test]
    fn refused_output_names_refusing_folder_and_cure() {
        let folder = tempfile::tempdir().unwrap();
        let (file, shown) = (folder.path().join("file"), folder.path().display());
        std::fs::write(&file, "").unwrap();
        let cure = format!("the folder {shown} does not allow writing; choose another folder, or allow writing to it");
        for path in [folder.path().to_path_buf(), folder.path().join("a/b/c"), file] {
            assert_eq!(error(io::ErrorKind::PermissionDenied, &path, "be written"), format!("permission denied: {cure}"));
        }
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
            matches!(of_run(RunError::NoShortcuts("shade", "bump".into())), CommandError::Usage(text) if text.starts_with("machine `shade`"))
        );
    }

    #[test]
    fn changed_work_is_wrong_usage_and_damage_is_bad_input() {
        let of = CommandError::of_resimulation(CommandError::in_input("run.recording"));
        assert!(matches!(of(RecordingError::Work("replacement.entries".into())), CommandError::Usage(_)));
        assert!(matches!(of(RecordingError::OtherRun), CommandError::BadInput(text) if text.starts_with("run.recording: ")));
    }
}
