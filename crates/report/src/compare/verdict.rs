//! The largest regression, and counted figures that cannot be judged. The parent module lists the figures that count.

use super::comparison::{LargestRegression, UnjudgedFigure, Verdict};
use super::time::Clocks;
use crate::model::{Cycles, Memory, PictureQuality, Report};
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

/// Cycles of the finished frames of A and B.
struct FrameCycles {
    by_frame: [Vec<u64>; 2],
    /// Name of the cycles of a frame.
    name: fn(usize) -> String,
}

impl FrameCycles {
    /// The cycles of each frame that both runs have, with their name.
    fn pairs(&self) -> impl Iterator<Item = (String, u64, u64)> {
        let [a, b] = &self.by_frame;
        a.iter().zip(b).enumerate().map(|(k, (before, after))| ((self.name)(k), *before, *after))
    }
}

/// Returns the name of the cycles of a frame, counted from 0: their entry of the reports, unless that has the cycles of a picture.
fn frame_name(reports: [&Report; 2]) -> fn(usize) -> String {
    match reports.iter().all(|report| report.picture_term() == "frame") {
        true => |k| format!("cycles.frames[{k}]"),
        false => |k| format!("cycles of frame {}", k + 1),
    }
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

    /// Judges cycles, or times if the clocks differ.
    fn cycles(&mut self, a: &Report, b: &Report) {
        let (clocks, ms) = (Clocks::of(a, b), a.frame_ms().zip(b.frame_ms()));
        let frames = FrameCycles { by_frame: [a, b].map(Report::cycles_of_frames), name: frame_name([a, b]) };
        let Some(a) = &a.cycles else { return };
        let Some(b) = &b.cycles else { return self.reject("cycles", LACKS) };
        self.frames("cycles.frames", frames.by_frame.each_ref().map(Vec::len));
        match clocks {
            Clocks::Differ([hz_a, hz_b]) => return self.times(ms, [a, b], &frames, hz_a / hz_b),
            Clocks::OnlyInA => self.reject("config.clock.hz", LACKS),
            Clocks::OnlyInB | Clocks::Same => {}
        }
        self.growth("cycles.total".into(), a.total, b.total);
        for (name, before, after) in frames.pairs() {
            self.growth(name, before, after);
        }
    }

    /// Judges times. `frame_ms`: mean times of a frame; `scale`: the clock of A divided by that of B.
    fn times(&mut self, frame_ms: Option<(f64, f64)>, [a, b]: [&Cycles; 2], frames: &FrameCycles, scale: f64) {
        if let Some((before, after)) = frame_ms {
            self.slowdown("derived.frame_ms".into(), before, after, 1.0);
        }
        self.slowdown("derived.time_ms".into(), a.total as f64, b.total as f64, scale);
        for (name, before, after) in frames.pairs() {
            self.slowdown(format!("time of {name}"), before as f64, after as f64, scale);
        }
    }

    /// Judges a time, given in cycles of the two clocks.
    fn slowdown(&mut self, what: String, before: f64, after: f64, scale: f64) {
        let percent = 100.0 * (after / before * scale - 1.0);
        match after {
            0.0 => {}
            _ if percent.is_finite() => self.regression(what, percent, None),
            _ => self.reject(what, "its change has no percentage"),
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
mod tests;
