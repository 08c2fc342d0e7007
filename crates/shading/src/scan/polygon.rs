//! Traversal of a polygon: triangle by triangle of its fan.

use super::{Edges, Raster, Triangle, Walk, doubled_grid_area, snap};
use crate::fan_triangle;
use basrelief_signals::Polygon;
use serde::{Deserialize, Serialize};

/// Triangles of the polygon's fan.
pub fn fan_triangles(polygon: &Polygon) -> u16 {
    u16::try_from(polygon.vertices.len().saturating_sub(2)).unwrap_or(u16::MAX)
}

/// Where the traversal of a polygon is: on a pixel, or past the last.
///
/// Fill rule: a pixel belongs to a polygon when its centre lies inside, or on a top or left edge. Polygons that share an
/// edge neither share nor miss a pixel of it, also where snapping to the sub-pixel grid has made one slightly concave.
/// A polygon's winding is that of its snapped outline; one without area has no pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scan {
    raster: Raster,
    /// Winding of the polygon on the sub-pixel grid, +-1; 0 without area.
    winding: i64,
    /// Triangles of its fan overlap.
    folded: bool,
    /// Number of the triangle of its fan that comes next.
    next_triangle: u16,
    /// Traversal of the current triangle; stands on the current pixel.
    pub walk: Walk,
}

impl Scan {
    /// In front of the first pixel of `polygon`.
    pub fn new(polygon: &Polygon, raster: Raster) -> Self {
        let area = |t| fan_triangle(polygon, t).map_or(0, |v| doubled_grid_area(v.map(|v| snap(v, raster.bits))));
        let (positive, negative) = (0..fan_triangles(polygon)).map(area).fold((0i64, 0i64), |(p, n), a| {
            // A damaged trace can wind so often that the sum leaves the range.
            (p.saturating_add(a.max(0)), n.saturating_add(a.min(0)))
        });
        let (winding, folded) = ((positive + negative).signum(), positive > 0 && negative < 0);
        Self { raster, winding, folded, next_triangle: 0, walk: Walk::default() }
    }

    /// On to the next pixel of `polygon`, which must be that of [`Scan::new`]; false past the last.
    #[inline]
    pub fn advance(&mut self, polygon: &Polygon) -> bool {
        loop {
            while self.walk.advance() {
                if !self.folded || self.owns_pixel(polygon) {
                    return true;
                }
            }
            if !self.enter_triangle(polygon) {
                return false;
            }
        }
    }

    /// Number of the current triangle in the polygon's fan.
    #[inline]
    pub fn triangle(&self) -> u16 {
        self.walk.triangle.number()
    }

    /// Sets up the next triangle of the fan that has pixels.
    fn enter_triangle(&mut self, polygon: &Polygon) -> bool {
        let set_up = |t| Triangle::new(fan_triangle(polygon, t)?, t, self.winding, self.raster);
        let Some(triangle) = (self.next_triangle..fan_triangles(polygon)).find_map(set_up) else { return false };
        self.next_triangle = triangle.number() + 1;
        self.walk = Walk::new(triangle, self.raster.block);
        true
    }

    /// In a folded polygon, triangles of the fan overlap: a pixel is inside where more of them wind with the polygon
    /// than against it, and it goes to the first that winds with it.
    fn owns_pixel(&self, polygon: &Polygon) -> bool {
        let [x, y] = self.walk.pixel();
        let bits = self.raster.bits;
        let covers = |t, sign| {
            let edges = fan_triangle(polygon, t).and_then(|v| Edges::new(v.map(|v| snap(v, bits)), sign, bits));
            edges.is_some_and(|e| e.covers(x, y))
        };
        let with = |t: &u16| covers(*t, self.winding);
        let against = |t: &u16| covers(*t, -self.winding);
        let all = 0..fan_triangles(polygon);
        let first = all.clone().find(with);
        first == Some(self.triangle()) && all.clone().filter(with).count() > all.filter(against).count()
    }
}
