//! Traversal of a polygon scan line by scan line, one span at a time.

use super::polygon::PolygonWinding;
use super::{MAX_BLOCK, RasterGrid, RasterTriangle};
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};

/// Spans of a polygon. A span is a run of pixels on a scan line that belong to one triangle of the fan. The spans cover the
/// pixels that [`PolygonScan`](super::PolygonScan) visits, triangle by triangle, top to bottom and left to right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PolygonSpans {
    raster: RasterGrid,
    winding: PolygonWinding,
    /// Triangle being scanned.
    pub triangle: RasterTriangle,
    /// Number of the next triangle of the fan.
    next_triangle: u16,
    /// Spans of the rows from `top` on.
    rows: [[i32; 2]; MAX_BLOCK],
    top: i32,
    /// Current row.
    y: i32,
    /// Rest of the current row: the first column, and the column behind the last.
    left: [i32; 2],
}

impl PolygonSpans {
    /// Creates a traversal that stands in front of the first span of `polygon`.
    pub fn new(polygon: &Polygon, raster: RasterGrid) -> Self {
        Self { raster, winding: PolygonWinding::of(polygon, raster.bits), ..Self::default() }
    }

    /// Returns row, first and last column of the next span of `polygon`, the polygon passed to [`PolygonSpans::new`].
    pub fn next(&mut self, polygon: &Polygon) -> Option<[i32; 3]> {
        loop {
            if self.left[0] < self.left[1] {
                let first = self.left[0];
                let last = if self.winding.folded { self.owned(polygon) } else { Some([first, self.left[1] - 1]) };
                let Some([first, last]) = last else {
                    self.left[0] = self.left[1];
                    continue;
                };
                self.left[0] = last + 1;
                return Some([self.y, first, last]);
            }
            if !self.next_row() && !self.enter_triangle(polygon) {
                return None;
            }
        }
    }

    /// Returns the first and last column of the next run that belongs to the triangle.
    fn owned(&self, polygon: &Polygon) -> Option<[i32; 2]> {
        let owns = |x: &i32| self.winding.gives(polygon, self.raster.bits, self.triangle.number(), [*x, self.y]);
        let first = (self.left[0]..self.left[1]).find(owns)?;
        Some([first, (first..self.left[1]).take_while(owns).last()?])
    }

    fn next_row(&mut self) -> bool {
        self.y += 1;
        if self.y >= self.triangle.bounds.y[1] {
            return false;
        }
        if self.y >= self.top + MAX_BLOCK as i32 {
            self.top = self.y;
            self.triangle.spans(self.top, MAX_BLOCK as i32, &mut self.rows);
        }
        self.left = self.rows[(self.y - self.top) as usize];
        true
    }

    fn enter_triangle(&mut self, polygon: &Polygon) -> bool {
        let Some(triangle) = self.winding.triangle(polygon, self.next_triangle, self.raster) else { return false };
        self.next_triangle = triangle.number() + 1;
        self.y = triangle.bounds.y[0] - 1;
        self.top = self.y + 1 - MAX_BLOCK as i32;
        self.left = [0, 0];
        self.triangle = triangle;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolygonScan;
    use basrelief_signals::Vertex;
    use proptest::prelude::*;
    use std::sync::Arc;

    proptest! {
        #[test]
        fn spans_cover_exactly_the_scanned_pixels(
            corners in prop::collection::vec([-9f32..70.0, -9f32..50.0], 3..7),
        ) {
            let vertices = corners.iter().map(|&[x, y]| Vertex { position: [x, y, 0.5, 1.0], ..Vertex::default() }).collect();
            let polygon = Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: false, arrival: 0 };
            let raster = RasterGrid::new([60, 40], 8, 24, 1);
            let (mut scan, mut spans) = (PolygonScan::new(&polygon, raster), PolygonSpans::new(&polygon, raster));
            let (mut expected, mut covered) = (Vec::new(), Vec::new());
            while scan.advance(&polygon) {
                expected.push((scan.triangle(), scan.walk.pixel()));
            }
            while let Some([y, first, last]) = spans.next(&polygon) {
                prop_assert!(first <= last);
                covered.extend((first..=last).map(|x| (spans.triangle.number(), [x, y])));
            }
            prop_assert_eq!(covered, expected);
        }
    }
}
