//! Measured distance between a pixel and the exact position of its texel.

use crate::signals::Uvw;
use serde::{Deserialize, Serialize};

/// Displacements of all pixels \[pixels\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplacementStats {
    /// Largest displacement.
    pub largest: f64,
    /// Sum of the displacements.
    pub sum: f64,
    /// Number of pixels.
    pub pixels: u64,
}

impl DisplacementStats {
    /// Adds the displacement of a pixel.
    #[inline]
    pub fn add(&mut self, displacement: f64) {
        self.largest = self.largest.max(displacement);
        self.sum += displacement;
        self.pixels += 1;
    }

    /// Returns the mean displacement.
    pub fn mean(&self) -> f64 {
        if self.pixels == 0 { 0.0 } else { self.sum / self.pixels as f64 }
    }
}

/// Returns the distance \[pixels\] along the scan line between a pixel and the position at which the exact mapping has the
/// pixel's coordinate.
///
/// At pixel 0, U, V, W are `exact` and change by `step` per pixel. The pixel received the coordinate `got` for axis `i` (0: u, 1:
/// v). From `got (W + d dW) = U + d dU` follows d. The caller should pass the coordinate that changes more. A constant coordinate
/// gives no information, and the result is 0.
#[inline]
pub fn displacement(got: f64, exact: &Uvw, step: &Uvw, i: usize) -> f64 {
    let (ahead, rate) = (got * exact[2] - exact[i], step[i] - got * step[2]);
    // Without `if`: the quotient is computed in both cases.
    let distance = (ahead / rate).abs();
    if rate == 0.0 { 0.0 } else { distance }
}
