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
    let options = ResimulateOptions { settings: args.settings.clone(), bottlenecks: limits, budget: global.budget.clone() };
    let mut recording = ShortRecording::new(limits)?;
    let report = resimulate_to(&mut reader, &options, &mut recording).map_err(failure(&name))?;
    let took = seconds();
    let report = report.with_host(took, took);
    let page = args.html.as_deref().map(|path| HtmlFile::open(path)?.finish(&report)).transpose()?;
    if args.json {
        print(&report.to_json().map_err(CommandError::bad_input)?)?;
    }
    if let Some(folder) = &args.out {
        let outputs = OutputFolder::begin(folder).map_err(CommandError::at_file(folder, "be written"))?;
        recording.write_to(&outputs).map_err(CommandError::at_file(folder, "be written"))?;
        publish_report(outputs, &report, args.csv).map_err(CommandError::at_file(folder, "be written"))?;
    }
    if let (Some(page), Some(path)) = (page, &args.html) {
        page.publish().map_err(CommandError::at_file(path, "be written"))?;
    }
    if global.quiet || args.json { Ok(()) } else { show_report(&report, &args.tables, global.text_style()) }
}
