//! The largest regression, and counted figures that cannot be judged. The parent module lists the figures that count.

use super::comparison::{LargestRegression, UnjudgedFigure, Verdict};
use crate::model::{Memory, PictureQuality, Report};
use crate::number::{round6, thousands};
use basrelief_reference::QualityMetrics;
use indexmap::IndexMap;

/// Reason for a figure that report B lacks.
const LACKS: &str = "A has it and B lacks it";

pub(super) fn verdict(a: &Report, b: &Report, equal: bool) -> Verdict {
    let mut judge = VerdictBuilder(Verdict::default());
    for (name, report) in [("A", a), ("B", b)] {
        if !report.outcome.is_complete() {
            judge.reject("outcome", format!("run {name} did not finish ({})", report.outcome.kind.name()));
        }
    }
    if a.cycles.is_none() && a.memories.is_none() && a.quality.is_none() && !equal {
        judge.reject("report", "A has neither cycles nor bytes nor quality");
    }
    judge.cycles(a, b);
    judge.bytes(a, b);
    judge.quality(a.quality.as_ref(), b.quality.as_ref());
    judge.0
}

struct VerdictBuilder(Verdict);

impl VerdictBuilder {
    fn reject(&mut self, figure: impl Into<String>, reason: impl Into<String>) {
        self.0.unjudged.push(UnjudgedFigure { figure: figure.into(), reason: reason.into() });
    }

    fn regression(&mut self, what: String, percent: f64, db: Option<f64>) {
        let percent = round6(percent);
        if percent > self.0.worst.percent {
            self.0.worst = LargestRegression { percent, what, db: db.map(round6) };
        }
    }

    /// Judges a count that should not grow.
    fn growth(&mut self, what: String, before: u64, after: u64) {
        match before {
            _ if after <= before => {}
            0 => self.reject(what, format!("it grew from 0 to {}, and 0 has no percentage", thousands(after))),
            _ => self.regression(what, 100.0 * (after - before) as f64 / before as f64, None),
        }
    }

    /// Rejects a list of frames that is shorter in B.
    fn frames(&mut self, what: &str, [before, after]: [usize; 2]) {
        if after < before {
            self.reject(what, format!("A has {before} frames and B has {after}"));
        }
    }

    fn cycles(&mut self, a: &Report, b: &Report) {
        let Some(a) = &a.cycles else { return };
        let Some(b) = &b.cycles else { return self.reject("cycles", LACKS) };
        self.growth("cycles.total".into(), a.total, b.total);
        self.frames("cycles.frames", [a.frames.len(), b.frames.len()]);
        for (k, (before, after)) in a.frames.iter().zip(&b.frames).enumerate() {
            self.growth(format!("cycles.frames[{k}]"), *before, *after);
        }
    }

    fn bytes(&mut self, a: &Report, b: &Report) {
        let Some(a) = &a.memories else { return };
        let Some(b) = &b.memories else { return self.reject("memories", LACKS) };
        let (a, b) = (bytes_of_clients(a), bytes_of_clients(b));
        for what in a.keys().filter(|what| !b.contains_key(*what)) {
            self.reject(what, LACKS);
        }
        for (what, after) in b {
            let before = a.get(&what).copied().unwrap_or(0);
            self.growth(what, before, after);
        }
    }

    fn quality(&mut self, a: Option<&PictureQuality>, b: Option<&PictureQuality>) {
        let Some(a) = a else { return };
        let Some(b) = b else { return self.reject("quality", LACKS) };
        self.picture("quality", &a.last, &b.last);
        self.frames("quality.frames", [a.frames.len(), b.frames.len()]);
        for (k, (before, after)) in a.frames.iter().zip(&b.frames).enumerate() {
            self.picture(&format!("quality.frames[{k}]"), before, after);
        }
    }

    /// Judges one picture: PSNR relative to A, SSIM and FLIP in hundredths.
    fn picture(&mut self, place: &str, a: &QualityMetrics, b: &QualityMetrics) {
        let ssim = ("ssim", a.ssim, b.ssim, 100.0 * (a.ssim - b.ssim));
        let flip = ("flip", a.flip, b.flip, 100.0 * (b.flip - a.flip));
        let psnr = ("psnr_db", a.psnr_db, b.psnr_db, 100.0 * (a.psnr_db - b.psnr_db) / a.psnr_db);
        for (name, before, after, percent) in [psnr, ssim, flip] {
            let what = format!("{place}.{name}");
            match [("A", before), ("B", after)].into_iter().find(|(_, value)| !value.is_finite()) {
                Some((side, value)) => self.reject(what, format!("it is {value} in {side}")),
                // Without loss there is nothing to divide.
                None if name == "psnr_db" && after >= before => {}
                None if name == "psnr_db" && before <= 0.0 => {
                    self.reject(what, format!("it fell from {before} to {after} dB, and {before} has no percentage"));
                }
                None => self.regression(what, percent, (name == "psnr_db").then_some(before - after)),
            }
        }
    }
}

/// Returns the bytes that each memory client moved, by the name of the figure.
fn bytes_of_clients(memories: &IndexMap<String, Memory>) -> IndexMap<String, u64> {
    let clients = memories.iter().flat_map(|(memory, m)| m.clients.iter().map(move |(name, client)| (memory, name, client)));
    clients.map(|(memory, name, client)| (format!("bytes of memories.{memory}.clients.{name}"), client.moved_bytes)).collect()
}

#[cfg(test)]
mod tests {
    use crate::compare::{Comparison, compare};
    use crate::model::{OutcomeKind, PictureQuality, Report};
    use crate::samples;
    use basrelief_reference::QualityMetrics;

    /// A report with the quality of three frames.
    fn several_frames() -> Report {
        let mut report = samples::balanced();
        let quality = report.quality.as_mut().unwrap();
        quality.frames = [30.0, 27.9, quality.last.psnr_db].map(|psnr_db| QualityMetrics { psnr_db, ..quality.last }).into();
        report
    }

    fn changed(change: impl FnOnce(&mut Report)) -> Comparison {
        let a = several_frames();
        let mut b = a.clone();
        change(&mut b);
        compare(&a, &b, None)
    }

    fn worse(change: impl FnOnce(&mut Report)) -> (f64, String) {
        let comparison = changed(change);
        assert_eq!(comparison.verdict.unjudged, []);
        (comparison.verdict.worst.percent, comparison.verdict.worst.what)
    }

    /// The figures that cannot be judged.
    fn unjudged(change: impl FnOnce(&mut Report)) -> Vec<String> {
        let comparison = changed(change);
        assert!(!comparison.failures(f64::MAX).is_empty(), "no limit lets them pass");
        assert!(!comparison.to_text(crate::TextStyle::default()).contains("No regression"));
        comparison.verdict.unjudged.into_iter().map(|u| format!("{}: {}", u.figure, u.reason)).collect()
    }

    #[test]
    fn cycles_bytes_and_quality_count() {
        assert_eq!(worse(|b| b.cycles.as_mut().unwrap().total += 10_000), (1.0, "cycles.total".into()));
        assert_eq!(worse(|b| b.cycles.as_mut().unwrap().frames[1] += 4_800), (1.0, "cycles.frames[1]".into()));
        let client = |b: &mut Report| b.memories.as_mut().unwrap()["graphics"].clients["z"].moved_bytes += 960_000;
        assert_eq!(worse(client), (50.0, "bytes of memories.graphics.clients.z".into()));
        assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.psnr_db = 33.0), (20.0, "quality.psnr_db".into()));
        assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.flip += 0.02), (2.0, "quality.flip".into()));
    }

    #[test]
    fn every_frame_counts() {
        let (percent, what) = worse(|b| b.quality.as_mut().unwrap().frames[1].psnr_db = 5.0);
        assert_eq!((percent.round(), what.as_str()), (82.0, "quality.frames[1].psnr_db"));
        let (percent, what) = worse(|b| b.quality.as_mut().unwrap().frames[1].ssim -= 0.25);
        assert_eq!((percent.round(), what.as_str()), (25.0, "quality.frames[1].ssim"));
    }

    #[test]
    fn improvements_do_not_count() {
        assert_eq!(worse(|b| b.cycles.as_mut().unwrap().total -= 10_000).0, 0.0);
        assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.ssim = 1.0).0, 0.0);
        assert_eq!(worse(|b| b.units.as_mut().unwrap()["replacement"].busy += 10_000).0, 0.0);
    }

    #[test]
    fn incomplete_run_passes_no_limit() {
        assert_eq!(unjudged(|b| b.outcome.kind = OutcomeKind::Deadlock), ["outcome: run B did not finish (deadlock)"]);
        let (a, b) = (samples::deadlocked(), samples::balanced());
        assert!(compare(&a, &b, None).failures(f64::MAX)[0].contains("run A did not finish (deadlock)"));
    }

    #[test]
    fn figure_missing_in_b_passes_no_limit() {
        assert_eq!(unjudged(|b| b.quality = None), ["quality: A has it and B lacks it"]);
        let functional = |b: &mut Report| *b = Report { quality: b.quality.clone(), ..samples::functional() };
        assert_eq!(unjudged(functional), ["cycles: A has it and B lacks it", "memories: A has it and B lacks it"]);
        let client = |b: &mut Report| drop(b.memories.as_mut().unwrap()["graphics"].clients.shift_remove("z"));
        assert_eq!(unjudged(client), ["bytes of memories.graphics.clients.z: A has it and B lacks it"]);
        let memory = |b: &mut Report| drop(b.memories.as_mut().unwrap().shift_remove("graphics"));
        assert_eq!(unjudged(memory).len(), 2);
    }

    #[test]
    fn fewer_frames_pass_no_limit() {
        let cycles = |b: &mut Report| b.cycles.as_mut().unwrap().frames.truncate(1);
        assert_eq!(unjudged(cycles), ["cycles.frames: A has 2 frames and B has 1"]);
        let quality = |b: &mut Report| b.quality.as_mut().unwrap().frames.truncate(2);
        assert_eq!(unjudged(quality), ["quality.frames: A has 3 frames and B has 2"]);
        assert_eq!(unjudged(|b| b.quality.as_mut().unwrap().frames.clear()).len(), 1);
    }

    #[test]
    fn value_that_is_no_number_is_named() {
        let nan = |b: &mut Report| b.quality.as_mut().unwrap().frames[1].psnr_db = f64::NAN;
        assert_eq!(unjudged(nan), ["quality.frames[1].psnr_db: it is NaN in B"]);
        let infinite = |b: &mut Report| b.quality.as_mut().unwrap().last.ssim = f64::INFINITY;
        assert_eq!(unjudged(infinite), ["quality.ssim: it is inf in B"]);
        let a = Report { quality: Some(quality_of(f64::NAN)), ..samples::balanced() };
        assert!(
            compare(&a, &samples::balanced(), None).failures(f64::MAX)[0]
                .contains("quality.psnr_db cannot be judged: it is NaN in A")
        );
    }

    fn quality_of(psnr_db: f64) -> PictureQuality {
        let last = QualityMetrics { psnr_db, ssim: 0.5, flip: 0.5 };
        PictureQuality::of(&[last], None).unwrap()
    }

    #[test]
    fn change_from_zero_passes_no_limit() {
        let new = |b: &mut Report| {
            let clients = &mut b.memories.as_mut().unwrap()["graphics"].clients;
            let like = clients["z"].clone();
            clients.insert("new".into(), like);
        };
        assert_eq!(
            unjudged(new),
            ["bytes of memories.graphics.clients.new: it grew from 0 to 1,920,000, and 0 has no percentage"]
        );
        let of = |psnr_db: f64| Report { quality: Some(quality_of(psnr_db)), ..samples::functional() };
        assert!(
            compare(&of(0.0), &of(-1.0), None).failures(f64::MAX)[0]
                .contains("quality.psnr_db cannot be judged: it fell from 0 to -1 dB")
        );
        assert_eq!(compare(&of(0.0), &of(1.0), None).failures(0.0), [""; 0]);
    }

    #[test]
    fn reports_without_counted_figures_fail() {
        let bare = |machine: &str| Report { quality: None, machine: machine.into(), ..samples::functional() };
        let failures = compare(&bare("a"), &bare("b"), None).failures(f64::MAX);
        assert_eq!(failures, ["report cannot be judged: A has neither cycles nor bytes nor quality"]);
        assert_eq!(compare(&bare("a"), &bare("a"), None).failures(0.0), [""; 0]);
    }

    #[test]
    fn failure_names_figure_and_limit() {
        let comparison = changed(|b| b.cycles.as_mut().unwrap().total += 10_000);
        assert_eq!(comparison.failures(0.5), ["cycles.total got worse by 1 %; the limit is 0.5 %"]);
        assert_eq!(comparison.failures(1.0), [""; 0]);
    }
}
