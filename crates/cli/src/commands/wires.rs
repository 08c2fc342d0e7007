//! Log of the wires of a run, for the comparison with register-transfer code.

use super::timelines::{OutputFile, create, open_writer};
use crate::error::{CommandError, CommandResult};
use basrelief_kernel::Probe;
use basrelief_sim::{self as sim, RunInput, RunOptions, RunResult};
use basrelief_timeline::{TimelineLayout, WireLog};
use std::io::Write;
use std::path::PathBuf;

/// File of `--rtl`.
pub struct WireFile {
    file: OutputFile,
    layout: TimelineLayout,
    /// Configuration of the machine, as JSON.
    config: String,
}

impl WireFile {
    /// Creates the file.
    pub fn open(path: PathBuf, source: &RunInput, options: &RunOptions) -> CommandResult<Self> {
        let layout = sim::timeline_layout(source, options).map_err(CommandError::bad_input)?;
        Ok(Self { file: create(path)?, layout, config: options.config.to_value().to_string() })
    }

    /// Writes the file during a run.
    pub fn record_run(&mut self, run: impl FnOnce(&mut dyn Probe) -> CommandResult<RunResult>) -> CommandResult<RunResult> {
        let Self { file: (file, path), layout, config } = self;
        let mut out = open_writer(file, path)?;
        writeln!(out, "config {config}").map_err(CommandError::at_file(path, "be written"))?;
        let mut log = WireLog::new(out, layout);
        let run = run(&mut log)?;
        let total = run.timing.as_ref().map_or(0, |timing| timing.total);
        log.finish(total).map_err(CommandError::at_file(path, "be written"))?;
        Ok(run)
    }

    /// Publishes the file.
    pub fn publish(self) -> CommandResult {
        let (file, path) = self.file;
        file.publish().map_err(CommandError::at_file(&path, "be written"))
    }
}
