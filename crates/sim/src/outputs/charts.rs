//! Timeline, waveforms and token paths of a run, written during the run.

use crate::analysis::attribution::{AttributionProbe, TokenSample, last_stage};
use crate::command_error::{CommandError, CommandResult};
use crate::options::{RunInput, RunOptions};
use crate::run::result::RunResult;
use crate::run::timeline_layout;
use basrelief_input::{MemoryPool, OverBudget};
use basrelief_kernel::Probe;
use basrelief_machines::{ConfigProblem, MachineConfig};
use basrelief_parameters::nearest;
use basrelief_report::number::thousands;
use basrelief_timeline::{FstWaves, KanataLog, PerfettoTrace, TimelineLayout, TimelineProbe, TraceSink};
use std::io::{self, Seek, Write};
use std::num::NonZeroU64;

/// Part of a run that its charts show.
#[derive(Clone, Debug)]
pub struct ChartRange {
    /// First cycle.
    pub from: u64,
    /// End \[cycle, exclusive\].
    pub to: u64,
    /// Units, shown with their FIFOs and memories; all if empty.
    pub units: Vec<String>,
}

/// Error in the selected part of a run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChartRangeError {
    /// The parameters do not fit together.
    #[error(transparent)]
    Config(ConfigProblem),
    /// The first cycle is not before the end.
    #[error("cycle {from} is not before cycle {to}; the timeline would be empty")]
    Empty {
        /// First cycle.
        from: u64,
        /// End.
        to: u64,
    },
    /// The machine has no such unit.
    #[error("no unit of {machine} is called `{name}`{hint} (there are {units})")]
    Unit {
        /// Name of the machine.
        machine: String,
        /// Unknown name.
        name: String,
        /// The nearest name, as the end of a sentence; may be empty.
        hint: String,
        /// Names of all units.
        units: String,
    },
}

/// Tokens that the flows of a timeline follow, unless the tokens of a token file are.
const FLOWS: TokenSample = TokenSample { every: NonZeroU64::new(64).unwrap(), polygons: false };

/// Output that can be written at any place.
pub trait WriteSeek: Write + Seek {}
impl<W: Write + Seek> WriteSeek for W {}

/// Output of a chart, and its name for messages.
pub type ChartOutput<W> = (String, Box<W>);

/// A run that calls a probe. It stands behind a pointer, so that the charts are compiled here and not in every program.
pub type ProbedRun<'a> = Box<dyn FnOnce(&mut dyn Probe) -> CommandResult<RunResult> + 'a>;

/// Outputs of the charts of a run. Each is flushed once, at its end.
#[derive(Default)]
pub struct ChartOutputs<'a> {
    /// Takes the timeline for Perfetto.
    pub timeline: Option<ChartOutput<dyn Write + 'a>>,
    /// Takes the waveforms, as FST.
    pub waves: Option<ChartOutput<dyn WriteSeek + 'a>>,
    /// Takes the paths of single tokens, as Kanata.
    pub tokens: Option<(ChartOutput<dyn Write + 'a>, TokenSample)>,
}

/// Charts of a run: the shown part, and the memory for events that wait until the end.
#[derive(Clone, Debug)]
pub struct RunCharts {
    layout: TimelineLayout,
    config: MachineConfig,
    budget: MemoryPool,
    /// Options that make charts smaller, as an error message names them.
    advice: &'static str,
}

impl RunCharts {
    /// Selects a part of a run. `advice` lists the options that make charts smaller.
    ///
    /// # Errors
    /// An empty part, an unknown unit, and parameters that do not fit together.
    pub fn new(
        input: &RunInput,
        options: &RunOptions,
        range: &ChartRange,
        advice: &'static str,
    ) -> Result<Self, ChartRangeError> {
        let mut layout = timeline_layout(input, options).map_err(ChartRangeError::Config)?;
        (layout.from, layout.to) = (range.from, range.to);
        if layout.from >= layout.to {
            return Err(ChartRangeError::Empty { from: range.from, to: range.to });
        }
        if !range.units.is_empty()
            && let Err(unknown) = layout.show_only(&range.units)
        {
            return Err(no_unit(unknown, &layout));
        }
        Ok(Self { layout, config: options.config.clone(), budget: options.budget.clone(), advice })
    }

    /// Writes the charts during a run.
    ///
    /// # Errors
    /// Errors of `run`, outputs that cannot be written, and charts beyond the memory limit.
    pub fn record(&self, outputs: ChartOutputs<'_>, run: ProbedRun<'_>) -> CommandResult<RunResult> {
        let Self { layout, config, budget, .. } = self;
        let stages = &layout.diagram.stages;
        let ChartOutputs { timeline, waves, tokens } = outputs;
        // Waveforms need no attribution.
        let follows = timeline.is_some() || tokens.is_some();
        let sample = tokens.as_ref().map(|(_, sample)| *sample).or(timeline.is_some().then_some(FLOWS));
        let mut charts: Vec<(Box<dyn TraceSink + '_>, String)> = vec![];
        if let Some((name, out)) = timeline {
            charts.push((Box::new(PerfettoTrace::new(out, layout)), name));
        }
        if let Some((name, out)) = waves {
            charts.push((Box::new(FstWaves::new(out, layout, budget)), name));
        }
        if let Some(((name, out), sample)) = tokens {
            charts.push((Box::new(KanataLog::new(out, layout, last_stage(sample, config, stages), budget)), name));
        }
        let (charts, names): (Vec<_>, Vec<_>) = charts.into_iter().unzip();
        let mut watcher = TimelineProbe::new(layout.clone(), charts);
        let mut run = if follows {
            let mut following = AttributionProbe::new(config, stages, sample, budget, &mut watcher);
            let run = run(&mut following)?;
            following.finish().map_err(|over| CommandError::BadInput(self.with_advice(&over)))?;
            run
        } else {
            run(&mut watcher)?
        };
        if let Some(timing) = &run.timing {
            for (finished, name) in watcher.finish(timing).into_iter().zip(names) {
                finished.map_err(|error| self.write_error(&name, &error))?;
            }
            run.report.warnings.extend(self.late_start(timing.total));
        }
        Ok(run)
    }

    /// Warns if a run of `total` cycles ends before the first cycle.
    fn late_start(&self, total: u64) -> Option<String> {
        let from = self.layout.from;
        (from >= total).then(|| {
            let [from, total] = [from, total].map(thousands);
            format!("timelines, waveforms and token files are empty: they start at cycle {from}, but the run has {total} cycles; choose an earlier first cycle")
        })
    }

    /// Converts a write error. Some charts stay in memory until the end of the run, so the message names options for smaller charts.
    fn write_error(&self, name: &str, error: &io::Error) -> CommandError {
        match OverBudget::in_io_error(error) {
            Some(over) => CommandError::BadInput(format!("{name}: {}", self.with_advice(over))),
            None => CommandError::BadInput(format!("{name}: cannot be written: {error}")),
        }
    }

    fn with_advice(&self, over: &OverBudget) -> String {
        format!("{over}; or write less, with {}", self.advice)
    }
}

fn no_unit(unknown: &str, layout: &TimelineLayout) -> ChartRangeError {
    let names: Vec<&str> = layout.diagram.stages.iter().map(|stage| stage.name.as_str()).collect();
    ChartRangeError::Unit {
        machine: layout.machine.clone(),
        name: unknown.into(),
        hint: nearest(unknown, names.iter().copied()).map_or_else(String::new, |name| format!("; did you mean `{name}`?")),
        units: names.join(", "),
    }
}
