//! Reason and cure of an error with a file.

use basrelief_machines::MACHINES;
use basrelief_parameters::edit_distance;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Maximum number of entries of a folder that are searched for a similar name.
const MOST_ENTRIES: usize = 10_000;

/// Extensions of models.
const MODELS: [&str; 3] = ["glb", "gltf", "obj"];

/// Extensions of files that are written more often than read.
const OUTPUTS: [&str; 4] = ["csv", "html", "png", "svg"];

/// Maximum number of names in a suggestion.
const MOST_NAMES: usize = 3;

/// Returns the reason of an error with a file, and its cure. `doing` is `be read` or `be written`, for example.
pub fn reason_and_cure(path: &Path, doing: &str, error: &io::Error) -> String {
    let (is_output, is_input) = (matches!(doing, "be written" | "be created"), doing == "be read");
    let is_standard_input = is_input && path == Path::new("-");
    match error.kind() {
        ErrorKind::NotFound if is_input && !is_standard_input => {
            missing_input(path, "check the name, which is looked up from the current folder", error)
        }
        ErrorKind::NotFound if is_output && is_missing(folder_of(path)) => {
            format!("{error}; create the folder {} first", folder_of(path).display())
        }
        ErrorKind::PermissionDenied if is_input => format!("{error}; allow reading {}, or choose another file", path.display()),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem if is_output => {
            let folder = refusing_folder(path);
            format!(
                "{error}: the folder {} does not allow writing; choose another folder, or allow writing to it",
                folder.display()
            )
        }
        ErrorKind::NotFound if is_output => {
            format!("{error}: the folder {} takes no new files; choose another folder", folder_of(path).display())
        }
        ErrorKind::IsADirectory => {
            let example = if is_input { such_as(path) } else { None };
            format!("{error}; expected a file{}", example.unwrap_or_else(|| "; name one".into()))
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => format!("{error}; free space there, or choose another folder"),
        // Only making a folder, or a file below a file, fails in these ways.
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            let file = blocking_file(path).filter(|_| is_output);
            file.map_or_else(|| format!("{error}; expected a folder"), |file| expected_folder(&file))
        }
        // Commands that accept standard input do not open this path.
        _ if is_standard_input => format!("{error}; standard input is not accepted here, expected a file"),
        _ => error.to_string(),
    }
}

pub(crate) fn expected_folder(file: &Path) -> String {
    format!("{} is a file, expected a folder; choose another folder", file.display())
}

/// Returns the file in the place of this folder or of a folder above it.
pub(crate) fn blocking_file(folder: &Path) -> Option<PathBuf> {
    folder.ancestors().find(|path| path.exists()).filter(|path| !path.is_dir()).map(Path::to_path_buf)
}

/// Returns the path of a file that a plan names, if it exists. Without a file of its own, a plan looks up names in the current folder, and
/// whoever opens such a file reports that it is missing.
///
/// # Errors
/// The file does not exist.
pub fn existing_in_plan(plan: &Path, path: PathBuf) -> Result<PathBuf, String> {
    match path.metadata() {
        Err(error) if error.kind() == ErrorKind::NotFound && plan.parent().is_some() => {
            let check = "check the name, which is looked up from the folder of the plan";
            Err(format!("{}: cannot be read: {}", path.display(), missing_input(&path, check, &error)))
        }
        _ => Ok(path),
    }
}

/// Returns the reason, the expectation and the cure for an input that does not exist. `check` is the cure, unless the path is absolute.
fn missing_input(path: &Path, check: &str, error: &io::Error) -> String {
    let check = if path.is_absolute() { "check the name" } else { check };
    let mut names = demo_input(path).map_or_else(|| similar_files(path), |demo| vec![demo]);
    names.truncate(MOST_NAMES);
    let absent = path.ancestors().skip(1).filter(|folder| is_missing(folder)).last();
    if !names.is_empty() {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        format!("{error}; expected an existing file; did you mean {}? Otherwise {check}", names.join(" or "))
    } else if let Some(folder) = absent {
        format!("{error}; the folder {} does not exist; {check}", folder.display())
    } else {
        format!("{error}; expected an existing file; {check}")
    }
}

/// Returns a model in this folder as an example.
fn such_as(folder: &Path) -> Option<String> {
    let model = names_in(folder).into_iter().find(|name| is_model(Path::new(name)))?;
    Some(format!(", such as {}", folder.join(model).display()))
}

/// Returns true for the name of a model, by its extension.
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|given| MODELS.iter().any(|model| given.eq_ignore_ascii_case(model)))
}

/// Returns `demo:NAME` if the path is the name of a demo, with or without a tessellation.
fn demo_input(path: &Path) -> Option<String> {
    let given = path.to_str()?;
    is_demo(given).then(|| format!("demo:{given}"))
}

/// Returns true for the name of a demo, with or without a tessellation.
pub fn is_demo(name: &str) -> bool {
    let demo = name.split('@').next().unwrap_or(name);
    MACHINES.iter().any(|machine| machine.demos.contains(&demo))
}

/// Returns the files beside a missing file that have its name with another extension, or else the file with the nearest name, if at most a
/// third of the name differs.
fn similar_files(path: &Path) -> Vec<String> {
    let Some(given) = path.file_name().and_then(|name| name.to_str()) else { return Vec::new() };
    let mut names = names_in(folder_of(path));
    names.retain(|name| extension(name) == extension(given) || !OUTPUTS.contains(&extension(name)));
    let stem = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    let edits = |name: &str| edit_distance(&stem(given), &stem(name));
    let mut similar: Vec<&String> = names.iter().filter(|name| stem(name) == stem(given)).collect();
    if similar.is_empty() {
        let most = stem(given).chars().count() / 3;
        similar = names.iter().filter(|name| edits(name) <= most).min_by_key(|name| edits(name)).into_iter().collect();
    }
    similar.into_iter().map(|name| path.with_file_name(name).display().to_string()).collect()
}

fn extension(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, extension)| extension)
}

/// Returns the names in a folder in order, without hidden ones.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().take(MOST_ENTRIES).flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    names
}

/// Returns the folder that does not allow this output: the deepest folder on its path that exists.
fn refusing_folder(path: &Path) -> &Path {
    path.ancestors().find(|folder| folder.is_dir()).unwrap_or(Path::new("."))
}

/// Returns the folder of a file. It is `.` for a name alone.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Returns true for a folder that does not exist. An empty path is the current folder.
fn is_missing(folder: &Path) -> bool {
    !folder.as_os_str().is_empty() && matches!(folder.try_exists(), Ok(false))
}
