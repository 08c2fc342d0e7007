//! Reports on the terminal and in files.

use crate::args::TablesArgs;
use crate::error::{CommandResult, print_styled};
use crate::outputs::{OF_A_RUN, OutputFolder, REPORT};
use basrelief_report::{Report, TextStyle, to_csv, to_text};
use std::io::{self, Write};

/// Writes the report and its tables, and publishes everything.
pub fn publish_report(outputs: OutputFolder, report: &Report, csv: bool) -> io::Result<()> {
    let mut file = outputs.create(REPORT)?;
    report.write_json(&mut file).and_then(|()| file.flush())?;
    if csv {
        let mut file = outputs.create("report.csv")?;
        file.write_all(to_csv(report).as_bytes()).and_then(|()| file.flush())?;
    }
    outputs.publish(REPORT, &OF_A_RUN)
}

/// Prints the report.
pub fn show_report(report: &Report, tables: &TablesArgs, style: TextStyle) -> CommandResult {
    print_styled(&to_text(report, style, &tables.selected_tables()), style)
}
