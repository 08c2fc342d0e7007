//! Checks that outputs overwrite neither each other nor inputs.

use crate::inputs_read;
use basrelief_sim::{COST_PICTURES, MACHINES, aux_outputs};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// File name of a report.
pub const REPORT: &str = "report.json";
/// File name of the recording beside a report.
pub const RUN_RECORDING: &str = "run.recording";
/// File name of that recording before version 0.2.
const OLD_RUN_RECORDING: &str = "run.tape";
/// Files that describe a run. Those of an older run do not belong beside the images of a new one.
pub const OF_A_RUN: [&str; 4] = [REPORT, "report.csv", RUN_RECORDING, OLD_RUN_RECORDING];
/// Files that a run writes into `--out`, besides images.
const OWN: [&str; 8] =
    [REPORT, "report.csv", RUN_RECORDING, OLD_RUN_RECORDING, "ablation.json", "ablation.csv", "methods.json", "methods.csv"];

/// Pictures of a frame, the machine's image first.
pub(super) const PICTURES: [&str; 3] = ["image", "reference", "difference"];

/// Checks that a path does not mean standard output, which prints the summary.
///
/// # Errors
/// `-`.
pub fn not_stdout(path: &Path) -> Result<(), &'static str> {
    let refused = "standard output is reserved for the report; expected a file (`./-` for a file called `-`)";
    if path == Path::new("-") { Err(refused) } else { Ok(()) }
}

/// Returns the recording in `folder`, under its present or its old name.
pub fn recording_in(folder: &Path) -> PathBuf {
    let old = folder.join(OLD_RUN_RECORDING);
    if old.is_file() && !folder.join(RUN_RECORDING).exists() { old } else { folder.join(RUN_RECORDING) }
}

/// Refuses two outputs with the same file, including the files that a run writes into the existing folder `out`.
///
/// # Errors
/// A sentence with the option to change.
pub fn check_distinct(out: &Path, named: &[(&str, &Path)]) -> Result<(), String> {
    let out_folder = out.canonicalize().ok();
    let mut seen: Vec<(PathBuf, &str, &Path)> = Vec::new();
    for &(option, path) in named {
        let place = canonical_path(path);
        // A link in `out` with the name of a report would be replaced; one elsewhere leads to the report.
        let named = resolve_folder(path);
        let own = [&place, &named].into_iter().filter(|at| at.parent() == out_folder.as_deref());
        if let Some(name) = own.filter_map(|at| at.file_name()).find(|name| is_own(name) && !is_its_recording(option, name)) {
            let name = name.display();
            return Err(format!(
                "{option}: {} is the {name} of this run in --out {}; choose another name",
                path.display(),
                out.display()
            ));
        }
        if let Some((_, other, at)) = seen.iter().find(|(seen, ..)| *seen == place) {
            let (path, at) = (path.display(), at.display());
            let under = if path.to_string() == at.to_string() { String::new() } else { format!(" (as {at})") };
            return Err(format!("{option}: {path} is also the output of {other}{under}; choose another name"));
        }
        seen.push((place, option, path));
    }
    Ok(())
}

/// Returns true for images, reports and recordings.
fn is_own(name: &OsStr) -> bool {
    Path::new(name).extension().is_some_and(|e| e == "png") || OWN.iter().any(|own| name == *own)
}

/// Returns true if `--recording` names the recording that the run writes anyway.
fn is_its_recording(option: &str, name: &OsStr) -> bool {
    option == "--recording" && name == RUN_RECORDING
}

/// Returns true for a file that a run can write into `--out`. A texture may be there under another name.
fn is_written(name: &OsStr) -> bool {
    let (path, own) = (Path::new(name), PICTURES.map(str::to_owned));
    let aux = MACHINES.iter().flat_map(aux_outputs).chain(COST_PICTURES).map(|output| output.name.to_owned());
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let is_kind = |kind: String| stem.strip_prefix(&kind).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'));
    OWN.iter().any(|own| name == *own) || path.extension().is_some_and(|e| e == "png") && own.into_iter().chain(aux).any(is_kind)
}

/// Refuses outputs that would overwrite an input. Every command with inputs and outputs calls this function before it writes. Files
/// that a model or a trace names are inputs as soon as they are read.
///
/// `folder` is the folder of `--out`, into which a run writes files under names of its own.
///
/// # Errors
/// A sentence with the option to change.
pub fn check_outputs_keep_inputs(folder: Option<&Path>, named: &[(&str, &Path)], inputs: &[(&str, &Path)]) -> Result<(), String> {
    let folder = folder.and_then(|folder| folder.canonicalize().ok());
    let named_by_inputs = inputs_read::files_read();
    let further = named_by_inputs.iter().map(|path| ("a file that INPUT names", &**path));
    for (what, input) in inputs.iter().copied().chain(further).filter(|(_, input)| input.is_file()) {
        let taken = canonical_path(input);
        let own = taken.parent() == folder.as_deref() && taken.file_name().is_some_and(is_written);
        let named = named.iter().find(|(_, output)| canonical_path(output) == taken);
        if let Some(option) = named.map(|(option, _)| *option).or(own.then_some("--out")) {
            let input = input.display();
            return Err(format!("{option}: {input} is an input ({what}) and would be overwritten; choose another name"));
        }
    }
    Ok(())
}

/// Returns the canonical path of a file, links followed, as in [`PartialFile`](super::PartialFile).
fn canonical_path(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| resolve_folder(path))
}

/// Returns the path of a file with the links of its folder followed.
fn resolve_folder(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match (absolute.parent().map(Path::canonicalize), absolute.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => absolute,
    }
}
