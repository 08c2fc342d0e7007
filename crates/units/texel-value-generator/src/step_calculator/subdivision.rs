//! Child polygons (Figure 1).

use crate::signals::ScanSpan;
use basrelief_shading::fan_triangle;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};

/// Division of a triangle by lines parallel to its edges into n x n equal child polygons, whose edges are at most `interval`
/// pixels long. Pixels of a scan line between two of these lines are interpolated between exact ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChildSubdivision {
    triangle: Option<u16>,
    /// Number of parts n per edge.
    parts: f64,
}

impl ChildSubdivision {
    /// Forgets the triangle.
    pub fn forget(&mut self) {
        self.triangle = None;
    }

    /// Sets up the polygon's triangle that contains the span.
    pub fn enter(&mut self, polygon: Option<&Polygon>, triangle: u16, interval: u32) {
        if self.triangle == Some(triangle) {
            return;
        }
        let corners = polygon.and_then(|p| fan_triangle(p, triangle)).map(|v| v.map(|v| [v.position[0], v.position[1]]));
        let length = |a: [f32; 2], b: [f32; 2]| {
            let [x, y] = [0, 1].map(|i| f64::from(a[i]) - f64::from(b[i]));
            (x * x + y * y).sqrt()
        };
        let longest = corners.map_or(0.0, |[a, b, c]| length(a, b).max(length(b, c)).max(length(c, a)));
        self.parts = (longest / f64::from(interval.max(1))).ceil().clamp(1.0, 65_536.0);
        self.triangle = Some(triangle);
    }

    /// Returns the last pixel of the span that lies in the same child polygon as pixel `k`.
    pub fn last_with(&self, span: &ScanSpan, k: u16) -> u16 {
        let per_pixel = 1.0 / f64::from(span.last().max(1));
        let line = |i: usize| {
            let ends = span.weights.map(|[b, c]| [1.0 - f64::from(b) - f64::from(c), f64::from(b), f64::from(c)][i] * self.parts);
            (ends[0], (ends[1] - ends[0]) * per_pixel)
        };
        let mut last = span.last();
        for (start, step) in [0, 1, 2].map(line) {
            let at = |k: u16| (start + f64::from(k) * step).floor();
            let here = at(k);
            let to_line = if step > 0.0 { here + 1.0 - start } else { here - start };
            // The crossing of the line, within one pixel of rounding.
            let crossing = if step == 0.0 { f64::from(last) } else { to_line / step };
            let mut candidate = (crossing.clamp(f64::from(k), f64::from(last)) as u16).min(last);
            while candidate < last && at(candidate + 1) == here {
                candidate += 1;
            }
            while candidate > k && at(candidate) != here {
                candidate -= 1;
            }
            last = last.min(candidate);
        }
        last
    }
}
