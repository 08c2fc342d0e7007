//! How far the texel of a pixel is from its place: measured, not promised.

use crate::signals::Uvw;
use serde::{Deserialize, Serialize};

/// Displacements of all pixels \[pixels\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Displacements {
    /// Largest.
    pub largest: f64,
    /// Sum.
    pub sum: f64,
    /// Pixels.
    pub pixels: u64,
}

impl Displacements {
    /// Adds a pixel's.
    #[inline]
    pub fn add(&mut self, displacement: f64) {
        self.largest = self.largest.max(displacement);
        self.sum += displacement;
        self.pixels += 1;
    }

    /// Mean.
    pub fn mean(&self) -> f64 {
        if self.pixels == 0 { 0.0 } else { self.sum / self.pixels as f64 }
    }
}

/// Where on its scan line the exact mapping has what a pixel got: as far from the pixel as this \[pixels\].
///
/// At pixel 0, U, V, W are `exact` and change by `step` per pixel; the coordinate `i` (0: u, 1: v) that it got is `got`. From
/// `got (W + d dW) = U + d dU` follows d. Of the two coordinates the one that changes more should be asked: one that is
/// constant tells nothing, and gives 0.
#[inline]
pub fn displacement(got: f64, exact: &Uvw, step: &Uvw, i: usize) -> f64 {
    let (ahead, rate) = (got * exact[2] - exact[i], step[i] - got * step[2]);
    // No `if`: the quotient is formed either way.
    let distance = (ahead / rate).abs();
    if rate == 0.0 { 0.0 } else { distance }
}
