//! The scan of a polygon's dots, as both circuits and process 24 make it: the same dots in the same order.

use basrelief_shading::{Gradient, Raster, Scan};
use basrelief_signals::{Fragment, Polygon};
use serde::{Deserialize, Serialize};

/// A polygon part-way: stands on a dot, or past the last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dots {
    scan: Scan,
    more: bool,
}

impl Dots {
    /// On the first dot of `polygon`.
    pub(crate) fn new(polygon: &Polygon, raster: Raster) -> Self {
        let mut scan = Scan::new(polygon, raster);
        let more = scan.advance(polygon);
        Self { scan, more }
    }

    /// The dot, its weights those of equation (6); none past the last.
    #[inline]
    pub(crate) fn next(&mut self, polygon: &Polygon) -> Option<Fragment> {
        if !self.more {
            return None;
        }
        let dot = self.scan.walk.linear_fragment();
        self.more = self.scan.advance(polygon);
        Some(dot)
    }
}

/// Three numbers at the corners of a triangle of the fan, interpolated with the weights of equation (6).
///
/// With (alpha, beta, gamma) of a scan line through edges P1P2 and P1P3, the weights of P2 and P3 are (1-alpha)*gamma and
/// (1-beta)*(1-gamma), and P1 has the rest: these are the shares of the triangle's area that lie opposite the corners,
/// whichever edges the line cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Corners {
    /// Number of the triangle, counted from 1; 0: none yet.
    triangle: u32,
    values: [[f32; 3]; 3],
}

impl Corners {
    /// Values at `dot`; those of all sample points are `points`.
    #[inline]
    pub(crate) fn at(&mut self, dot: &Fragment, points: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        if self.triangle != u32::from(dot.triangle) + 1 {
            let i = usize::from(dot.triangle);
            *self = Self { triangle: u32::from(dot.triangle) + 1, values: [points(0), points(i + 1), points(i + 2)] };
        }
        let [a, b, c] = &self.values;
        Gradient::new([a, b, c]).at(dot.weights)
    }
}
