//! The step: how far the next division point may be.

use crate::config::StepForm;
use crate::fixed::down;
use serde::{Deserialize, Serialize};

/// How far a step of a scan line may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// To the other end: the bound holds however far it is.
    End,
    /// So many pixels, not whole.
    Pixels(f64),
}

/// The equation of the step, with all that is constant along a scan line.
///
/// Between division points with W = wl and wr, linear interpolation puts into pixel x the texel of pixel x', and
///
/// ```text
/// max |x - x'| = (sqrt(wr) - sqrt(wl))^2 / |dw|        with wr = wl + dw t
/// ```
///
/// so that the longest step that keeps e is `t = 2 sqrt(e wl / |dw|) + e` for dw > 0, and `- e` for dw < 0, where the bound
/// holds all the way once `wl <= e |dw|`. (The patent's own equation is lost; this one depends on what it says that the step
/// depends on: w, dw and e.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepEquation {
    dw: f64,
    e: f64,
    /// e / |dw|, the one division per scan line that is subdivided.
    ratio: f64,
}

/// Whether the bound holds for a segment from where W is `wl` to where it is `wr`, `t` pixels on: neither a division nor a root
/// is needed to tell.
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
    /// For a scan line along which W changes by `dw` per pixel in the direction of marching, under the criterion `e` \[pixels\];
    /// of the quotient so many bits are found, so that it is never too large.
    pub fn new(dw: f64, e: f64, bits: u32) -> Self {
        let ratio = if dw == 0.0 { 0.0 } else { down(e / dw.abs(), bits) };
        Self { dw, e, ratio }
    }

    /// Whether the bound holds to the other end from where W is `wl`, so that no square root is needed.
    #[inline]
    pub fn is_free(&self, wl: f64) -> bool {
        self.dw == 0.0 || (self.dw < 0.0 && wl <= self.e * -self.dw)
    }

    /// The longest step from where W is `wl`, by this form, with this square root.
    #[inline]
    pub fn reach(&self, wl: f64, form: StepForm, root: impl FnOnce(f64) -> f64) -> Reach {
        if self.is_free(wl) {
            return Reach::End;
        }
        let twice = 2.0 * root(self.ratio * wl);
        Reach::Pixels(match form {
            StepForm::Approximate => twice,
            StepForm::Exact if self.dw > 0.0 => twice + self.e,
            StepForm::Exact => twice - self.e,
        })
    }
}

/// Largest displacement of a segment from where W is `wl` to where it is `wr`, `t` pixels on \[pixels\], by the formula.
pub fn largest_displacement(wl: f64, wr: f64, t: f64) -> f64 {
    if wl == wr {
        return 0.0;
    }
    // (sqrt wr - sqrt wl)^2 / |dw| with dw = (sqrt wr - sqrt wl)(sqrt wr + sqrt wl) / t.
    let (a, b) = (wl.sqrt(), wr.sqrt());
    t * (b - a).abs() / (a + b)
}

/// Square roots from a table: never too large, so that steps from it keep the bound and are a little short.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RootTable {
    /// Roots of 1 .. 4 in equal parts, each of its lower end.
    entries: Vec<f64>,
}

impl RootTable {
    /// A table of so many entries, at least 1.
    pub fn new(entries: u32) -> Self {
        let of = |i: u32| (1.0 + 3.0 * f64::from(i) / f64::from(entries.max(1))).sqrt();
        Self { entries: (0..entries.max(1)).map(of).collect() }
    }

    /// Square root of `x`: its even exponent halved, its fraction looked up. 0 for what is not positive.
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

    /// Largest relative error.
    pub fn largest_error(&self) -> f64 {
        let ends = (1..=self.entries.len()).map(|i| (1.0 + 3.0 * i as f64 / self.entries.len() as f64).sqrt());
        self.entries.iter().zip(ends).map(|(low, high)| 1.0 - low / high).fold(0.0, f64::max)
    }
}
