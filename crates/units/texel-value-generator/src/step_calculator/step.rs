//! The step: the distance to the next division point.

use crate::config::StepForm;
use crate::fixed::down;
use serde::{Deserialize, Serialize};

/// Longest step along a scan line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepReach {
    /// To the other end: the bound holds at any distance.
    End,
    /// This many pixels, not whole.
    Pixels(f64),
}

/// Equation of the step, with all values that are constant along a scan line.
///
/// Between division points with W = wl and wr, linear interpolation gives pixel x the texel of pixel x', and
///
/// ```text
/// max |x - x'| = (sqrt(wr) - sqrt(wl))^2 / |dw|        with wr = wl + dw t
/// ```
///
/// The longest step that keeps e is therefore `t = 2 sqrt(e wl / |dw|) + e` for dw > 0, and `- e` for dw < 0, where the bound
/// holds all the way once `wl <= e |dw|`. (The patent's own equation is lost. This one depends on the same values as the patent
/// states: w, dw and e.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepEquation {
    dw: f64,
    e: f64,
    /// Quotient e / |dw|, the only division per subdivided scan line.
    ratio: f64,
}

/// Returns true if the bound holds for a segment of length `t` on which W changes from `wl` to `wr`. The test needs neither a
/// division nor a root.
///
/// ```text
/// (sqrt(wr) - sqrt(wl))^2 / |dw| <= e    exactly where    t <= e    or    W (t - e)^2 <= w (t + e)^2
/// ```
///
/// with W the larger of the two and w the smaller: two squares of lengths, two products, and a comparison.
pub fn keeps_bound(wl: f64, wr: f64, t: f64, e: f64) -> bool {
    let (small, large) = if wl < wr { (wl, wr) } else { (wr, wl) };
    let (less, more) = (t - e, t + e);
    less <= 0.0 || large * (less * less) <= small * (more * more)
}

impl StepEquation {
    /// Creates the equation for a scan line along which W changes by `dw` per pixel in the direction of marching, under the
    /// criterion `e` \[pixels\]. The quotient has `bits` bits and is never too large.
    pub fn new(dw: f64, e: f64, bits: u32) -> Self {
        let ratio = if dw == 0.0 { 0.0 } else { down(e / dw.abs(), bits) };
        Self { dw, e, ratio }
    }

    /// Returns true if the bound holds to the other end from W = `wl` on, so that no square root is needed.
    #[inline]
    pub fn is_free(&self, wl: f64) -> bool {
        self.dw == 0.0 || (self.dw < 0.0 && wl <= self.e * -self.dw)
    }

    /// Returns the longest step from W = `wl` on, by this form, with this square root.
    #[inline]
    pub fn reach(&self, wl: f64, form: StepForm, root: impl FnOnce(f64) -> f64) -> StepReach {
        if self.is_free(wl) {
            return StepReach::End;
        }
        let twice = 2.0 * root(self.ratio * wl);
        StepReach::Pixels(match form {
            StepForm::Approximate => twice,
            StepForm::Exact if self.dw > 0.0 => twice + self.e,
            StepForm::Exact => twice - self.e,
        })
    }
}

/// Returns the largest displacement of a segment of length `t` on which W changes from `wl` to `wr` \[pixels\], by the formula.
pub fn largest_displacement(wl: f64, wr: f64, t: f64) -> f64 {
    if wl == wr {
        return 0.0;
    }
    // (sqrt wr - sqrt wl)^2 / |dw| with dw = (sqrt wr - sqrt wl)(sqrt wr + sqrt wl) / t.
    let (a, b) = (wl.sqrt(), wr.sqrt());
    t * (b - a).abs() / (a + b)
}

/// Table of square roots. The roots are never too large, so that steps keep the bound and are slightly short.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RootTable {
    /// Roots of 1 .. 4 in equal parts, each of its lower end.
    entries: Vec<f64>,
}

impl RootTable {
    /// Creates a table of `entries` entries, at least 1.
    pub fn new(entries: u32) -> Self {
        let of = |i: u32| (1.0 + 3.0 * f64::from(i) / f64::from(entries.max(1))).sqrt();
        Self { entries: (0..entries.max(1)).map(of).collect() }
    }

    /// Returns the square root of `x`: its even exponent is halved, its fraction looked up. Returns 0 unless `x` is positive.
    pub fn root(&self, x: f64) -> f64 {
        if !(x > 0.0 && x.is_finite()) {
            return 0.0;
        }
        let (mut fraction, mut exponent) = libm::frexp(x);
        (fraction, exponent) = if exponent % 2 == 0 { (4.0 * fraction, exponent - 2) } else { (2.0 * fraction, exponent - 1) };
        let place = ((fraction - 1.0) * (self.entries.len() as f64 / 3.0)) as usize;
        let root = self.entries.get(place).or(self.entries.last()).copied().unwrap_or(1.0);
        libm::ldexp(root, exponent / 2)
    }

    /// Returns the largest relative error.
    pub fn largest_error(&self) -> f64 {
        let ends = (1..=self.entries.len()).map(|i| (1.0 + 3.0 * i as f64 / self.entries.len() as f64).sqrt());
        self.entries.iter().zip(ends).map(|(low, high)| 1.0 - low / high).fold(0.0, f64::max)
    }
}
