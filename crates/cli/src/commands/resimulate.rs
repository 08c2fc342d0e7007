//! `basrelief resimulate`.

use super::html::HtmlFile;
use super::recording::{ShortRecording, failure, open, place_of};
use super::reporting::{publish_report, show_report};
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
    let name = path.display().to_string();
    let own = args.out.as_ref().map(|folder| folder.join(RUN_RECORDING));
    let page: Vec<(&str, &Path)> = args.html.iter().map(|page| ("--html", &**page)).collect();
    let outputs: Vec<(&str, &Path)> = own.iter().map(|own| ("--out", &**own)).chain(page.iter().copied()).collect();
    let report = path.with_file_name(REPORT);
    let inputs = [("RECORDING", &*path), ("the report of RECORDING", &*report)];
    check_outputs_keep_inputs(None, &outputs, &inputs).map_err(CommandError::Usage)?;
    if let Some(folder) = &args.out {
        check_distinct(folder, &page).map_err(CommandError::Usage)?;
    }
    let mut reader = open(&path)?;
    let limits = limits_of(args.bottlenecks, args.no_bottlenecks);
    let settings = args.settings.clone();
    let options = ResimulateOptions { settings, bottlenecks: limits, clock: seconds, budget: global.budget.clone() };
    let mut recording = ShortRecording::new(limits)?;
    let result = resimulate_to(&mut reader, &options, &mut recording).map_err(failure(&name))?;
    let report = result.with_host(seconds());
    let page = args.html.as_deref().map(|path| HtmlFile::open(path)?.finish(&report)).transpose()?;
    if args.json {
        print(&report.to_json().map_err(CommandError::bad_input)?)?;
    }
    let names = args.out.as_deref().map(|folder| write_folder(folder, &report, recording, args.csv)).transpose()?;
    if let (Some(page), Some(path)) = (page, &args.html) {
        page.publish().map_err(CommandError::at_file(path, "be written"))?;
    }
    if global.quiet || args.json {
        return Ok(());
    }
    show_report(&report, &args.tables, global.text_style())?;
    written_line(args, names).map_or(Ok(()), |line| print(&line))
}

/// Writes report and recording into a folder. Returns the names of the written files.
fn write_folder(folder: &Path, report: &Report, recording: ShortRecording, csv: bool) -> CommandResult<Vec<&'static str>> {
    let failed = || CommandError::at_file(folder, "be written");
    let outputs = OutputFolder::begin(folder).map_err(failed())?;
    let has_recording = recording.write_to(&outputs).map_err(failed())?;
    publish_report(outputs, report, csv).map_err(failed())?;
    let names = [(REPORT, true), ("report.csv", csv), (RUN_RECORDING, has_recording)];
    Ok(names.into_iter().filter(|(_, is_written)| *is_written).map(|(name, _)| name).collect())
}

/// Returns the line that lists the written files, as after a run. `names` are the files in the folder of `--out`.
fn written_line(args: &ResimulateArgs, names: Option<Vec<&'static str>>) -> Option<String> {
    let folder = args.out.as_deref().zip(names).map(|(out, names)| format!("{}/: {}", out.display(), names.join(", ")));
    let page = args.html.as_deref().map(|page| page.display().to_string());
    let written = match (folder, page) {
        (Some(folder), Some(page)) => format!("{folder}\n--html: {page}"),
        (folder, page) => folder.or(page)?,
    };
    Some(format!("\nWritten to {written}\n"))
}
