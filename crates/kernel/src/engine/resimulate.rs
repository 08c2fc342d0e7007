//! Resimulation: the timed engine, with steps from a recording instead of units.

use super::arity::{advance, run_stored_steps};
use super::step_source::StepSource;
use super::timed::RunAhead;
use crate::netlist::Netlist;
use crate::probe::NoProbe;
use crate::recording::{RecordingChunk, RecordingError, RecordingReader};
use crate::report::RunReport;
use crate::step_requests::StepRequestsView;
use crate::time::{
    FifoMemory, FinalUnitState, InputMask, MachineTiming, PathTracer, StageArity, StageVisit, StepTiming, StopReason,
};
use crate::{CriticalPath, Cycle, Demand, MemoryPorts, Outcome, Probe, StageGroups};
use std::borrow::Cow;
use std::fmt;

/// The reason that a recording cannot be resimulated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ResimulateError {
    /// The recording is invalid.
    Recording(RecordingError),
    /// It is a recording of another machine.
    Stages {
        /// Stages of the recording.
        found: usize,
        /// Stages of the machine.
        expected: usize,
    },
    /// A stage can continue, but the recorded run ended earlier.
    EndsEarly(String),
    /// A step does something that its stage cannot do.
    Fault(String),
    /// The recording could not be read.
    Read(String),
}

impl fmt::Display for ResimulateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Recording(error) => error.fmt(f),
            Self::Stages { found, expected } => write!(f, "the recording has {found} stages, but the machine has {expected}"),
            Self::EndsEarly(stage) => write!(
                f,
                "under these parameters `{stage}` continues beyond the recorded run: record a complete run, or one that goes as far"
            ),
            Self::Fault(text) | Self::Read(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for ResimulateError {}

impl From<RecordingError> for ResimulateError {
    fn from(error: RecordingError) -> Self {
        Self::Recording(error)
    }
}

/// Returns the chunks of a recording in order and `None` after the last, or an error text if it cannot be read. The argument is
/// the number of bytes of earlier chunks that are not timed yet.
pub type ChunkSource<'a, 'f> = dyn FnMut(usize) -> Result<Option<Cow<'f, RecordingChunk>>, String> + 'a;

/// Recorded steps of a stage. With `TRACED` a [`PathTracer`] keeps them. It is a constant, because a tracer that is called in each step
/// takes twice the instructions, and because steps without it are not slowed down.
struct StoredSteps<'a, const TRACED: bool>(&'a mut RecordingReader);

impl<const TRACED: bool> StepSource for StoredSteps<'_, TRACED> {
    type Declared = ();

    #[inline]
    fn next(&self) -> ((), InputMask) {
        ((), self.0.next_inputs())
    }

    #[inline]
    fn has_step(&self) -> bool {
        self.0.has_step()
    }

    #[inline]
    fn step(&mut self, (): (), _: &mut MemoryPorts) -> StepTiming {
        self.0.step()
    }

    #[inline]
    fn is_silent(&self, _: &MemoryPorts) -> bool {
        self.0.is_silent()
    }

    #[inline]
    fn requests<'a>(&'a mut self, traffic: &'a mut MemoryPorts, _: &mut StageVisit<'_>) -> Option<StepRequestsView<'a>> {
        self.0.next_requests(traffic)
    }

    #[inline(always)]
    fn trace<K: StageArity>(
        path: &mut Option<PathTracer>,
        visit: &StageVisit<'_>,
        start: Cycle,
        takes: InputMask,
        is_marked: bool,
    ) {
        if TRACED && let Some(path) = path {
            path.step::<K>(visit, start, takes, is_marked);
        }
    }

    #[inline]
    fn go_on(&mut self, _: &mut MemoryPorts) {
        self.0.go_on();
    }
}

/// Advances a stage of a resimulation.
pub(super) fn advance_stored<const TRACED: bool, P: Probe>(
    walk: &mut RunAhead<'_, P>,
    stage: usize,
    reader: &mut RecordingReader,
) {
    advance(walk, stage, &mut StoredSteps::<TRACED>(reader));
}

/// Computes the timing of a recording on a machine with this netlist. Returns the report that a run of the machine gives.
///
/// The recording must come from the same machine with the same [work](Netlist::same_work).
///
/// # Errors
/// See [`ResimulateError`].
pub fn resimulate(shape: Netlist, chunks: &mut ChunkSource<'_, '_>, max_cycles: u64) -> Result<RunReport, ResimulateError> {
    resimulate_with(shape, chunks, &mut NoProbe, max_cycles)
}

/// As [`resimulate`], under a probe.
///
/// # Errors
/// See [`ResimulateError`].
pub fn resimulate_with<P: Probe>(
    shape: Netlist,
    chunks: &mut ChunkSource<'_, '_>,
    probe: &mut P,
    max_cycles: u64,
) -> Result<RunReport, ResimulateError> {
    let readers = new_readers(&shape);
    let memory = &mut ResimulationMemory::default();
    let task = ResimulationTask { goal: ResimulationGoal::Report, max_cycles, memory };
    Ok(timed_again(shape, readers, chunks, probe, task, advance_stored::<false, P>)?.0)
}

/// Resimulates a recording and finds its critical path. It keeps about 50 bytes per step and 40 per request. Returns `None` if there are
/// more than `most_steps` steps or the run is not complete. `groups`: groups of the steps of each stage; may be empty.
///
/// # Errors
/// See [`ResimulateError`].
pub fn critical_path(
    shape: Netlist,
    chunks: &mut ChunkSource<'_, '_>,
    most_steps: usize,
    groups: &[StageGroups],
) -> Result<Option<CriticalPath>, ResimulateError> {
    let readers = new_readers(&shape);
    let memory = &mut ResimulationMemory::default();
    let task = ResimulationTask { goal: ResimulationGoal::Path { most_steps, groups }, max_cycles: u64::MAX, memory };
    Ok(timed_again(shape, readers, chunks, &mut NoProbe, task, advance_stored::<true, NoProbe>)?.1)
}

pub(super) fn new_readers(shape: &Netlist) -> Vec<RecordingReader> {
    shape.stages.iter().map(|stage| RecordingReader::new(stage, &shape.memories)).collect()
}

/// Memory of the steps of a critical path, and of FIFOs, for one resimulation after the other. New memory for each caused most page faults
/// of bottleneck analysis.
#[derive(Debug, Default)]
pub struct ResimulationMemory {
    tracer: PathTracer,
    fifos: Vec<FifoMemory>,
}

/// The result that a resimulation computes.
pub(super) enum ResimulationGoal<'a> {
    /// Only the cycles.
    Cycles,
    /// The whole report.
    Report,
    /// The critical path of so many steps at most, with these groups.
    Path { most_steps: usize, groups: &'a [StageGroups] },
}

impl<'a> ResimulationGoal<'a> {
    /// Prepares time and readers. Returns the tracer of the critical path, in the memory of an earlier one.
    fn begin(&self, time: &mut MachineTiming, readers: &mut [RecordingReader], memory: &mut PathTracer) -> Option<PathTracer> {
        match self {
            Self::Report => return None,
            Self::Cycles => time.forget_awaits(),
            Self::Path { .. } => readers.iter_mut().for_each(|reader| reader.keep_steps(true)),
        }
        time.account_for_nothing();
        let &Self::Path { most_steps, .. } = self else { return None };
        Some(std::mem::take(memory).begin(time, most_steps))
    }

    fn groups(&self) -> &'a [StageGroups] {
        match self {
            Self::Path { groups, .. } => groups,
            Self::Report | Self::Cycles => &[],
        }
    }
}

/// A resimulation to do.
pub(super) struct ResimulationTask<'a> {
    pub(super) goal: ResimulationGoal<'a>,
    /// No step starts in this cycle or later.
    pub(super) max_cycles: u64,
    pub(super) memory: &'a mut ResimulationMemory,
}

/// Returns the report, and the critical path if it is the goal. `advance`: [`advance_stored`].
pub(super) fn timed_again<P: Probe>(
    shape: Netlist,
    mut readers: Vec<RecordingReader>,
    chunks: &mut ChunkSource<'_, '_>,
    probe: &mut P,
    ResimulationTask { goal, max_cycles, memory }: ResimulationTask<'_>,
    advance: impl Fn(&mut RunAhead<'_, P>, usize, &mut RecordingReader),
) -> Result<(RunReport, Option<CriticalPath>), ResimulateError> {
    let mut time = MachineTiming::in_memory(shape, std::mem::take(&mut memory.fifos));
    time.keep_fills(&*probe);
    if readers.iter().any(|reader| reader.demand().is_none()) {
        feed(&mut readers, chunks, &time)?;
    }
    let path = goal.begin(&mut time, &mut readers, &mut memory.tracer);
    let mut walk = RunAhead::new(&mut time, probe, max_cycles, None);
    walk.round.path = path;
    run_stored_steps(&mut walk, &mut readers, advance, after_round, |time, readers| feed(readers, chunks, time))?;
    let halt = if walk.round.limited { StopReason::Limit(max_cycles) } else { StopReason::Quiet };
    let path = walk.round.path;
    time.land_all();
    let rest = |reader: &RecordingReader| FinalUnitState {
        demand: reader.demand().unwrap_or(Demand::Finished),
        empty: reader.is_empty() && !reader.has_step(),
    };
    let unit_states: Vec<FinalUnitState> = readers.iter().map(rest).collect();
    let report = time.finalize(&unit_states, halt, probe);
    time.show_fills(probe, Some(Cycle(report.total)));
    let path = path.and_then(|tracer| {
        let is_complete = report.outcome == Outcome::Complete;
        let steps = || readers.iter().map(RecordingReader::kept_steps).collect::<Vec<_>>();
        let path = if is_complete { tracer.path(&time, &steps(), &report, goal.groups()) } else { None };
        memory.tracer = tracer.end(&mut time);
        path
    });
    memory.fifos = time.into_fifo_memory();
    Ok((report, path))
}

/// Ends a round: reports what a reader or a stage found wrong.
fn after_round<P: Probe>(walk: &mut RunAhead<'_, P>, readers: &mut [RecordingReader]) -> Result<(), ResimulateError> {
    if let Some(fault) = walk.round.fault.take() {
        return Err(ResimulateError::Fault(fault));
    }
    if let Some(error) = readers.iter_mut().find_map(|reader| reader.error.take()) {
        return Err(error.into());
    }
    if walk.round.path.as_ref().is_some_and(|path| !path.has_all()) {
        readers.iter_mut().for_each(|reader| reader.keep_steps(false));
    }
    walk.time.show_fills(walk.round.probe, None);
    Ok(())
}

/// Reads the next chunk, which a stage needs.
fn feed(readers: &mut [RecordingReader], chunks: &mut ChunkSource<'_, '_>, time: &MachineTiming) -> Result<(), ResimulateError> {
    let waiting = readers.iter().map(RecordingReader::bytes_left).sum();
    let Some(chunk) = chunks(waiting).map_err(ResimulateError::Read)? else {
        let needs = |&stage: &usize| {
            let demand = readers[stage].demand().unwrap_or(Demand::Finished);
            !readers[stage].has_step() && time.next_start(stage, demand).is_known()
        };
        let stage = (0..readers.len()).find(needs).unwrap_or_default();
        return Err(ResimulateError::EndsEarly(time.shape.stages[stage].names.name.clone()));
    };
    if chunk.stages.len() != readers.len() {
        return Err(ResimulateError::Stages { found: chunk.stages.len(), expected: readers.len() });
    }
    chunk.feed(readers);
    Ok(())
}
