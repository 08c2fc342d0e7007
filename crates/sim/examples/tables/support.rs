//! What all tables need: inputs, runs, figures, rows.

use basrelief_report::Report;
use basrelief_report::model::Figure;
use basrelief_scene::{DEMOS, ViewOptions, demo, load_path};
use basrelief_signals::Scene;
use basrelief_sim::{MachineInfo, RunInput, RunOptions, Unobserved, run};
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

/// Parameters set, by key.
pub type Set<'a> = &'a [(&'a str, &'a str)];

/// A model that is not there.
#[derive(Debug, thiserror::Error)]
#[error("`{0}` is no demo scene and not in the folder of --models")]
pub struct Missing(String);

/// Where models are.
#[derive(Default)]
pub struct Inputs {
    /// Looked through with the folders in it.
    pub models: Option<PathBuf>,
}

impl Inputs {
    /// A demo scene, or a model, in so many frames of an orbit.
    ///
    /// # Errors
    /// A model that is not there or cannot be read.
    pub fn open(&self, name: &str, frames: u32) -> Result<Arc<Scene>, Box<dyn Error>> {
        let orbit_degrees = (frames > 1).then_some(360.0);
        let options = ViewOptions { frames: Some(frames), orbit_degrees, ..ViewOptions::default() };
        if DEMOS.iter().any(|d| Some(d.name) == name.split('@').next()) {
            return Ok(Arc::new(demo(name, &options)?));
        }
        let path = self.path_of(name).ok_or_else(|| Missing(name.to_owned()))?;
        Ok(Arc::new(load_path(&path, &options)?))
    }

    /// The file of this name in the folder, or in a folder of it that has its stem for a name.
    fn path_of(&self, name: &str) -> Option<PathBuf> {
        let folder = self.models.as_ref()?;
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        [folder.join(name), folder.join(stem).join(name)].into_iter().find(|path| path.is_file())
    }
}

/// Settings of a machine.
///
/// # Errors
/// A parameter that is none, or out of its range.
pub fn settings(machine: &str, set: Set<'_>, exact: bool) -> Result<RunOptions, Box<dyn Error>> {
    Ok(RunOptions { config: MachineInfo::named(machine)?.load("", set)?, exact, ..RunOptions::default() })
}

/// The report of a run.
///
/// # Errors
/// As the run.
pub fn report(scene: &Arc<Scene>, settings: &RunOptions) -> Result<Report, Box<dyn Error>> {
    Ok(run(RunInput::scene(Arc::clone(scene)), settings, &mut Unobserved, None)?.report)
}

/// Cycles of all frames.
pub fn cycles(report: &Report) -> u64 {
    report.frame_cycles()
}

/// Bytes that the clients for which `counts` holds moved, by memory and name.
pub fn bytes(report: &Report, counts: impl Fn(&str, &str) -> bool) -> u64 {
    let memories = report.memories.iter().flatten();
    let clients = memories.flat_map(|(memory, m)| m.clients.iter().map(move |(client, c)| (memory, client, c)));
    clients.filter(|(memory, client, _)| counts(memory, client)).map(|(.., c)| c.bytes()).sum()
}

/// A figure of the machine; 0 where it has none of this name.
pub fn figure(report: &Report, name: &str) -> f64 {
    match report.figures.get(name) {
        Some(Figure::Count(n)) => *n as f64,
        Some(Figure::Real(x)) => *x,
        _ => 0.0,
    }
}

/// A whole number in groups of three.
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

/// A table in Markdown: numbers to the right, what stands in the first `left` columns to the left.
pub struct Table(String);

impl Table {
    /// Its head.
    pub fn new(head: &[&str], left: usize) -> Self {
        let rule: Vec<&str> = (0..head.len()).map(|i| if i < left { "---" } else { "---:" }).collect();
        Self(format!("| {} |\n|{}|\n", head.join(" | "), rule.join("|")))
    }

    /// One more row.
    pub fn row(&mut self, cells: &[String]) {
        // Formatting into a string cannot fail.
        let _ = writeln!(self.0, "| {} |", cells.join(" | "));
    }

    /// As text.
    pub fn text(self) -> String {
        self.0
    }
}
