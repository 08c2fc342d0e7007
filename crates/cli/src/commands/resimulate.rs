//! `basrelief resimulate`.

use super::html::HtmlFile;
use super::recording::{ShortRecording, failure, open, place_of};
use super::reporting::{publish_report, show_report, written_line};
use super::simulate::limits_of;
use crate::args::ResimulateArgs;
use crate::clock::seconds;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::outputs::{OutputFolder, REPORT, RUN_RECORDING, check_distinct, check_outputs_keep_inputs};
use basrelief_report::Report;
use basrelief_sim::{ResimulateOptions, resimulate_to};
use std::path::Path;

/// Computes the timing of a recording anew.
pub fn resimulate(args: &ResimulateArgs, global: &GlobalOptions) -> CommandResult {
    let path = place_of(&args.recording);
    let page: Vec<(&str, &Path)> = args.html.iter().map(|page| ("--html", &**page)).collect();
    check_outputs(args, &path, &page)?;
    let mut reader = open(&path)?;
    let limits = limits_of(args.bottlenecks, args.no_bottlenecks);
    let settings = args.settings.clone();
    let options = ResimulateOptions { settings, bottlenecks: limits, clock: seconds, budget: global.budget.clone() };
    let mut recording = ShortRecording::new(limits)?;
    let result = resimulate_to(&mut reader, &options, &mut recording).map_err(failure(&path.display().to_string()))?;
    let report = result.with_host(seconds());
    let file = args.html.as_deref().map(|path| HtmlFile::open(path)?.finish(&report)).transpose()?;
    if args.json {
        print(&report.to_json().map_err(CommandError::bad_input)?)?;
    }
    let names = args.out.as_deref().map(|folder| publish_into(folder, &report, args.csv, recording)).transpose()?;
    if let (Some(file), Some(path)) = (file, &args.html) {
        file.publish().map_err(CommandError::at_file(path, "be written"))?;
    }
    if global.quiet || args.json {
        return Ok(());
    }
    show_report(&report, &args.tables, global.text_style())?;
    written_line(args.out.as_deref().zip(names.as_deref()), &page).map_or(Ok(()), |line| print(&line))
}

/// Refuses outputs that would overwrite the recording, its report, or each other.
fn check_outputs(args: &ResimulateArgs, recording: &Path, page: &[(&str, &Path)]) -> CommandResult {
    let own = args.out.as_ref().map(|folder| folder.join(RUN_RECORDING));
    let outputs: Vec<(&str, &Path)> = own.iter().map(|own| ("--out", &**own)).chain(page.iter().copied()).collect();
    let report = recording.with_file_name(REPORT);
    let inputs = [("RECORDING", recording), ("the report of RECORDING", &*report)];
    check_outputs_keep_inputs(None, &outputs, &inputs).map_err(CommandError::Usage)?;
    args.out.as_ref().map_or(Ok(()), |folder| check_distinct(folder, page)).map_err(CommandError::Usage)
}

/// Writes report, tables and recording into a folder. Returns the names of the written files.
fn publish_into(folder: &Path, report: &Report, csv: bool, recording: ShortRecording) -> CommandResult<String> {
    let failed = || CommandError::at_file(folder, "be written");
    let outputs = OutputFolder::begin(folder).map_err(failed())?;
    let names = publish_report(outputs, report, csv, Some(recording)).map_err(failed())?;
    Ok(names.join(", "))
}
