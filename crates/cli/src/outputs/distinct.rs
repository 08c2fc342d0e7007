//! Two outputs are never one file.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The report of a run.
pub const REPORT: &str = "report.json";
/// The tape of the run that the report beside it tells of.
pub const RUN_TAPE: &str = "run.tape";
/// What a run calls its own files in `--out`, beside pictures.
const OWN: [&str; 3] = [REPORT, "report.csv", RUN_TAPE];

/// Whether each output has a file of its own, under whichever name: those that options name, and those that a run writes into
/// `out`, a folder that is there.
///
/// # Errors
/// A sentence with the option to change.
pub fn check_distinct(out: &Path, named: &[(&str, &Path)]) -> Result<(), String> {
    let out_folder = out.canonicalize().ok();
    let mut seen: Vec<(PathBuf, &str, &Path)> = Vec::new();
    for &(option, path) in named {
        let place = place(path);
        // A link in `out` that has the name of a report is replaced by it; one from elsewhere leads to it.
        let named = beside(path);
        let own = [&place, &named].into_iter().filter(|at| at.parent() == out_folder.as_deref());
        if let Some(name) = own.filter_map(|at| at.file_name()).find(|name| is_own(name) && !is_its_tape(option, name)) {
            let name = name.display();
            return Err(format!(
                "{option}: {} is the run's own {name} in --out {}; give it another name",
                path.display(),
                out.display()
            ));
        }
        if let Some((_, other, at)) = seen.iter().find(|(seen, ..)| *seen == place) {
            let (path, at) = (path.display(), at.display());
            let under = if path.to_string() == at.to_string() { String::new() } else { format!(", there as {at}") };
            return Err(format!("{option}: {path} is named twice (by {other}{under}); give each output a file"));
        }
        seen.push((place, option, path));
    }
    Ok(())
}

/// Pictures, report and tape.
fn is_own(name: &OsStr) -> bool {
    Path::new(name).extension().is_some_and(|e| e == "png") || OWN.iter().any(|own| name == *own)
}

/// A tape may take the place of the run's own, which is left only where it is short.
fn is_its_tape(option: &str, name: &OsStr) -> bool {
    option == "--tape" && name == RUN_TAPE
}

/// Whether each output is something else than what the run reads: an input that is replaced is lost.
///
/// # Errors
/// A sentence with the option to change.
pub fn check_not_read(named: &[(&str, &Path)], read: &[(&str, &Path)]) -> Result<(), String> {
    let wrong = |(option, output): &(&str, &Path)| {
        let (what, _) = read.iter().find(|(_, input)| input.is_file() && place(input) == place(output))?;
        Some(format!("{option}: {} is what {what} reads, and would be replaced; give it another name", output.display()))
    };
    named.iter().find_map(wrong).map_or(Ok(()), Err)
}

/// A file's one name, as [`PartialFile`](super::PartialFile) takes it: links followed.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| beside(path))
}

/// A file's name in its folder: links of the folder followed, the file itself not.
fn beside(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match (absolute.parent().map(Path::canonicalize), absolute.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => absolute,
    }
}
