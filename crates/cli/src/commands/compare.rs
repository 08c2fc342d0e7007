//! `basrelief compare`: changes between reports and their causes.

use super::causes::CauseMeasurement;
use super::recording::{open, unreadable};
use crate::args::CompareArgs;
use crate::error::{CommandError, CommandResult, print, print_styled};
use crate::global::GlobalOptions;
use crate::input::read_text;
use crate::outputs::{PartialFile, REPORT, check_outputs_keep_inputs, recording_in};
use crate::terminal;
use basrelief_input::{MemoryPool, json_weight};
use basrelief_report::compare::comparisons_text;
use basrelief_report::html::{self, PagePicture, compared};
use basrelief_report::{Comparison, Report, TextStyle, compare as difference};
use basrelief_sim::{RecordedRun, RecordingError, page_assets};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A report and the recording beside it.
struct ReportSide {
    name: String,
    report: Report,
    file: PathBuf,
    folder: PathBuf,
    recorded: Option<RecordedRun>,
}

/// Comparison of two reports.
struct ReportPair<'a> {
    a: &'a str,
    b: &'a str,
    comparison: Comparison,
}

/// Compares the first report with each of the others; fails over a limit.
pub fn compare(args: &CompareArgs, global: &GlobalOptions) -> CommandResult {
    let budget = &global.budget;
    let first = ReportSide::read(&args.a, budget)?;
    let others = args.others.iter().map(|path| ReportSide::read(path, budget)).collect::<CommandResult<Vec<_>>>()?;
    if let Some(page) = &args.html {
        let sides = std::iter::once(("A", &first)).chain(others.iter().map(|other| ("B", other)));
        let files: Vec<(&str, PathBuf)> = sides.flat_map(|(name, side)| side.files().map(move |file| (name, file))).collect();
        let files: Vec<(&str, &Path)> = files.iter().map(|(name, file)| (*name, &**file)).collect();
        check_outputs_keep_inputs(None, &[("--html", page)], &files).map_err(CommandError::Usage)?;
    }
    let causes = CauseMeasurement::new(args, (&first.report, first.recorded.as_ref()), global)?;
    let pairs: Vec<ReportPair<'_>> = others.iter().map(|other| first.compare_with(other, &causes)).collect();
    if args.json {
        let mut list = pairs.iter().map(ReportPair::to_json).collect::<CommandResult<Vec<Value>>>()?;
        let json = if pairs.len() == 1 { list.swap_remove(0) } else { list.into() };
        print(&format!("{json:#}\n"))?;
    } else {
        let style = global.text_style();
        print_styled(&text(&first, &others, &pairs, style), style)?;
    }
    if let Some(path) = &args.html {
        page(path, &first, &others, &pairs)?;
    }
    match args.fail_over {
        Some(limit) => check_limit(&pairs, limit, args.allow_other_input),
        None => Ok(()),
    }
}

/// Largest number of reasons in the error message.
const MOST_REASONS: usize = 8;

/// Fails if a report fails the limit.
fn check_limit(pairs: &[ReportPair<'_>], limit: f64, allow_other_input: bool) -> CommandResult {
    let failures = pairs.iter().flat_map(|ReportPair { b, comparison, .. }| {
        let has_other_input = comparison.other_input && !allow_other_input;
        let input = has_other_input.then(|| format!("{b}: {OTHER_INPUT}"));
        input.into_iter().chain(comparison.failures(limit).into_iter().map(move |reason| format!("{b}: {reason}")))
    });
    let mut failures: Vec<String> = failures.collect();
    let more = failures.len().saturating_sub(MOST_REASONS);
    failures.truncate(MOST_REASONS);
    failures.extend((more > 0).then(|| format!("and {more} more")));
    if failures.is_empty() { Ok(()) } else { Err(CommandError::BadInput(failures.join("\n"))) }
}

const OTHER_INPUT: &str =
    "input.sha256 differs from A or is unknown, so the runs cannot be judged; --allow-other-input judges them";

/// Writes the comparison as an HTML page, with the images beside the reports.
fn page(path: &Path, first: &ReportSide, others: &[ReportSide], pairs: &[ReportPair<'_>]) -> CommandResult {
    let pairs = others.iter().zip(pairs).map(|(other, pair)| Ok((other.html_side()?, &pair.comparison)));
    let page = compared(&first.html_side()?, &pairs.collect::<CommandResult<Vec<_>>>()?);
    PartialFile::write_whole(path, page.as_bytes()).map_err(CommandError::at_file(path, "be written"))
}

fn text(first: &ReportSide, others: &[ReportSide], pairs: &[ReportPair<'_>], style: TextStyle) -> String {
    let compared = others.iter().zip(pairs).map(|(other, pair)| ((&*other.name, &other.report), &pair.comparison));
    comparisons_text((&first.name, &first.report), &compared.collect::<Vec<_>>(), style)
}

impl ReportPair<'_> {
    fn to_json(&self) -> CommandResult<Value> {
        let mut json = serde_json::to_value(&self.comparison).map_err(CommandError::bad_input)?;
        json["a"] = self.a.into();
        json["b"] = self.b.into();
        Ok(json)
    }
}

impl ReportSide {
    fn read(path: &Path, budget: &MemoryPool) -> CommandResult<Self> {
        let file = if path.is_dir() { path.join(REPORT) } else { path.to_path_buf() };
        let (text, _held) = read_text(&file, "a report (report.json), or the folder that holds it", budget)?;
        let name = file.display().to_string();
        // The memory stays reserved until the end of the program.
        budget
            .try_reserve(json_weight(text.as_bytes()), "the values of a report")
            .map_err(CommandError::in_input(&name))?
            .keep_forever();
        let report = Report::from_json(&text).map_err(CommandError::in_input(&name))?;
        // A recording belongs only to a report with its original name.
        let recording = recording_in(file.parent().unwrap_or(Path::new("")));
        let has_recording = file.ends_with(REPORT) && recording.exists();
        let recorded = if has_recording { read_recording(&report, &recording, budget)? } else { None };
        let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
        Ok(Self { name: path.display().to_string(), report, file, folder, recorded })
    }

    /// Returns the files of this side: report, recording and image.
    fn files(&self) -> impl Iterator<Item = PathBuf> {
        [self.file.clone(), recording_in(&self.folder)].into_iter().chain(self.image())
    }

    /// Returns the image of the last frame, if it lies beside the report.
    fn image(&self) -> Option<PathBuf> {
        // A name alone, because a report of unknown origin must not select other files.
        let name = Path::new(&self.report.image.last()?.file);
        let file = self.folder.join(name);
        (name.file_name() == Some(name.as_os_str()) && file.is_file()).then_some(file)
    }

    /// Returns the side for the HTML page.
    fn html_side(&self) -> CommandResult<html::ComparedReport<'_>> {
        let mut assets = page_assets(&self.report).map_err(CommandError::in_input(&self.name))?;
        if let Some(file) = self.image() {
            let png = fs::read(&file).map_err(CommandError::at_file(&file, "be read"))?;
            assets.pictures = vec![PagePicture { caption: "The machine's image".into(), png, largest: None }];
        }
        Ok(html::ComparedReport { name: &self.name, report: &self.report, assets })
    }

    fn compare_with<'a>(&'a self, other: &'a Self, causes: &CauseMeasurement<'_>) -> ReportPair<'a> {
        let explained = self.recorded.as_ref().zip(other.recorded.as_ref()).and_then(|(a, b)| causes.explain(a, b));
        ReportPair { a: &self.name, b: &other.name, comparison: difference(&self.report, &other.report, explained) }
    }
}

/// Reads a recording. Without the recording of another build, the comparison has less to say and is still right.
fn read_recording(report: &Report, path: &Path, budget: &MemoryPool) -> CommandResult<Option<RecordedRun>> {
    let name = path.display();
    match RecordedRun::read(report, &mut open(path)?, budget) {
        Err(error @ RecordingError::OtherBuild { .. }) => {
            terminal::print_note(&format!("{name}: {error}; causes are not measured"));
            Ok(None)
        }
        read => read.map(Some).map_err(unreadable(&name.to_string())),
    }
}
