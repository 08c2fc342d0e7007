//! Files of a run that show it over time: timeline, waveforms, token paths and memory requests.

use crate::error::{CommandError, CommandResult, PythonResult};
use crate::scene::RunSource;
use basrelief_kernel::Probe;
use basrelief_outputs::PartialFile;
use basrelief_sim::{
    ChartOutput, ChartOutputs, ChartRange, ChartRangeError, MemoryRequests, RequestFormat, RequestLog, RequestLogError,
    RunCharts, RunInput, RunOptions, RunResult, TokenSample, WriteSeek, logged_memories,
};
use basrelief_timeline::NamedOutput;
use pyo3::pybacked::PyBackedBytes;
use pyo3::{FromPyObject, Python, pyfunction};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

/// The outputs of a run over time, with the options of the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct OutputArguments {
    timeline: Option<PathBuf>,
    waves: Option<PathBuf>,
    tokens: Option<PathBuf>,
    tokens_every: u64,
    /// `fragments` or `polygons`.
    tokens_of: String,
    from_cycle: Option<u64>,
    to_cycle: Option<u64>,
    units: Vec<String>,
    requests: Option<PathBuf>,
    requests_format: String,
    requests_memory: Option<String>,
}

/// Options that make charts smaller.
const ADVICE: &str = "from_cycle, to_cycle, units or tokens_every";

impl OutputArguments {
    /// Returns the names of the requested outputs with their paths.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let charts = [("timeline", &self.timeline), ("waves", &self.waves), ("tokens", &self.tokens)];
        charts.into_iter().chain([("requests", &self.requests)]).filter_map(|(name, path)| Some((name, path.as_deref()?)))
    }

    /// Refuses two outputs in one file, an output in the file of the input, and options without their output.
    pub fn check(&self, source: &RunSource) -> CommandResult {
        let mut seen = BTreeMap::new();
        seen.extend(source.file().map(|path| (path.to_path_buf(), "the input")));
        for (name, path) in self.named() {
            let path = std::path::absolute(path).map_err(CommandError::at_file(path, "be written"))?;
            if let Some(other) = seen.insert(path.clone(), name) {
                return Err(CommandError::Usage(format!("{name}: {} is also {other}; expected another file", path.display())));
            }
        }
        let has_range = self.from_cycle.is_some() || self.to_cycle.is_some() || !self.units.is_empty();
        if has_range && self.named().all(|(name, _)| name == "requests") {
            return Err(CommandError::usage(
                "from_cycle, to_cycle, units: select a part of timeline, waves or tokens; add one of these",
            ));
        }
        Ok(())
    }

    fn sample(&self) -> CommandResult<TokenSample> {
        let every = NonZeroU64::new(self.tokens_every)
            .ok_or_else(|| CommandError::usage("tokens_every: 0; expected a whole number from 1 on"))?;
        let polygons = match self.tokens_of.as_str() {
            "fragments" => false,
            "polygons" => true,
            other => return Err(CommandError::usage(format_args!("tokens_of: `{other}`; expected fragments or polygons"))),
        };
        Ok(TokenSample { every, polygons })
    }

    /// Creates the chart files; `None` if there are none.
    pub fn charts(&self, input: &RunInput, options: &RunOptions) -> CommandResult<Option<ChartFiles>> {
        let sample = self.sample()?;
        if self.timeline.is_none() && self.waves.is_none() && self.tokens.is_none() {
            return Ok(None);
        }
        let (from, to) = (self.from_cycle.unwrap_or(0), self.to_cycle.unwrap_or(u64::MAX));
        let range = ChartRange { from, to, units: self.units.clone() };
        let charts = RunCharts::new(input, options, &range, ADVICE).map_err(range_error)?;
        let [timeline, waves, tokens] =
            [&self.timeline, &self.waves, &self.tokens].map(|path| path.as_deref().map(create).transpose());
        Ok(Some(ChartFiles { charts, timeline: timeline?, waves: waves?, tokens: tokens?, sample }))
    }

    /// Creates the file of memory requests; `None` if there is none.
    pub fn requests(&self, options: &RunOptions) -> CommandResult<Option<RequestsFile>> {
        let format = RequestFormat::ALL.iter().find(|(name, _)| *name == self.requests_format).map(|(_, format)| *format);
        let format = format.ok_or_else(|| {
            let (given, names) = (&self.requests_format, RequestFormat::ALL.map(|(name, _)| name).join(", "));
            CommandError::usage(format_args!("requests_format: `{given}`; expected {names}"))
        })?;
        let Some(path) = &self.requests else { return Ok(None) };
        let memories =
            logged_memories(&options.config, format, self.requests_memory.as_deref()).map_err(|error| match &error {
                RequestLogError::Config(_) => CommandError::bad_input(error),
                RequestLogError::SeveralMemories { names, .. } => CommandError::Usage(format!(
                    "requests_format: {}: {error}; choose one with requests_memory: {names}",
                    self.requests_format
                )),
                RequestLogError::UnknownMemory { .. } => CommandError::Usage(format!("requests_memory: {error}")),
            })?;
        let log = NamedOutput::new(create(path)?, path)
            .and_then(|out| RequestLog::new(out, format, memories, tempfile::tempfile))
            .map_err(CommandError::at_file(path, "be written"))?;
        Ok(Some(RequestsFile { path: path.clone(), log }))
    }
}

/// Converts an error in the selected units and cycles, with the options that select them.
fn range_error(error: ChartRangeError) -> CommandError {
    match error {
        ChartRangeError::Config(_) => CommandError::bad_input(error),
        ChartRangeError::Empty { from, to } => {
            CommandError::Usage(format!("from_cycle: {from} is not before to_cycle {to}; the timeline would be empty"))
        }
        ChartRangeError::Unit { .. } => CommandError::Usage(format!("units: {error}")),
    }
}

/// Writes a file that is complete or absent.
#[pyfunction]
pub fn write(py: Python<'_>, path: PathBuf, content: PyBackedBytes) -> PythonResult<()> {
    let written = py.detach(|| PartialFile::write_whole(&path, &content));
    Ok(written.map_err(CommandError::at_file(&path, "be written"))?)
}

fn create(path: &Path) -> CommandResult<PartialFile> {
    PartialFile::create(path).map_err(CommandError::at_file(path, "be written"))
}

fn publish(file: PartialFile) -> CommandResult {
    let failed = CommandError::at_file(file.path(), "be written");
    file.publish().map_err(failed)
}

/// Timeline, waveforms and token paths.
pub struct ChartFiles {
    charts: RunCharts,
    timeline: Option<PartialFile>,
    waves: Option<PartialFile>,
    tokens: Option<PartialFile>,
    sample: TokenSample,
}

impl ChartFiles {
    /// Writes the files during a run.
    pub fn record(&mut self, run: impl FnOnce(&mut dyn Probe) -> CommandResult<RunResult>) -> CommandResult<RunResult> {
        let Self { charts, timeline, waves, tokens, sample } = self;
        let tokens = tokens.as_mut().map(chart_output).transpose()?.map(|out| (out, *sample));
        let timeline = timeline.as_mut().map(chart_output).transpose()?;
        let waves = waves.as_mut().map(|file| -> ChartOutput<dyn WriteSeek + '_> { (shown(file), Box::new(file)) });
        charts.record(ChartOutputs { timeline, waves, tokens }, Box::new(run))
    }

    /// Publishes the files.
    pub fn publish(self) -> CommandResult {
        self.timeline.into_iter().chain(self.waves).chain(self.tokens).try_for_each(publish)
    }
}

fn shown(file: &PartialFile) -> String {
    file.path().display().to_string()
}

/// Opens the output of a chart, compressed if its name ends in .zst.
fn chart_output(file: &mut PartialFile) -> CommandResult<ChartOutput<dyn Write + '_>> {
    let path = file.path().to_path_buf();
    let out = NamedOutput::new(file, &path).map_err(CommandError::at_file(&path, "be written"))?;
    Ok((path.display().to_string(), Box::new(out)))
}

/// The file of memory requests.
pub struct RequestsFile {
    path: PathBuf,
    log: RequestLog<NamedOutput<PartialFile>, File>,
}

impl RequestsFile {
    /// Writes requests of a memory.
    pub fn write(&mut self, of: &MemoryRequests<'_>) -> Result<(), String> {
        self.log.write(of).map_err(|error| format!("{}: cannot be written: {error}", self.path.display()))
    }

    /// Completes and publishes the file.
    pub fn publish(self) -> CommandResult {
        let failed = CommandError::at_file(&self.path, "be written");
        publish(self.log.finish().and_then(NamedOutput::finish).map_err(failed)?)
    }
}
