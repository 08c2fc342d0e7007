//! Two outputs are never one file.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// What a run calls its own files in `--out`, beside pictures.
const REPORTS: [&str; 2] = ["report.json", "report.csv"];

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
        if place.parent() == out_folder.as_deref() && place.file_name().is_some_and(is_own) {
            let name = place.file_name().unwrap_or_default().display();
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

/// Pictures, and reports.
fn is_own(name: &OsStr) -> bool {
    Path::new(name).extension().is_some_and(|e| e == "png") || REPORTS.iter().any(|report| name == *report)
}

/// A file's one name: links of its folder followed, the file itself not, since a link is what is replaced.
fn place(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match (absolute.parent().map(Path::canonicalize), absolute.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => absolute,
    }
}
