//! A run under way: the engine, the pictures it finishes, and the report in the end.

use crate::apart::{may_be_apart, run_apart};
use crate::costs::StepGroups;
use crate::ended::Ended;
use crate::exact::Exact;
use crate::exhibits::content::{ExhibitInfo, Form};
use crate::exhibits::spec::show_round;
use crate::held;
use crate::judged::{Judged, judged};
use crate::limits::{Kept, Measured, Recorded};
use crate::machines::{Logs, MachineSpec, PictureRecord};
use crate::observer::{MemoryRequests, Observer, Pictures, picture_name};
use crate::outcome::{Run, SessionError};
use crate::run::Way;
use crate::settings::{RunOptions, When};
use crate::tape::{self, REEL_BYTES, WorkHash};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_input::{Held, OverBudget};
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{self as kernel, Limits, Machine, Outcome, Probe, RunReport};
use basrelief_machines::UnitStats;
use basrelief_reference::{Picture, Quality, SizeMismatch, metrics};
use basrelief_report::model::{Difference, Input, Picture as PictureFile, PictureQuality, Size};
use basrelief_signals::{Camera, Frame};
use basrelief_threads::{self as threads, Later};
use basrelief_trace::Expectation;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::{Mutex, PoisonError};

/// What the engine came to, and what the units counted.
pub(crate) struct EngineResult {
    facts: UnitStats,
    report: Option<RunReport>,
    /// What limits it, where that was measured.
    measured: Option<Measured>,
}

/// A run under way.
pub(crate) struct Session<'a> {
    settings: &'a RunOptions,
    observer: &'a mut dyn Observer,
    exact: Exact,
    commands: Box<dyn Fn() -> (u64, Option<u64>)>,
    /// Frames finished so far.
    frames: usize,
    /// Those that are being judged, or that nobody has looked at yet.
    judging: VecDeque<Later<Result<Judged, SizeMismatch>>>,
    images: Vec<String>,
    quality: Vec<Quality>,
    difference: Option<Difference>,
    /// Most frames that are still judged while the next is drawn.
    pub(crate) behind: usize,
    /// Pictures of the current frame that better ones follow.
    rounds: Vec<(u32, Picture)>,
    shown: Vec<PictureRecord>,
    failed: Option<String>,
    /// What is remembered of frames, and their pictures that better ones follow.
    held: [Held; 2],
    over_budget: Option<OverBudget>,
    /// Names of the memory clients, by number, where their requests are shown.
    clients: Vec<String>,
    /// Of the tape that is shown.
    work: WorkHash,
    /// For whom the steps are, where that is followed.
    pub(crate) groups: Option<Rc<RefCell<StepGroups>>>,
    /// Seconds of simulation.
    pub(crate) simulate_s: f64,
}

impl<'a> Session<'a> {
    pub(crate) fn new(
        settings: &'a RunOptions,
        observer: &'a mut dyn Observer,
        exact: Exact,
        commands: Box<dyn Fn() -> (u64, Option<u64>)>,
    ) -> Self {
        let (images, quality, difference) = (Vec::new(), Vec::new(), None);
        let (rounds, shown) = (Vec::new(), Vec::new());
        let held = [settings.budget.nothing(), settings.budget.nothing()];
        let (failed, over_budget) = (None, None);
        Self {
            settings,
            observer,
            exact,
            commands,
            frames: 0,
            judging: VecDeque::new(),
            behind: 1,
            images,
            quality,
            difference,
            rounds,
            shown,
            failed,
            held,
            over_budget,
            clients: Vec::new(),
            work: WorkHash::default(),
            groups: None,
            simulate_s: 0.0,
        }
    }

    /// Simulates to the end.
    pub(crate) fn drive<S: MachineSpec, M: Logs<S::Log>, P: Probe>(
        &mut self,
        (spec, way): (&S, Way),
        mut machine: M,
        probe: &mut P,
    ) -> Result<EngineResult, SessionError> {
        if !self.settings.exhibits.is_empty() {
            machine.keep_log();
        }
        if self.shows_tape() {
            let head = tape::head::<S>(way, &self.settings.given);
            self.attempt(|session| session.observer.tape(&head, true));
        }
        self.keep_requests(&mut machine);
        // Where a user acts at times, what is drawn follows from times.
        let mut kept = Kept::new(self.settings.limits, &self.settings.budget).filter(|_| !spec.acts_at_times());
        let (ran, reels) = self.simulate(spec, &mut machine, probe, &mut kept);
        let report = match ran {
            Ok(report) => report,
            Err(fault) => {
                self.take_tape(reels, &mut kept);
                self.settle(0);
                return Err(self.fault(fault));
            }
        };
        self.take_requests(&mut machine);
        // The last frames first: they are judged while the last of the tape is encoded, and while it is measured what limits the run.
        self.take_frames(spec, &mut machine);
        self.take_tape(reels, &mut kept);
        let measured = self.settle_and_measure((spec, way), report.as_ref(), kept.as_ref());
        if !self.settings.exhibits.is_empty() {
            let last = machine.last_log().map(|log| (0, log));
            self.show(spec, last.as_slice());
        }
        if let Some(over_budget) = self.over_budget.take() {
            return Err(over_budget.into());
        }
        if let Some(RunReport { outcome: Outcome::Fault(fault), .. }) = &report {
            return Err(self.fault(fault.clone()));
        }
        if let Some(lost) = machine.lost() {
            return Err(self.fault(lost));
        }
        match self.failed.take() {
            Some(failed) => Err(SessionError::Observer(failed)),
            None => Ok(EngineResult { facts: machine.facts(), report, measured }),
        }
    }

    /// Hands on the frames that are still judged, and measures meanwhile what limits a run that is complete, if its tape was kept.
    fn settle_and_measure<S: MachineSpec>(
        &mut self,
        (spec, way): (&S, Way),
        run: Option<&RunReport>,
        kept: Option<&Kept>,
    ) -> Option<Measured> {
        let is_well = self.failed.is_none() && self.over_budget.is_none();
        let complete = run.filter(|run| is_well && run.outcome == Outcome::Complete);
        let Some((run, reels)) = complete.zip(kept.and_then(Kept::reels)) else {
            self.settle(0);
            return None;
        };
        let (groups, settings) = (self.groups.clone(), self.settings);
        let groups = groups.as_ref().map(|groups| groups.borrow());
        let groups = groups.as_ref().map_or(&[][..], |groups| &groups.stages);
        let (given, room) = (&settings.given, settings.budget.left());
        let measure = || Recorded { spec, given, way, reels, room, run, groups }.measure();
        threads::both(measure, || self.settle(0)).0
    }

    /// The engine's part, and the reels of the tape that are not taken yet; no report of a functional run.
    fn simulate<S: MachineSpec, M: Logs<S::Log>, P: Probe>(
        &mut self,
        spec: &S,
        machine: &mut M,
        probe: &mut P,
        kept: &mut Option<Kept>,
    ) -> (Result<Option<RunReport>, String>, Vec<RecordingChunk>) {
        let &RunOptions { clock, engine, max_cycles, .. } = self.settings;
        let (began, mut aside) = (clock(), 0.0);
        let reels = Mutex::new(Vec::new());
        let new_reels = || std::mem::take(&mut *reels.lock().unwrap_or_else(PoisonError::into_inner));
        let keep = |reel| reels.lock().unwrap_or_else(PoisonError::into_inner).push(reel);
        let (is_recorded, may_be_apart) = (kept.is_some() || self.shows_tape(), may_be_apart::<P>(self.settings));
        let mut progress = |machine: &mut M| {
            self.take_tape(new_reels(), kept);
            self.look(spec, machine, &mut aside)
        };
        let apart = may_be_apart.then(|| run_apart(machine, &mut progress, is_recorded.then_some(&keep as _)));
        let ran = match (apart.flatten(), engine) {
            (Some(report), _) => Ok(Some(report)),
            (None, Some(engine)) => {
                let limits = Limits { max_cycles, progress: &mut progress };
                Ok(Some(if is_recorded {
                    kernel::run_recorded(machine, engine, probe, limits, (REEL_BYTES, &mut |reel| keep(reel)))
                } else {
                    kernel::run_with(machine, engine, probe, limits)
                }))
            }
            (None, None) => kernel::run_functional(machine, &mut progress).map(|()| None),
        };
        self.simulate_s = clock() - began - aside;
        (ran, new_reels())
    }

    fn fault(&mut self, fault: String) -> SessionError {
        self.failed.take().map_or(SessionError::Fault(fault), SessionError::Observer)
    }

    /// Called by the engine between its rounds; what is done here counts as no simulation.
    fn look<S: MachineSpec, M: Logs<S::Log>>(&mut self, spec: &S, machine: &mut M, aside: &mut f64) -> bool {
        let (rounds, has_finished) = (machine.drain_rounds(), !machine.finished().is_empty());
        if has_finished || !rounds.is_empty() || self.settings.requests {
            let began = (self.settings.clock)();
            self.take_requests(machine);
            self.take_rounds(spec, rounds);
            if has_finished {
                self.take_frames(spec, machine);
            }
            *aside += (self.settings.clock)() - began;
        }
        let (commands, total) = (self.commands)();
        self.failed.is_none() && self.over_budget.is_none() && self.observer.progress(commands, total)
    }

    /// Whether the observer is shown the tape, so far.
    fn shows_tape(&self) -> bool {
        match self.settings.tape {
            When::Never => false,
            When::IfShort => self.work.is_short(),
            When::Always => true,
        }
    }

    /// Takes the reels of the tape since the last call: keeps them, and shows them.
    fn take_tape(&mut self, reels: Vec<RecordingChunk>, kept: &mut Option<Kept>) {
        for reel in reels {
            if self.shows_tape() {
                self.work.add(&reel);
                self.attempt(|session| session.observer.tape(&tape::reel(&reel), session.work.is_short()));
            }
            if let Some(Err(over_budget)) = kept.as_mut().map(|kept| kept.keep(reel)) {
                self.over_budget.get_or_insert(over_budget);
            }
        }
    }

    fn keep_requests(&mut self, machine: &mut impl Machine) {
        if self.settings.requests {
            machine.memories().keep_requests();
            self.clients = machine.memories().client_names().map(str::to_owned).collect();
        }
    }

    /// Shows what the memories have taken in since the last call.
    fn take_requests(&mut self, machine: &mut impl Machine) {
        for (memory, requests) in machine.memories().take_requests().filter(|(_, requests)| !requests.is_empty()) {
            self.attempt(|session| {
                session.observer.requests(&MemoryRequests { memory, requests: &requests, clients: &session.clients })
            });
        }
    }

    /// The exhibit of pictures that are shown of a frame, if it is wanted.
    fn wanted_rounds<S: MachineSpec>(&self, spec: &S) -> Option<ExhibitInfo> {
        self.wanted::<S>(Form::PicturePerRound).filter(|_| spec.shows_rounds())
    }

    fn take_rounds<S: MachineSpec>(&mut self, spec: &S, rounds: Vec<FinishedFrame>) {
        let wanted = self.wanted_rounds(spec);
        for shown in rounds {
            let (frame, number) = (shown.index, shown.round);
            self.observer.shown(frame, number);
            let picture = picture(shown);
            self.attempt(|session| wanted.map_or(Ok(()), |info| show_round(info, [frame, number], &picture, session.observer)));
            let bytes = held::WAITING_PIXEL * picture.rgb.len() as u64;
            if self.hold(1, bytes, "pictures that better ones follow") {
                self.rounds.push((frame, picture));
            }
        }
    }

    fn take_frames<S: MachineSpec, M: Logs<S::Log>>(&mut self, spec: &S, machine: &mut M) {
        self.take_rounds(spec, machine.drain_rounds());
        let rounds = self.wanted_rounds(spec);
        let frames = machine.drain_finished();
        self.show(spec, &machine.drain_log(&frames));
        for frame in frames {
            self.attempt(|session| session.take_frame(frame, rounds));
            self.settle(self.behind);
        }
    }

    /// Takes bytes for what is remembered; the run ends where there are none left.
    fn hold(&mut self, which: usize, bytes: u64, what: &str) -> bool {
        self.over_budget = self.over_budget.take().or_else(|| self.held[which].grow(bytes, what).err());
        self.over_budget.is_none()
    }

    /// The exhibit of this form, if the machine has one and it is wanted.
    fn wanted<S: MachineSpec>(&self, form: Form) -> Option<ExhibitInfo> {
        S::EXHIBITS.iter().map(|e| e.info).find(|info| info.form == form && self.settings.exhibits.contains(info))
    }

    /// Shows all that is wanted of these entries of the log.
    fn show<S: MachineSpec>(&mut self, spec: &S, log: &[(u32, S::Log)]) {
        for entry in log {
            for exhibit in S::EXHIBITS.iter().filter(|e| self.settings.exhibits.contains(&e.info)) {
                self.attempt(|session| exhibit.show(spec, entry, session.observer));
            }
        }
    }

    /// Does something, unless anything has failed before.
    fn attempt(&mut self, action: impl FnOnce(&mut Self) -> Result<(), String>) {
        if self.failed.is_none() {
            self.failed = action(self).err();
        }
    }

    fn take_frame(&mut self, frame: FinishedFrame, rounds: Option<ExhibitInfo>) -> Result<(), String> {
        if !self.hold(0, held::FRAME, "figures of frames") {
            return Ok(());
        }
        let number = frame.index;
        let before = self.rounds.iter().filter(|(of, _)| *of == number).count();
        self.observer.shown(number, before as u32);
        let machine = picture(frame);
        let round = self.compare_rounds(number, &machine).map_err(|e| e.to_string())?;
        if let Some(info) = rounds {
            show_round(info, [number, round], &machine, self.observer)?;
        }
        let exact = self.exact.picture(self.frames);
        self.judging.push_back(judged(self.frames, machine, exact));
        self.frames += 1;
        Ok(())
    }

    /// Hands on the frames that are judged, in their order, until so many are left to be judged.
    fn settle(&mut self, left: usize) {
        while self.judging.len() > left {
            let judged = self.judging.pop_front();
            self.attempt(|session| judged.map_or(Ok(()), |judged| session.hand_on(judged)));
        }
    }

    fn hand_on(&mut self, judged: Later<Result<Judged, SizeMismatch>>) -> Result<(), String> {
        let Judged { index, machine, digest, exact } = judged.get().map_err(|e| e.to_string())?;
        self.images.push(digest);
        if let Some((_, quality, difference)) = exact {
            self.quality.push(quality);
            self.difference = Some(difference);
        }
        let exact = exact.as_ref().map(|(picture, quality, _)| (&**picture, *quality));
        self.observer.frame(&Pictures { index, machine: &machine, exact })
    }

    /// Holds the pictures that were shown before against the last one of their frame; the number of that.
    fn compare_rounds(&mut self, frame: u32, last: &Picture) -> Result<u32, metrics::SizeMismatch> {
        let (own, others) = std::mem::take(&mut self.rounds).into_iter().partition(|(of, _)| *of == frame);
        self.rounds = others;
        let own: Vec<(u32, Picture)> = own;
        let rest: usize = self.rounds.iter().map(|(_, picture)| picture.rgb.len()).sum();
        self.held[1].shrink_to(held::WAITING_PIXEL * rest as u64);
        for (round, (_, picture)) in (0..).zip(&own) {
            let psnr_db = basrelief_report::number::round6(metrics::psnr(last, picture)?);
            self.shown.push(PictureRecord { frame, round, psnr_db, last: false });
        }
        let round = own.len() as u32;
        self.shown.push(PictureRecord { frame, round, psnr_db: metrics::IDENTICAL_DB, last: true });
        Ok(round)
    }

    pub(crate) fn finish<S: MachineSpec>(
        self,
        spec: &S,
        input: Input,
        frame: Option<&Frame>,
        result: EngineResult,
        warnings: &[String],
        expectations: Vec<Expectation>,
    ) -> Run {
        let (shows_tape, several) = (self.shows_tape(), self.images.len() > 1);
        let image = self.images.into_iter().enumerate();
        let no_view = Camera { view_projection: [0.0; 16], to_light: [0.0; 3], to_viewer: [0.0; 3] };
        let ended = Ended {
            input,
            camera: frame.map_or(no_view, |f| f.camera),
            size: frame.map_or(Size { width: 0, height: 0 }, |f| Size { width: f.width, height: f.height }),
            quality: self.quality.last().map(|&last| PictureQuality {
                last,
                difference: self.difference,
                frames: if several { self.quality.clone() } else { vec![] },
            }),
            image: image.map(|(i, sha256)| PictureFile { file: picture_name("image", i, several), sha256 }).collect(),
            warnings: warnings.to_vec(),
            shown: self.shown,
        };
        let EngineResult { facts, report: run, measured } = result;
        let complete = run.as_ref().filter(|run| run.outcome == Outcome::Complete);
        let mut tape_is_whole = false;
        if complete.is_some() && shows_tape {
            let figures = facts.figures().map(|f| (f.name.clone(), f.value.clone())).collect();
            let is_short = self.work.is_short();
            tape_is_whole = self.observer.tape(&tape::end(&ended, figures, self.work), is_short).is_ok();
        }
        let mut report = ended.report(spec, facts, run.as_ref());
        let path_groups = measured.map(|measured| measured.put(&mut report)).unwrap_or_default();
        Run { report, timing: run, costs: None, path_groups, tape_is_whole, expectations, simulate_s: self.simulate_s }
    }
}

/// A finished frame as a picture.
pub(crate) fn picture(frame: FinishedFrame) -> Picture {
    Picture { width: frame.width, height: frame.height, rgb: frame.rgb, covered: frame.covered }
}
