//! Shared code of all tables: inputs, runs, figures and rows.

use basrelief_report::Report;
use basrelief_report::model::Figure;
use basrelief_scene::{DEMOS, ViewOptions, demo, load_path};
use basrelief_signals::Scene;
use basrelief_sim::{MachineInfo, NoObserver, RunInput, RunOptions, run};
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

/// Parameters set, by key.
pub type Set<'a> = &'a [(&'a str, &'a str)];

/// A missing model.
#[derive(Debug, thiserror::Error)]
#[error("`{0}` is no demo scene and not in the folder of --models")]
pub struct Missing(String);

/// Folder of models.
#[derive(Default)]
pub struct Inputs {
    /// Folder, searched with its subfolders.
    pub models: Option<PathBuf>,
}

impl Inputs {
    /// Loads a demo scene or a model, with `frames` frames of an orbit.
    ///
    /// # Errors
    /// A model that is missing or cannot be read.
    pub fn open(&self, name: &str, frames: u32) -> Result<Arc<Scene>, Box<dyn Error>> {
        let orbit_degrees = (frames > 1).then_some(360.0);
        let options = ViewOptions { frames: Some(frames), orbit_degrees, ..ViewOptions::default() };
        if DEMOS.iter().any(|d| Some(d.name) == name.split('@').next()) {
            return Ok(Arc::new(demo(name, &options)?));
        }
        let path = self.path_of(name).ok_or_else(|| Missing(name.to_owned()))?;
        Ok(Arc::new(load_path(&path, &options)?))
    }

    /// Finds the file of this name in the folder, or in the subfolder named like its stem.
    fn path_of(&self, name: &str) -> Option<PathBuf> {
        let folder = self.models.as_ref()?;
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        [folder.join(name), folder.join(stem).join(name)].into_iter().find(|path| path.is_file())
    }
}

/// Loads a machine with settings.
///
/// # Errors
/// Unknown parameters, and values out of range.
pub fn settings(machine: &str, set: Set<'_>, exact: bool) -> Result<RunOptions, Box<dyn Error>> {
    Ok(RunOptions { config: MachineInfo::named(machine)?.load("", set)?, exact, ..RunOptions::default() })
}

/// Returns the report of a run.
///
/// # Errors
/// Errors of the run.
pub fn report(scene: &Arc<Scene>, settings: &RunOptions) -> Result<Report, Box<dyn Error>> {
    Ok(run(RunInput::scene(Arc::clone(scene)), settings, &mut NoObserver, None)?.report)
}

/// Returns the render cycles of all frames.
pub fn cycles(report: &Report) -> u64 {
    report.frame_cycles()
}

/// Returns the bytes that all clients moved, for which `counts` is true.
pub fn bytes(report: &Report, counts: impl Fn(&str, &str) -> bool) -> u64 {
    let memories = report.memories.iter().flatten();
    let clients = memories.flat_map(|(memory, m)| m.clients.iter().map(move |(client, c)| (memory, client, c)));
    clients.filter(|(memory, client, _)| counts(memory, client)).map(|(.., c)| c.moved_bytes).sum()
}

/// Returns a figure of the machine; 0 if there is none of this name.
pub fn figure(report: &Report, name: &str) -> f64 {
    match report.figures.get(name) {
        Some(Figure::Count(n)) => *n as f64,
        Some(Figure::Real(x)) => *x,
        _ => 0.0,
    }
}

/// Formats an integer with thousands separators.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Markdown table. The first `left` columns are left-aligned, numbers are right-aligned.
pub struct Table(String);

impl Table {
    /// Creates a table with this header.
    pub fn new(head: &[&str], left: usize) -> Self {
        let rule: Vec<&str> = (0..head.len()).map(|i| if i < left { "---" } else { "---:" }).collect();
        Self(format!("| {} |\n|{}|\n", head.join(" | "), rule.join("|")))
    }

    /// Adds a row.
    pub fn row(&mut self, cells: &[String]) {
        // Formatting into a string cannot fail.
        let _ = writeln!(self.0, "| {} |", cells.join(" | "));
    }

    /// Returns the Markdown text.
    pub fn text(self) -> String {
        self.0
    }
}
