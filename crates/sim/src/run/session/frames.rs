//! Finished frames of a run: comparison with the reference image, and auxiliary outputs.

use super::ActiveRun;
use crate::machine::SimulatedMachine;
use crate::observer::FramePictures;
use crate::outputs::aux_output::{AuxForm, AuxOutputInfo};
use crate::outputs::aux_spec::show_round;
use crate::run::compared_frame::{ComparedFrame, compare_frame};
use crate::run::memory_estimates;
use basrelief_frame_buffer::FinishedFrame;
use basrelief_machines::{LoggingMachine, PictureRecord};
use basrelief_reference::{RgbPicture, SizeMismatch, metrics};
use basrelief_threads::Deferred;

impl ActiveRun<'_> {
    /// Returns the auxiliary output of pictures in increasing quality, if it is selected.
    fn rounds_output<S: SimulatedMachine>(&self, spec: &S) -> Option<AuxOutputInfo> {
        let outputs = S::AUX_OUTPUTS.iter().map(|output| output.info);
        let mut selected = outputs.filter(|info| self.options.aux_outputs.contains(info));
        selected.find(|info| info.form == AuxForm::PicturePerRound).filter(|_| spec.shows_rounds())
    }

    /// Takes pictures that a better picture of the same frame follows.
    pub(super) fn take_rounds<S: SimulatedMachine>(&mut self, spec: &S, rounds: Vec<FinishedFrame>) {
        let output = self.rounds_output(spec);
        for shown in rounds {
            let (frame, number) = (shown.index, shown.round);
            self.observer.picture_shown(frame, number);
            let picture = picture(shown);
            self.run_unless_failed(|session| {
                output.map_or(Ok(()), |info| show_round(info, [frame, number], &picture, session.observer))
            });
            let bytes = memory_estimates::WAITING_PIXEL * picture.rgb.len() as u64;
            let held = self.rounds_held.try_grow(bytes, "earlier pictures of a frame");
            if self.check_memory(held) {
                self.rounds.push((frame, picture));
            }
        }
    }

    /// Takes finished frames.
    pub(super) fn take_frames<S: SimulatedMachine, M: LoggingMachine<S::Log>>(&mut self, spec: &S, machine: &mut M) {
        self.take_rounds(spec, machine.drain_rounds());
        let rounds = self.rounds_output(spec);
        let frames = machine.drain_finished();
        self.make_aux_outputs(spec, &machine.drain_log(&frames));
        for frame in frames {
            self.run_unless_failed(|session| session.take_frame(frame, rounds));
            self.collect_frames(self.max_comparing);
        }
    }

    /// Stores the first error. The run stops after an error.
    fn check_memory(&mut self, held: Result<(), basrelief_input::OverBudget>) -> bool {
        self.over_budget = self.over_budget.take().or_else(|| held.err());
        self.over_budget.is_none()
    }

    /// Makes the selected auxiliary outputs from entries of the log.
    pub(super) fn make_aux_outputs<S: SimulatedMachine>(&mut self, spec: &S, log: &[(u32, S::Log)]) {
        for entry in log {
            for output in S::AUX_OUTPUTS.iter().filter(|output| self.options.aux_outputs.contains(&output.info)) {
                self.run_unless_failed(|session| output.show(spec, entry, session.observer));
            }
        }
    }

    fn take_frame(&mut self, frame: FinishedFrame, rounds: Option<AuxOutputInfo>) -> Result<(), String> {
        let held = self.frames_held.try_grow(memory_estimates::FRAME, "figures of frames");
        if !self.check_memory(held) {
            return Ok(());
        }
        let number = frame.index;
        let before = self.rounds.iter().filter(|(of, _)| *of == number).count();
        self.observer.picture_shown(number, before as u32);
        let machine = picture(frame);
        let round = self.compare_rounds(number, &machine).map_err(|e| e.to_string())?;
        if let Some(info) = rounds {
            show_round(info, [number, round], &machine, self.observer)?;
        }
        let exact = self.exact.picture(self.frames);
        self.comparing.push_back(compare_frame(self.frames, machine, exact));
        self.frames += 1;
        Ok(())
    }

    /// Passes on compared frames in order, until at most `left` frames are in comparison.
    pub(super) fn collect_frames(&mut self, left: usize) {
        while self.comparing.len() > left {
            let compared = self.comparing.pop_front();
            self.run_unless_failed(|session| compared.map_or(Ok(()), |compared| session.pass_on(compared)));
        }
    }

    fn pass_on(&mut self, compared: Deferred<Result<ComparedFrame, SizeMismatch>>) -> Result<(), String> {
        let ComparedFrame { index, machine, digest, exact } = compared.get().map_err(|e| e.to_string())?;
        self.images.push(digest);
        self.checks.add(index, &machine, exact.as_ref().map(|(exact, ..)| &**exact));
        if let Some((_, quality, difference)) = exact {
            self.quality.push(quality);
            self.difference = Some(difference);
        }
        let exact = exact.as_ref().map(|(picture, quality, _)| (&**picture, *quality));
        self.observer.frame(&FramePictures { index, machine: &machine, exact })
    }

    /// Compares the earlier pictures of a frame with the last one, and returns the number of the last one.
    fn compare_rounds(&mut self, frame: u32, last: &RgbPicture) -> Result<u32, SizeMismatch> {
        let (own, others) = std::mem::take(&mut self.rounds).into_iter().partition(|(of, _)| *of == frame);
        self.rounds = others;
        let own: Vec<(u32, RgbPicture)> = own;
        let rest: usize = self.rounds.iter().map(|(_, picture)| picture.rgb.len()).sum();
        self.rounds_held.shrink_to(memory_estimates::WAITING_PIXEL * rest as u64);
        for (round, (_, picture)) in (0..).zip(&own) {
            let psnr_db = basrelief_report::number::round6(metrics::psnr(last, picture)?);
            self.shown.push(PictureRecord { frame, round, psnr_db, last: false });
        }
        let round = own.len() as u32;
        self.shown.push(PictureRecord { frame, round, psnr_db: metrics::IDENTICAL_DB, last: true });
        Ok(round)
    }
}

/// Converts a finished frame to a picture.
fn picture(frame: FinishedFrame) -> RgbPicture {
    RgbPicture::drawn([frame.width, frame.height], frame.rgb, frame.covered)
}
