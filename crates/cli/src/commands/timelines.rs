//! Timeline, waveforms and token file of a run.

use crate::args::{SimulationArgs, TokenKind};
use crate::error::{CommandError, CommandResult};
use crate::outputs::PartialFile;
use basrelief_input::{MemoryPool, OverBudget};
use basrelief_kernel::Probe;
use basrelief_parameters::nearest;
use basrelief_sim::{self as sim, AttributionProbe, MachineConfig, RunInput, RunOptions, RunResult, TokenSample};
use basrelief_timeline::{FstWaves, KanataLog, PerfettoTrace, TimelineLayout, TimelineProbe, TraceSink};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file and its final path.
pub type OutputFile = (PartialFile, PathBuf);

/// Timeline files of a run.
pub struct TimelineFiles {
    board: TimelineLayout,
    config: MachineConfig,
    timeline: Option<OutputFile>,
    waves: Option<OutputFile>,
    tokens: Option<OutputFile>,
    sample: Option<TokenSample>,
    budget: MemoryPool,
}

impl TimelineFiles {
    /// Creates the requested files; `None` if there are none.
    pub fn open(simulation: &SimulationArgs, source: &RunInput, settings: &RunOptions) -> CommandResult<Option<Self>> {
        let SimulationArgs { timeline, waves, tokens, tokens_every, tokens_of, .. } = simulation;
        if timeline.is_none() && waves.is_none() && tokens.is_none() {
            return Ok(None);
        }
        let board = sim::timeline_layout(source, settings).map_err(CommandError::bad_input)?;
        let board = select_range(board, simulation)?;
        let sample = TokenSample { every: *tokens_every, polygons: *tokens_of == TokenKind::Polygons };
        let sample = tokens.as_ref().map(|_| sample);
        let [timeline, waves, tokens] = [timeline, waves, tokens].map(|path| path.clone().map(create).transpose());
        let (config, budget) = (settings.config.clone(), settings.budget.clone());
        Ok(Some(Self { board, config, timeline: timeline?, waves: waves?, tokens: tokens?, sample, budget }))
    }

    /// Writes the files during a run.
    pub fn record_run(&mut self, run: impl FnOnce(&mut dyn Probe) -> CommandResult<RunResult>) -> CommandResult<RunResult> {
        let Self { board, config, timeline, waves, tokens, sample, budget } = self;
        let stages = &board.diagram.stages;
        // Waveforms need no attribution.
        let follows = timeline.is_some() || tokens.is_some();
        let mut charts: Vec<(Box<dyn TraceSink + '_>, &Path)> = vec![];
        if let Some((file, path)) = timeline {
            charts.push((Box::new(PerfettoTrace::new(BufWriter::new(file), board)), path));
        }
        if let Some((file, path)) = waves {
            charts.push((Box::new(FstWaves::new(BufWriter::new(file), board, budget)), path));
        }
        if let (Some((file, path)), Some(sample)) = (tokens, *sample) {
            let last = sim::last_stage(sample, config, stages);
            charts.push((Box::new(KanataLog::new(open_writer(file, path)?, board, last, budget)), path));
        }
        let (charts, paths): (Vec<_>, Vec<_>) = charts.into_iter().unzip();
        let mut watcher = TimelineProbe::new(board.clone(), charts);
        let run = if follows {
            let mut following = AttributionProbe::new(config, stages, *sample, budget, &mut watcher);
            let run = run(&mut following)?;
            following.finish().map_err(|over| CommandError::BadInput(with_advice(&over)))?;
            run
        } else {
            run(&mut watcher)?
        };
        if let Some(timing) = &run.timing {
            for (finished, path) in watcher.finish(timing).into_iter().zip(paths) {
                finished.map_err(|error| write_error(path, error))?;
            }
        }
        Ok(run)
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
    if path.extension().is_none_or(|extension| extension != "zst") {
        return Ok(Box::new(BufWriter::new(file)));
    }
    let encoder = zstd::Encoder::new(file, zstd::DEFAULT_COMPRESSION_LEVEL).map_err(CommandError::at_file(path, "be written"))?;
    Ok(Box::new(BufWriter::new(CompressedFile(encoder))))
}

/// A compressed file that ends when flushed. Charts flush once, and report errors.
struct CompressedFile<'a>(zstd::Encoder<'static, &'a mut PartialFile>);

impl Write for CompressedFile<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.do_finish()?;
        self.0.get_mut().flush()
    }
}

/// Converts a write error. Charts stay in memory until the end of the run, so the message names options for smaller charts.
fn write_error(path: &Path, error: io::Error) -> CommandError {
    match OverBudget::in_io_error(&error) {
        Some(over) => CommandError::BadInput(format!("{}: {}", path.display(), with_advice(over))),
        None => CommandError::at_file(path, "be written")(error),
    }
}

fn with_advice(over: &OverBudget) -> String {
    format!("{over}; or write less, with --from-cycle, --to-cycle, --units or --tokens-every")
}

/// Creates an output file.
pub fn create(path: PathBuf) -> CommandResult<OutputFile> {
    let file = PartialFile::create(&path).map_err(CommandError::at_file(&path, "be written"))?;
    Ok((file, path))
}

/// Selects units and cycles by `--units`, `--from-cycle` and `--to-cycle`.
fn select_range(mut board: TimelineLayout, simulation: &SimulationArgs) -> CommandResult<TimelineLayout> {
    board.from = simulation.from_cycle.unwrap_or(0);
    board.to = simulation.to_cycle.unwrap_or(u64::MAX);
    if board.from >= board.to {
        let (from, to) = (board.from, board.to);
        return Err(CommandError::Usage(format!(
            "--from-cycle {from} is not before --to-cycle {to}; the timeline would be empty"
        )));
    }
    if !simulation.units.is_empty()
        && let Err(unknown) = board.show_only(&simulation.units)
    {
        return Err(CommandError::Usage(no_unit(unknown, &board)));
    }
    Ok(board)
}

fn no_unit(unknown: &str, board: &TimelineLayout) -> String {
    let names: Vec<&str> = board.diagram.stages.iter().map(|stage| stage.name.as_str()).collect();
    let hint = nearest(unknown, names.iter().copied()).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
    format!("--units: no unit of {} is called `{unknown}`{hint} (there are {})", board.machine, names.join(", "))
}
