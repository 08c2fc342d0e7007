//! Timeline, waveforms and token file of a run.

use crate::args::{SimulationArgs, TokenKind};
use crate::error::{CommandError, CommandResult};
use crate::outputs::PartialFile;
use basrelief_kernel::Probe;
use basrelief_sim::{
    ChartOutput, ChartOutputs, ChartRange, ChartRangeError, RunCharts, RunInput, RunOptions, RunResult, TokenSample,
};
use basrelief_timeline::NamedOutput;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file and its final path.
pub type OutputFile = (PartialFile, PathBuf);

/// Timeline files of a run.
pub struct TimelineFiles {
    charts: RunCharts,
    timeline: Option<OutputFile>,
    waves: Option<OutputFile>,
    tokens: Option<OutputFile>,
    sample: TokenSample,
}

/// Options that make charts smaller.
const ADVICE: &str = "--from-cycle, --to-cycle, --units or --tokens-every";

impl TimelineFiles {
    /// Creates the requested files; `None` if there are none.
    pub fn open(simulation: &SimulationArgs, source: &RunInput, settings: &RunOptions) -> CommandResult<Option<Self>> {
        let SimulationArgs { timeline, waves, tokens, tokens_every, tokens_of, .. } = simulation;
        if timeline.is_none() && waves.is_none() && tokens.is_none() {
            return Ok(None);
        }
        let (from, to) = (simulation.from_cycle.unwrap_or(0), simulation.to_cycle.unwrap_or(u64::MAX));
        let range = ChartRange { from, to, units: simulation.units.clone() };
        let charts = RunCharts::new(source, settings, &range, ADVICE).map_err(range_error)?;
        let sample = TokenSample { every: *tokens_every, polygons: *tokens_of == TokenKind::Polygons };
        let [timeline, waves, tokens] = [timeline, waves, tokens].map(|path| path.clone().map(create).transpose());
        Ok(Some(Self { charts, timeline: timeline?, waves: waves?, tokens: tokens?, sample }))
    }

    /// Writes the files during a run.
    pub fn record_run(&mut self, run: impl FnOnce(&mut dyn Probe) -> CommandResult<RunResult>) -> CommandResult<RunResult> {
        let Self { charts, timeline, waves, tokens, sample } = self;
        let outputs = ChartOutputs {
            timeline: timeline.as_mut().map(chart_output).transpose()?,
            waves: waves.as_mut().map(|(file, path)| -> ChartOutput<dyn basrelief_sim::WriteSeek + '_> {
                (path.display().to_string(), Box::new(BufWriter::new(file)))
            }),
            tokens: tokens.as_mut().map(chart_output).transpose()?.map(|out| (out, *sample)),
        };
        charts.record(outputs, Box::new(run))
    }

    /// Publishes the files.
    pub fn publish(self) -> CommandResult {
        for (file, path) in self.timeline.into_iter().chain(self.waves).chain(self.tokens) {
            file.publish().map_err(CommandError::at_file(&path, "be written"))?;
        }
        Ok(())
    }
}

/// Opens a writer that compresses if the file name ends in .zst.
pub fn open_writer<'a>(file: &'a mut PartialFile, path: &Path) -> CommandResult<Box<dyn Write + 'a>> {
    let out = NamedOutput::new(file, path).map_err(CommandError::at_file(path, "be written"))?;
    Ok(Box::new(out))
}

/// Opens the output of a chart, compressed if its name ends in .zst.
fn chart_output((file, path): &mut OutputFile) -> CommandResult<ChartOutput<dyn Write + '_>> {
    Ok((path.display().to_string(), open_writer(file, path)?))
}

/// Creates an output file.
pub fn create(path: PathBuf) -> CommandResult<OutputFile> {
    let file = PartialFile::create(&path).map_err(CommandError::at_file(&path, "be written"))?;
    Ok((file, path))
}

/// Converts an error in the selected units and cycles, with the options that select them.
fn range_error(error: ChartRangeError) -> CommandError {
    match error {
        ChartRangeError::Config(_) => CommandError::bad_input(error),
        ChartRangeError::Empty { from, to } => {
            CommandError::Usage(format!("--from-cycle {from} is not before --to-cycle {to}; the timeline would be empty"))
        }
        ChartRangeError::Unit { .. } => CommandError::Usage(format!("--units: {error}")),
    }
}
