//! `basrelief compare`: what changed between reports, and what explains it.

use super::simulate::style;
use super::tape::{open, unreadable};
use crate::args::CompareArgs;
use crate::error::{Done, Failure, print};
use crate::input::read_text;
use crate::outputs::{PartialFile, REPORT, RUN_TAPE};
use basrelief_input::{Budget, json_weight};
use basrelief_report::compare::overview;
use basrelief_report::html::{self, PagePicture, compared};
use basrelief_report::{Comparison, Report, compare as difference};
use basrelief_sim::{RecordedRun, explain, page_assets};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A report, and its tape where that is beside it.
struct Side {
    name: String,
    report: Report,
    /// Where it lies.
    folder: PathBuf,
    taped: Option<RecordedRun>,
}

/// What changed from one report to another.
struct Pair<'a> {
    a: &'a str,
    b: &'a str,
    comparison: Comparison,
}

/// Lists changes from the first to each of the others, largest first; fails over a limit.
pub fn compare(args: &CompareArgs, budget: &Budget) -> Done {
    let first = Side::read(&args.a, budget)?;
    let others = args.others.iter().map(|path| Side::read(path, budget)).collect::<Done<Vec<_>>>()?;
    let pairs: Vec<Pair<'_>> = others.iter().map(|other| first.against(other)).collect();
    if args.json {
        let mut list = pairs.iter().map(Pair::to_json).collect::<Done<Vec<Value>>>()?;
        let json = if pairs.len() == 1 { list.swap_remove(0) } else { list.into() };
        print(&format!("{json:#}\n"))?;
    } else {
        print(&text(&first, &others, &pairs))?;
    }
    if let Some(path) = &args.html {
        page(path, (&first, &others), &pairs)?;
    }
    let worst = pairs.iter().map(|pair| pair.comparison.worst_percent()).fold(0.0, f64::max);
    match args.fail_over {
        Some(limit) if worst > limit => Err(Failure::Bad(format!("grew worse by {worst} %, allowed {limit} %"))),
        _ => Ok(()),
    }
}

/// The same as a page, with the pictures that lie beside the reports.
fn page(path: &Path, (first, others): (&Side, &[Side]), pairs: &[Pair<'_>]) -> Done {
    let pairs = others.iter().zip(pairs).map(|(other, pair)| Ok((other.shown()?, &pair.comparison)));
    let page = compared(&first.shown()?, &pairs.collect::<Done<Vec<_>>>()?);
    PartialFile::write_whole(path, page.as_bytes()).map_err(Failure::file(path, "be written"))
}

fn text(first: &Side, others: &[Side], pairs: &[Pair<'_>]) -> String {
    if let [pair] = pairs {
        return pair.comparison.to_text(style());
    }
    let reports: Vec<_> = std::iter::once(first).chain(others).map(|side| (&*side.name, &side.report)).collect();
    let pairs = pairs.iter().map(|pair| format!("\nA: {}, B: {}\n{}", pair.a, pair.b, pair.comparison.to_text(style())));
    std::iter::once(overview(&reports, style())).chain(pairs).collect()
}

impl Pair<'_> {
    fn to_json(&self) -> Done<Value> {
        let mut json = serde_json::to_value(&self.comparison).map_err(Failure::bad)?;
        json["a"] = self.a.into();
        json["b"] = self.b.into();
        Ok(json)
    }
}

impl Side {
    fn read(path: &Path, budget: &Budget) -> Done<Self> {
        let file = if path.is_dir() { path.join(REPORT) } else { path.to_path_buf() };
        let (text, _held) = read_text(&file, budget)?;
        let name = file.display().to_string();
        // It is there to the end of the program.
        budget.take(json_weight(text.as_bytes()), "what a report says").map_err(Failure::within(&name))?.keep();
        let report = Report::from_json(&text).map_err(Failure::within(&name))?;
        // A report under another name is none that a run has left there.
        let tape = file.with_file_name(RUN_TAPE);
        let has_tape = file.ends_with(REPORT) && tape.exists();
        let taped = has_tape.then(|| read_tape(&report, &tape, budget)).transpose()?;
        let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
        Ok(Self { name: path.display().to_string(), report, folder, taped })
    }

    /// As a page shows it: with the picture of the last frame, where it lies beside the report.
    fn shown(&self) -> Done<html::Side<'_>> {
        let mut beside = page_assets(&self.report).map_err(Failure::within(&self.name))?;
        // A name alone: a report from elsewhere must not name files of ours.
        let name = self.report.image.last().map(|picture| Path::new(&picture.file));
        let name = name.filter(|name| name.file_name() == Some(name.as_os_str()));
        let file = name.map(|name| self.folder.join(name)).filter(|file| file.is_file());
        if let Some(file) = file {
            let png = fs::read(&file).map_err(Failure::file(&file, "be read"))?;
            beside.pictures = vec![PagePicture { caption: "The machine's picture".into(), png, largest: None }];
        }
        Ok(html::Side { name: &self.name, report: &self.report, beside })
    }

    fn against<'a>(&'a self, other: &'a Self) -> Pair<'a> {
        let explained = self.taped.as_ref().zip(other.taped.as_ref()).and_then(|(a, b)| explain(a, b));
        Pair { a: &self.name, b: &other.name, comparison: difference(&self.report, &other.report, explained) }
    }
}

fn read_tape(report: &Report, path: &Path, budget: &Budget) -> Done<RecordedRun> {
    RecordedRun::read(report, &mut open(path)?, budget).map_err(unreadable(&path.display().to_string()))
}
