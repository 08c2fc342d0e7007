//! Reports on the terminal and in files.

use super::recording::ShortRecording;
use crate::args::TablesArgs;
use crate::error::{CommandResult, print_styled};
use crate::outputs::{OutputFolder, REPORT, RUN_RECORDING, earlier_files};
use crate::terminal::print_note;
use basrelief_report::{Report, TextStyle, to_csv, to_text};
use std::io::{self, Write};
use std::path::Path;

/// Writes the report, its tables and the recording, and publishes everything. Removes the files of an earlier run. Returns the names of
/// the written files.
pub fn publish_report(
    outputs: OutputFolder,
    report: &Report,
    csv: bool,
    recording: Option<ShortRecording>,
) -> io::Result<Vec<&'static str>> {
    let mut names = vec![REPORT];
    let mut file = outputs.create(REPORT)?;
    report.write_json(&mut file).and_then(|()| file.flush())?;
    if csv {
        names.push("report.csv");
        let mut file = outputs.create("report.csv")?;
        file.write_all(to_csv(report).as_bytes()).and_then(|()| file.flush())?;
    }
    if recording.map_or(Ok(false), |recording| recording.write_to(&outputs))? {
        names.push(RUN_RECORDING);
    }
    outputs.publish(REPORT, earlier_files)?;
    Ok(names)
}

/// Returns the line that lists the written files: the names of those in the folder of `--out`, and those of other options. `None` if
/// nothing was written.
pub fn written_line(folder: Option<(&Path, &str)>, others: &[(&str, &Path)]) -> Option<String> {
    let folder = folder.map(|(folder, names)| format!("{}/: {names}", folder.display()));
    let others = others.iter().map(|(option, path)| format!("{} ({option})", path.display()));
    let written: Vec<String> = folder.into_iter().chain(others).collect();
    (!written.is_empty()).then(|| format!("\nWritten to {}\n", written.join("\n")))
}

/// Prints the report, and a note for each named table that it does not have.
pub fn show_report(report: &Report, tables: &TablesArgs, style: TextStyle) -> CommandResult {
    tables.named_tables().filter_map(|table| table.absence(report)).for_each(|note| print_note(&format!("note: {note}")));
    print_styled(&to_text(report, style, &tables.selected_tables()), style)
}
