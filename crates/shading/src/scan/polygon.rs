//! Traversal of a polygon, triangle by triangle of its fan.

use super::{RasterGrid, RasterTriangle, TriangleEdges, TriangleWalk, doubled_grid_area, snap};
use crate::fan_triangle;
use basrelief_signals::MapInline as _;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};

/// Returns the number of triangles of the polygon's fan.
pub fn fan_triangles(polygon: &Polygon) -> u16 {
    u16::try_from(polygon.vertices.len().saturating_sub(2)).unwrap_or(u16::MAX)
}

/// Winding of a polygon on the sub-pixel grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PolygonWinding {
    /// +-1, or 0 for a polygon without area.
    sign: i64,
    /// True if triangles of its fan overlap.
    pub(super) folded: bool,
}

impl PolygonWinding {
    pub(super) fn of(polygon: &Polygon, bits: u32) -> Self {
        let area = |t| fan_triangle(polygon, t).map_or(0, |v| doubled_grid_area(v.map_inline(|v| snap(v, bits))));
        let (positive, negative) = (0..fan_triangles(polygon)).map(area).fold((0i64, 0i64), |(p, n), a| {
            // A damaged trace can wind so often that the sum would overflow.
            (p.saturating_add(a.max(0)), n.saturating_add(a.min(0)))
        });
        Self { sign: (positive + negative).signum(), folded: positive > 0 && negative < 0 }
    }

    /// Returns the first triangle of the fan, from number `from` on, that has pixels.
    pub(super) fn triangle(self, polygon: &Polygon, from: u16, raster: RasterGrid) -> Option<RasterTriangle> {
        (from..fan_triangles(polygon)).find_map(|t| RasterTriangle::new(fan_triangle(polygon, t)?, t, self.sign, raster))
    }

    /// Returns true if a pixel of a folded polygon belongs to `triangle`. Triangles of such a fan overlap. A pixel is inside if
    /// more triangles wind with the polygon than against it, and it belongs to the first that winds with the polygon.
    pub(super) fn gives(self, polygon: &Polygon, bits: u32, triangle: u16, [x, y]: [i32; 2]) -> bool {
        let covers = |t, sign| {
            let edges = fan_triangle(polygon, t).and_then(|v| TriangleEdges::new(v.map_inline(|v| snap(v, bits)), sign, bits));
            edges.is_some_and(|e| e.covers(x, y))
        };
        let with = |t: &u16| covers(*t, self.sign);
        let against = |t: &u16| covers(*t, -self.sign);
        let all = 0..fan_triangles(polygon);
        let first = all.clone().find(with);
        first == Some(triangle) && all.clone().filter(with).count() > all.filter(against).count()
    }
}

/// Traversal of a polygon. Its position is a pixel, or the end.
///
/// Fill rule: a pixel belongs to a polygon if its centre lies inside, or on a top or left edge. Polygons that share an edge
/// neither share nor miss a pixel of it, even if snapping to the sub-pixel grid has made one slightly concave. The winding of a
/// polygon is that of its snapped outline. A polygon without area has no pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PolygonScan {
    raster: RasterGrid,
    winding: PolygonWinding,
    /// Number of the next triangle of the fan.
    next_triangle: u16,
    /// Traversal of the current triangle, which stands on the current pixel.
    pub walk: TriangleWalk,
}

impl PolygonScan {
    /// Creates a traversal that stands in front of the first pixel of `polygon`.
    pub fn new(polygon: &Polygon, raster: RasterGrid) -> Self {
        Self { raster, winding: PolygonWinding::of(polygon, raster.bits), next_triangle: 0, walk: TriangleWalk::default() }
    }

    /// Advances to the next pixel of `polygon`, the polygon passed to [`PolygonScan::new`]. Returns false past the last pixel.
    #[inline]
    pub fn advance(&mut self, polygon: &Polygon) -> bool {
        loop {
            while self.walk.advance() {
                if !self.winding.folded || self.owns_pixel(polygon) {
                    return true;
                }
            }
            if !self.enter_triangle(polygon) {
                return false;
            }
        }
    }

    /// Returns the number of the current triangle in the polygon's fan.
    #[inline]
    pub fn triangle(&self) -> u16 {
        self.walk.triangle.number()
    }

    /// Sets up the next triangle of the fan that has pixels.
    fn enter_triangle(&mut self, polygon: &Polygon) -> bool {
        let Some(triangle) = self.winding.triangle(polygon, self.next_triangle, self.raster) else { return false };
        self.next_triangle = triangle.number() + 1;
        self.walk = TriangleWalk::new(triangle, self.raster);
        true
    }

    fn owns_pixel(&self, polygon: &Polygon) -> bool {
        self.winding.gives(polygon, self.raster.bits, self.triangle(), self.walk.pixel())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Vertex;
    use proptest::prelude::*;
    use std::sync::Arc;

    fn visited(polygon: &Polygon, block: u32, columns: bool) -> Vec<(u16, [i32; 2])> {
        let mut scan = PolygonScan::new(polygon, RasterGrid { columns, ..RasterGrid::new([60, 40], 8, 24, block) });
        std::iter::from_fn(|| scan.advance(polygon).then(|| (scan.triangle(), scan.walk.pixel()))).collect()
    }

    fn sorted(pixels: &[(u16, [i32; 2])], key: impl Fn([i32; 2]) -> [i32; 4]) -> Vec<(u16, [i32; 2])> {
        let mut sorted = pixels.to_vec();
        sorted.sort_by_key(|(triangle, pixel)| (*triangle, key(*pixel)));
        sorted
    }

    proptest! {
        #[test]
        fn each_traversal_order_visits_the_same_pixels(
            corners in prop::collection::vec([-9f32..70.0, -9f32..50.0], 3..7), block in 1u32..=8,
        ) {
            let vertices = corners.iter().map(|&[x, y]| Vertex { position: [x, y, 0.5, 1.0], ..Vertex::default() }).collect();
            let polygon = Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: false, arrival: 0 };
            let (rows, b) = (visited(&polygon, 1, false), block as i32);
            prop_assert_eq!(&rows, &sorted(&rows, |[x, y]| [y, x, 0, 0]));
            prop_assert_eq!(visited(&polygon, block, false), sorted(&rows, |[x, y]| [y / b, x / b, y, x]));
            prop_assert_eq!(visited(&polygon, block, true), sorted(&rows, |[x, y]| [x / b, y / b, x, y]));
        }
    }
}
