//! A run in progress: drives the engine, collects the finished frames, and assembles the report.

mod analysis_warnings;
mod frames;
mod picture_checks;

use super::compared_frame::ComparedFrame;
use super::concurrent::{may_run_concurrently, run_concurrent};
use super::exact::ExactSource;
use super::result::{RunError, RunResult};
use super::untimed::UntimedResult;
use crate::analysis::bottleneck::{BottleneckList, CompletedRun};
use crate::analysis::costs::StepPolygons;
use crate::build::BUILD;
use crate::machine::SimulatedMachine;
use crate::observer::{MemoryRequests, Observer, picture_name};
use crate::options::{AnalysisPolicy, RunOptions};
use crate::recording::{self, CHUNK_BYTES, KeptSteps, RecordingSeal, WorkHash};
use basrelief_input::{MemoryReservation, OverBudget};
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{Machine, Outcome, Probe, RunLimits, RunReport};
use basrelief_machines::{InputKind, LoggingMachine, PictureRecord, UnitStats};
use basrelief_reference::{QualityMetrics, RgbPicture, SizeMismatch};
use basrelief_report::model::{Difference, Input, Picture as PictureFile, PictureQuality, Size};
use basrelief_signals::{Camera, Frame};
use basrelief_threads::{self as threads, Deferred};
use basrelief_trace::ExpectedResults;
use picture_checks::PictureChecks;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::{Mutex, PoisonError};

/// Result of the engine, with the statistics of the units.
pub(crate) struct EngineResult {
    facts: UnitStats,
    report: Option<RunReport>,
    /// BottleneckList, if they were measured.
    bottlenecks: Option<BottleneckList>,
}

/// Result of [`ActiveRun::simulate`].
struct SimulatedRun {
    /// `None` for a functional run.
    report: Result<Option<RunReport>, String>,
    /// Recorded steps that are not yet passed on.
    chunks: Vec<RecordingChunk>,
}

/// Input of a run for its report.
pub(crate) struct InputInfo<'a> {
    pub(crate) input: Input,
    /// The last frame.
    pub(crate) frame: Option<&'a Frame>,
    pub(crate) warnings: &'a [String],
    pub(crate) expectations: Vec<ExpectedResults>,
}

/// Returns the number of commands so far, and of all commands if known.
pub(crate) type CommandCount = Box<dyn Fn() -> (u64, Option<u64>)>;

/// A run in progress.
pub(crate) struct ActiveRun<'a> {
    options: &'a RunOptions,
    observer: &'a mut dyn Observer,
    exact: ExactSource,
    commands: CommandCount,
    /// Number of finished frames.
    frames: usize,
    /// Frames that are being compared, or whose comparison has not been collected.
    comparing: VecDeque<Deferred<Result<ComparedFrame, SizeMismatch>>>,
    images: Vec<String>,
    quality: Vec<QualityMetrics>,
    difference: Option<Difference>,
    checks: PictureChecks,
    /// Maximum number of frames in comparison while the next frame is drawn.
    pub(crate) max_comparing: usize,
    /// Pictures that a better picture of the same frame follows.
    rounds: Vec<(u32, RgbPicture)>,
    shown: Vec<PictureRecord>,
    failed: Option<String>,
    /// Memory of finished frames.
    frames_held: MemoryReservation,
    /// Memory of `rounds`.
    rounds_held: MemoryReservation,
    over_budget: Option<OverBudget>,
    /// True if there was no memory for an analysis that nobody asked for.
    lacks_memory: bool,
    /// Names of the memory clients, by number, if memory requests are observed.
    clients: Vec<String>,
    /// True if a recording of this run serves other timings.
    is_recorded: bool,
    /// True once a step takes more cycles than a recording can hold.
    has_long_step: bool,
    /// Hash of the recording.
    work: WorkHash,
    /// Seal of its header, once that is written.
    seal: Option<RecordingSeal>,
    /// Polygon of each step, if they are attributed.
    pub(crate) step_polygons: Option<Rc<RefCell<StepPolygons>>>,
    /// Time of simulation on the host \[s\].
    pub(crate) simulate_s: f64,
}

impl<'a> ActiveRun<'a> {
    pub(crate) fn new(
        options: &'a RunOptions,
        observer: &'a mut dyn Observer,
        exact: ExactSource,
        commands: CommandCount,
    ) -> Self {
        Self {
            options,
            observer,
            exact,
            commands,
            frames: 0,
            comparing: VecDeque::new(),
            images: vec![],
            quality: vec![],
            difference: None,
            checks: PictureChecks::default(),
            max_comparing: 1,
            rounds: vec![],
            shown: vec![],
            failed: None,
            frames_held: options.budget.empty_reservation(),
            rounds_held: options.budget.empty_reservation(),
            over_budget: None,
            lacks_memory: false,
            clients: vec![],
            is_recorded: true,
            has_long_step: false,
            work: WorkHash::default(),
            seal: None,
            step_polygons: None,
            simulate_s: 0.0,
        }
    }

    /// Simulates to the end.
    pub(crate) fn run_machine<S: SimulatedMachine, M: LoggingMachine<S::Log>>(
        &mut self,
        spec: &S,
        input: InputKind,
        mut machine: M,
        probe: Option<&mut dyn Probe>,
    ) -> Result<EngineResult, RunError> {
        if !self.options.aux_outputs.is_empty() {
            machine.keep_log();
        }
        // With a user who acts at times, the work depends on timing. So no recording serves another timing.
        self.is_recorded = !spec.acts_at_times();
        if self.needs_steps() {
            let (header, seal) = recording::header::<S>(BUILD, input, &self.options.overrides);
            self.seal = Some(seal);
            self.run_unless_failed(|session| session.observer.recording(&header, true));
        }
        self.keep_requests(&mut machine);
        let mut kept = KeptSteps::new(self.options.bottlenecks, &self.options.budget).filter(|_| self.is_recorded);
        let SimulatedRun { report, chunks } = self.simulate(spec, &mut machine, probe, &mut kept);
        let report = match report {
            Ok(report) => report,
            Err(fault) => {
                self.take_steps(chunks, &mut kept);
                self.collect_frames(0);
                return Err(self.fault(fault));
            }
        };
        self.take_requests(&mut machine);
        // The last frames come first, so that they are compared while the recording is encoded and the bottlenecks are measured.
        self.take_frames(spec, &mut machine);
        self.take_steps(chunks, &mut kept);
        self.lacks_memory = kept.as_ref().is_some_and(KeptSteps::lacks_memory);
        let bottlenecks = self.collect_and_analyse(spec, input, report.as_ref(), kept.as_ref());
        if !self.options.aux_outputs.is_empty() {
            let last = machine.last_log().map(|log| (0, log));
            self.make_aux_outputs(spec, last.as_slice());
        }
        self.check(&machine, report.as_ref())?;
        Ok(EngineResult { facts: machine.facts(), report, bottlenecks })
    }

    /// Returns the first error of a run that has ended.
    fn check<L>(&mut self, machine: &impl LoggingMachine<L>, report: Option<&RunReport>) -> Result<(), RunError> {
        if let Some(over_budget) = self.over_budget.take() {
            return Err(over_budget.into());
        }
        if let Some(RunReport { outcome: Outcome::Fault(fault), .. }) = report {
            return Err(self.fault(fault.clone()));
        }
        if let Some(lost) = machine.lost() {
            return Err(self.fault(lost));
        }
        self.failed.take().map_or(Ok(()), |failed| Err(RunError::Observer(failed)))
    }

    /// Passes on the last frames. Meanwhile, measures the bottlenecks of a completed run whose steps were kept.
    fn collect_and_analyse<S: SimulatedMachine>(
        &mut self,
        spec: &S,
        input: InputKind,
        run: Option<&RunReport>,
        kept: Option<&KeptSteps>,
    ) -> Option<BottleneckList> {
        let is_well = self.failed.is_none() && self.over_budget.is_none();
        let complete = run.filter(|run| is_well && run.outcome == Outcome::Complete);
        let Some((run, chunks)) = complete.zip(kept.and_then(KeptSteps::chunks)) else {
            self.collect_frames(0);
            return None;
        };
        let (polygons, options) = (self.step_polygons.clone(), self.options);
        let polygons = polygons.as_ref().map(|polygons| polygons.borrow());
        let groups = polygons.as_ref().map_or(&[][..], |polygons| &polygons.stages);
        let (overrides, room) = (&options.overrides, options.budget.left());
        let analyse = || CompletedRun { spec, overrides, input, chunks, room, run, groups }.bottlenecks();
        threads::join(analyse, || self.collect_frames(0)).0
    }

    /// Runs the engine.
    fn simulate<S: SimulatedMachine, M: LoggingMachine<S::Log>>(
        &mut self,
        spec: &S,
        machine: &mut M,
        probe: Option<&mut dyn Probe>,
        kept: &mut Option<KeptSteps>,
    ) -> SimulatedRun {
        let &RunOptions { clock, engine, max_cycles, .. } = self.options;
        let (began, mut aside) = (clock(), 0.0);
        let chunks = Mutex::new(Vec::new());
        let new_chunks = || std::mem::take(&mut *chunks.lock().unwrap_or_else(PoisonError::into_inner));
        let keep = |chunk| chunks.lock().unwrap_or_else(PoisonError::into_inner).push(chunk);
        let (is_recorded, is_concurrent) =
            (kept.is_some() || self.needs_steps(), probe.is_none() && may_run_concurrently(self.options));
        let mut progress = |machine: &mut M| {
            self.take_steps(new_chunks(), kept);
            self.take_outputs(spec, machine, &mut aside)
        };
        let concurrent = is_concurrent.then(|| run_concurrent(machine, &mut progress, is_recorded.then_some(&keep as _)));
        let report = match (concurrent.flatten(), engine) {
            (Some(report), _) => Ok(Some(report)),
            (None, Some(engine)) => {
                let limits = RunLimits { max_cycles, progress: &mut progress };
                Ok(Some(if is_recorded {
                    machine.run_recorded(engine, probe, limits, CHUNK_BYTES, &mut |chunk| keep(chunk))
                } else {
                    machine.run_with(engine, probe, limits)
                }))
            }
            (None, None) => machine.run_functional(&mut progress).map(|()| None),
        };
        self.simulate_s = clock() - began - aside;
        SimulatedRun { report, chunks: new_chunks() }
    }

    fn fault(&mut self, fault: String) -> RunError {
        self.failed.take().map_or(RunError::Fault(fault), RunError::Observer)
    }

    /// Takes outputs of the machine between rounds of the engine. Adds the time to `aside`, because it is not simulation time. Returns
    /// false to stop the run.
    fn take_outputs<S: SimulatedMachine, M: LoggingMachine<S::Log>>(
        &mut self,
        spec: &S,
        machine: &mut M,
        aside: &mut f64,
    ) -> bool {
        let (rounds, has_finished) = (machine.drain_rounds(), !machine.finished().is_empty());
        if has_finished || !rounds.is_empty() || self.options.requests {
            let began = (self.options.clock)();
            self.take_requests(machine);
            self.take_rounds(spec, rounds);
            if has_finished {
                self.take_frames(spec, machine);
            }
            *aside += (self.options.clock)() - began;
        }
        let (commands, total) = (self.commands)();
        self.failed.is_none() && self.over_budget.is_none() && self.observer.progress(commands, total)
    }

    /// True if the observer receives the recording so far.
    fn needs_steps(&self) -> bool {
        let wants_steps = match self.options.recording {
            AnalysisPolicy::Never => false,
            AnalysisPolicy::IfShort => self.work.is_short(),
            AnalysisPolicy::Always => true,
        };
        self.is_recorded && wants_steps
    }

    /// Keeps new recorded steps, and passes them to the observer.
    fn take_steps(&mut self, chunks: Vec<RecordingChunk>, kept: &mut Option<KeptSteps>) {
        for chunk in chunks {
            if chunk.has_long_step() {
                (self.has_long_step, self.is_recorded, *kept) = (true, false, None);
                return;
            }
            if self.needs_steps() {
                self.work.add(&chunk);
                self.run_unless_failed(|session| session.observer.recording(&recording::steps(&chunk), session.work.is_short()));
            }
            if let Some(Err(over_budget)) = kept.as_mut().map(|kept| kept.keep(chunk)) {
                self.over_budget.get_or_insert(over_budget);
            }
        }
    }

    fn keep_requests(&mut self, machine: &mut impl Machine) {
        if self.options.requests {
            machine.memories().keep_requests();
            self.clients = machine.memories().client_names().map(str::to_owned).collect();
        }
    }

    /// Passes new memory requests to the observer.
    fn take_requests(&mut self, machine: &mut impl Machine) {
        for (memory, requests) in machine.memories().take_requests().filter(|(_, requests)| !requests.is_empty()) {
            self.run_unless_failed(|session| {
                session.observer.requests(&MemoryRequests { memory, requests: &requests, clients: &session.clients })
            });
        }
    }

    /// Performs an action, unless an action has failed before.
    fn run_unless_failed(&mut self, action: impl FnOnce(&mut Self) -> Result<(), String>) {
        if self.failed.is_none() {
            self.failed = action(self).err();
        }
    }

    /// Assembles the report, and ends the recording.
    pub(crate) fn finish<S: SimulatedMachine>(mut self, spec: &S, info: InputInfo<'_>, result: EngineResult) -> RunResult {
        let records = self.needs_steps();
        let EngineResult { facts, report: run, bottlenecks } = result;
        let mut untimed = self.untimed_result(&info);
        let of_scene = matches!(self.exact, ExactSource::Scene(_));
        untimed.warnings.extend(self.checks.warnings(&facts, spec.exact_style(), of_scene));
        untimed.warnings.extend(self.analysis_warnings(spec, run.as_ref().filter(|_| bottlenecks.is_some())));
        let complete = run.as_ref().filter(|run| run.outcome == Outcome::Complete);
        let mut recording_is_complete = false;
        if let Some(seal) = self.seal.filter(|_| complete.is_some() && records) {
            let figures = facts.figures().map(|f| (f.name.clone(), f.value.clone())).collect();
            let is_short = self.work.is_short();
            recording_is_complete =
                self.observer.recording(&recording::end(&untimed, figures, self.work, seal), is_short).is_ok();
        }
        let mut report = untimed.report(spec, facts, run.as_ref());
        let path_groups = bottlenecks.map(|bottlenecks| bottlenecks.add_to(&mut report)).unwrap_or_default();
        RunResult {
            report,
            timing: run,
            costs: None,
            path_groups,
            recording_is_complete,
            expectations: info.expectations,
            simulate_s: self.simulate_s,
        }
    }

    fn untimed_result(&mut self, info: &InputInfo<'_>) -> UntimedResult {
        let several = self.images.len() > 1;
        let images = std::mem::take(&mut self.images).into_iter().enumerate();
        let no_view = Camera { view_projection: [0.0; 16], to_light: [0.0; 3], to_viewer: [0.0; 3] };
        UntimedResult {
            input: info.input.clone(),
            camera: info.frame.map_or(no_view, |f| f.camera),
            size: info.frame.map_or(Size { width: 0, height: 0 }, |f| Size { width: f.width, height: f.height }),
            quality: PictureQuality::of(&self.quality, self.difference),
            image: images.map(|(i, sha256)| PictureFile { file: picture_name("image", i, several), sha256 }).collect(),
            warnings: info.warnings.to_vec(),
            shown: std::mem::take(&mut self.shown),
        }
    }
}
