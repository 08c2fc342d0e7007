//! Resimulation: computes the timing of a recording under other timing parameters.

use super::error::RecordingError;
use super::format::header;
use super::kept::KeptSteps;
use super::loaded::{LoadedRecording, config_error, of_build, recorded_spec};
use super::reader::{BlockReader, ChunkReader, checked_end};
use crate::analysis::bottleneck::CompletedRun;
use crate::build::build_warning;
use crate::observer::{NoObserver, Observer};
use crate::options::{AnalysisPolicy, Overrides};
use crate::run::untimed::UntimedResult;
use basrelief_input::MemoryPool;
use basrelief_kernel::stats::FigureValue;
use basrelief_kernel::{self as kernel, Netlist, Outcome, RunReport};
use basrelief_machines::{InputKind, MachineConfig, MachineSpec, for_machine};
use basrelief_parameters::Effect;
use basrelief_report::Report;
use std::io::Read;

/// Options of a resimulation.
#[derive(Clone, Debug)]
pub struct ResimulateOptions {
    /// Settings over the parameters of the recorded run, as in `--set`.
    pub settings: Vec<(String, String)>,
    /// As in [`RunOptions`](crate::RunOptions::bottlenecks).
    pub bottlenecks: AnalysisPolicy,
    /// Monotonic clock \[s\] for the host figures, as in [`RunOptions`](crate::RunOptions::clock).
    pub clock: fn() -> f64,
    /// Memory pool for the recorded steps.
    pub budget: MemoryPool,
}

impl Default for ResimulateOptions {
    /// No settings and no bottleneck analysis, without a clock, and with its own memory pool.
    fn default() -> Self {
        Self { settings: vec![], bottlenecks: AnalysisPolicy::Never, clock: || 0.0, budget: MemoryPool::default() }
    }
}

/// Result of a resimulation.
#[derive(Debug)]
pub struct ResimulationResult {
    /// The report, without host figures.
    pub report: Report,
    /// Time of reading and resimulating the recording on the host, without bottleneck analysis \[s\].
    pub simulate_s: f64,
}

impl ResimulationResult {
    /// Returns the report with the host figures. `wall_s` is the total time \[s\].
    pub fn with_host(self, wall_s: f64) -> Report {
        self.report.with_host(wall_s, self.simulate_s)
    }
}

/// Returns the report of a run with the recorded work and the given timing parameters. Needs neither the scene nor the units.
///
/// # Errors
/// See [`RecordingError`].
pub fn resimulate(reader: &mut dyn Read, options: &ResimulateOptions) -> Result<Report, RecordingError> {
    resimulate_to(reader, options, &mut NoObserver).map(|result| result.report)
}

/// Like [`resimulate`]. Also measures the time, and passes the recording of the resimulated run to the observer.
///
/// # Errors
/// See [`RecordingError`].
pub fn resimulate_to(
    reader: &mut dyn Read,
    options: &ResimulateOptions,
    observer: &mut dyn Observer,
) -> Result<ResimulationResult, RecordingError> {
    let mut blocks = BlockReader::new(reader, &options.budget);
    let (header, machine) = blocks.header()?;
    let table = machine.parameters();
    let changes_work = |key: &str| table.iter().any(|p| p.key == key && p.effect == Effect::Work);
    if let Some((key, _)) = options.settings.iter().find(|(key, _)| changes_work(key)) {
        return Err(RecordingError::Work(key.clone()));
    }
    let recorded = header.overrides.config(machine, &[]).map_err(|error| of_build(&header.build, config_error(error)))?;
    let mut overrides = header.overrides;
    overrides.settings.extend(options.settings.iter().cloned());
    let config = overrides.config(machine, &[]).map_err(config_error)?;
    let (build, input) = (header.build, header.input);
    let resimulation = Resimulation { build, recorded, overrides, input, blocks, options, observer };
    for_machine!(&config, spec => resimulation.report(spec))
}

struct Resimulation<'a> {
    /// Build that executed the steps.
    build: String,
    recorded: MachineConfig,
    overrides: Overrides,
    input: InputKind,
    blocks: BlockReader<'a>,
    options: &'a ResimulateOptions,
    observer: &'a mut dyn Observer,
}

impl Resimulation<'_> {
    fn report<S: MachineSpec>(self, spec: &S) -> Result<ResimulationResult, RecordingError> {
        let Self { build, recorded, overrides, input, blocks, options, observer } = self;
        let netlist = netlist_of_same_work(recorded_spec(&recorded)?, spec, input)?;
        let mut chunks = ChunkReader::new(blocks, Some(observer), KeptSteps::new(options.bottlenecks, &options.budget));
        chunks.begin_copy(header::<S>(&build, input, &overrides))?;
        let began = (options.clock)();
        let timed = kernel::resimulate(netlist, &mut |waiting| chunks.next(waiting), u64::MAX);
        // Reads to the end, which contains the untimed result.
        while timed.is_ok() && chunks.next(0).is_ok_and(|chunk| chunk.is_some()) {}
        let simulate_s = (options.clock)() - began;
        let ChunkReader { work, kept, end, error, .. } = chunks;
        if let Some(error) = error {
            return Err(error);
        }
        let run = timed.map_err(|error| of_build(&build, error.into()))?;
        ensure_complete(&run)?;
        let mut end = checked_end(end, work)?;
        end.result.warnings.extend(build_warning(&build));
        let mut report = TimedRun { spec, input, run: &run }.report(end.result, &end.figures)?;
        if let Some(chunks) = kept.as_ref().and_then(KeptSteps::chunks) {
            let (overrides, room) = (&overrides, options.budget.left());
            let completed = CompletedRun { spec, overrides, input, chunks, room, run: &run, groups: &[] };
            if let Some(bottlenecks) = completed.bottlenecks() {
                bottlenecks.add_to(&mut report);
            }
        }
        Ok(ResimulationResult { report, simulate_s })
    }
}

/// The timing of a completed run.
pub(super) struct TimedRun<'a, S> {
    pub(super) spec: &'a S,
    pub(super) input: InputKind,
    pub(super) run: &'a RunReport,
}

impl<S: MachineSpec> TimedRun<'_, S> {
    /// Returns the report, with the untimed result and the statistics of the recorded run.
    pub(super) fn report(&self, result: UntimedResult, figures: &[(String, FigureValue)]) -> Result<Report, RecordingError> {
        let mut facts = self.input.facts(self.spec).map_err(config_error)?;
        facts.put(figures);
        Ok(result.report(self.spec, facts, Some(self.run)))
    }
}

/// Returns an error if the run did not finish, because its pictures and counts would then be different.
pub(super) fn ensure_complete(run: &RunReport) -> Result<(), RecordingError> {
    match &run.outcome {
        Outcome::Complete => Ok(()),
        Outcome::Deadlock(deadlock) => Err(RecordingError::Incomplete(deadlock.to_string())),
        other => Err(RecordingError::Incomplete(format!("{other:?}"))),
    }
}

/// Returns the netlist of `spec` if it does the same work as `recorded`: netlists and hardware of the units are compared.
pub(crate) fn netlist_of_same_work<S: MachineSpec>(recorded: &S, spec: &S, input: InputKind) -> Result<Netlist, RecordingError> {
    if recorded.acts_at_times() {
        return Err(RecordingError::ActsAtTimes);
    }
    if spec.acts_at_times() {
        return Err(RecordingError::OtherWork("its user acts at times".into()));
    }
    let netlist = input.shape(spec).map_err(config_error)?;
    input.shape(recorded).map_err(config_error)?.same_work(&netlist).map_err(RecordingError::OtherWork)?;
    let of_units = |spec: &S| input.facts(spec).map(|facts| facts.hardware_of_units().cloned().collect::<Vec<_>>());
    if of_units(recorded).map_err(config_error)? != of_units(spec).map_err(config_error)? {
        return Err(RecordingError::OtherWork("its units consist of other hardware".into()));
    }
    Ok(netlist)
}

/// Returns the render cycles of a recording with these parameters; `None` if the machine would do other work or would not finish.
pub(crate) fn resimulated_cycles(recording: &LoadedRecording, config: &MachineConfig) -> Option<u64> {
    for_machine!(config, spec => cycles_with(recording, spec))
}

fn cycles_with<S: MachineSpec>(recording: &LoadedRecording, spec: &S) -> Option<u64> {
    let netlist = netlist_of_same_work(recording.config.spec()?, spec, recording.input).ok()?;
    recording.recording.cycles(netlist).ok()?
}
