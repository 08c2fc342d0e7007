//! Coverage of a triangle, and the weights of its pixels.

use crate::surface::{PixelAttributes, SurfacePoint};
use crate::texture::TextureFootprint;
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Steps per pixel to which window coordinates are snapped. Snapped coordinates make edge functions whole numbers. Coverage is
/// then decided without rounding up to 2^18 pixels from the origin, and pixels of a shared edge belong to exactly one side.
const SUBPIXEL: f64 = 256.0;

/// A vertex in window coordinates (y down).
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowCorner {
    /// Window x, y \[pixels\].
    pub window: DVec2,
    /// Depth, 0 = near.
    pub depth: f64,
    /// 1 / w of the clip-space position.
    pub inverse_w: f64,
    pub attributes: PixelAttributes,
}

impl AsMut<PixelAttributes> for WindowCorner {
    fn as_mut(&mut self) -> &mut PixelAttributes {
        &mut self.attributes
    }
}

impl WindowCorner {
    fn is_finite(&self) -> bool {
        self.window.is_finite() && self.depth.is_finite() && self.inverse_w.is_finite()
    }

    fn snapped(&self) -> DVec2 {
        (self.window * SUBPIXEL).round()
    }
}

/// Returns twice the signed area. It is positive if the corners run clockwise on the screen.
pub(crate) fn doubled_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// A triangle with at least one covered pixel.
#[derive(Clone, Debug)]
pub(crate) struct CoveredTriangle {
    corners: [WindowCorner; 3],
    edges: [EdgeFunction; 3],
    bounds: [DVec2; 2],
    /// Screen-space weight of each corner: `x * gradient.x + y * gradient.y + constant`.
    planes: [LinearPlane; 3],
    /// True if counter-clockwise on the screen as given: a front face unless its object is mirrored.
    pub counter_clockwise: bool,
}

impl CoveredTriangle {
    /// Creates a triangle. Returns `None` if no area is left after snapping, or a coordinate is not finite.
    pub fn new(mut corners: [WindowCorner; 3]) -> Option<Self> {
        if !corners.iter().all(WindowCorner::is_finite) {
            return None;
        }
        let area = doubled_area(corners.map(|c| c.snapped()));
        if area == 0.0 || !area.is_finite() {
            return None;
        }
        if area < 0.0 {
            corners.swap(1, 2);
        }
        let [a, b, c] = corners.map(|c| c.snapped());
        // A sliver may turn over by snapping. Then only the snapped triangle has an inside.
        let exact = corners.map(|c| c.window);
        let interpolated = if doubled_area(exact) > 0.0 { exact } else { [a, b, c].map(|p| p / SUBPIXEL) };
        Some(Self {
            corners,
            edges: [EdgeFunction::new(b, c), EdgeFunction::new(c, a), EdgeFunction::new(a, b)],
            bounds: [a.min(b).min(c) / SUBPIXEL, a.max(b).max(c) / SUBPIXEL],
            planes: weight_planes(interpolated),
            counter_clockwise: area < 0.0,
        })
    }

    /// Calls `visit` for the covered columns of each of the rows, within a picture of `width` columns.
    pub fn spans(&self, width: usize, rows: &Range<usize>, mut visit: impl FnMut(usize, Range<usize>)) {
        let [low, high] = self.bounds;
        let first = rows.start.max((low.y - 0.5).ceil().max(0.0) as usize);
        let last = rows.end.min((high.y + 0.5).floor().max(0.0) as usize);
        for row in first..last {
            let mut columns = 0.0..width as f64;
            for edge in &self.edges {
                edge.limit(row, &mut columns);
            }
            if columns.start < columns.end {
                visit(row, columns.start as usize..columns.end as usize);
            }
        }
    }

    /// Returns the depth at a pixel centre.
    pub fn depth(&self, column: usize, row: usize) -> f64 {
        let weights = self.weights(column, row);
        (0..3).map(|i| weights[i] * self.corners[i].depth).sum()
    }

    /// Returns the attributes at a pixel centre, perspective-correct. `back` is true if seen from behind.
    pub fn point(&self, column: usize, row: usize, back: bool) -> SurfacePoint {
        let screen = self.weights(column, row);
        let shares = [0, 1, 2].map(|i| screen[i] * self.corners[i].inverse_w);
        let inverse_w: f64 = shares.iter().sum();
        let parts = [0, 1, 2].map(|i| &self.corners[i].attributes);
        let attributes = PixelAttributes::weighted(parts, shares.map(|share| share / inverse_w));
        let footprint = |at: DVec2, of: fn(&PixelAttributes) -> DVec2| self.footprint(at, inverse_w, of);
        SurfacePoint {
            attributes,
            uv: footprint(attributes.uv, |a| a.uv),
            uv_normal: footprint(attributes.uv_normal, |a| a.uv_normal),
            back,
        }
    }

    /// Returns the footprint. With U = sum(weight * u / w) and W = sum(weight / w), both linear on the screen, u = U / W and
    /// du/dx = (dU/dx - u * dW/dx) / W.
    fn footprint(&self, at: DVec2, inverse_w: f64, of: fn(&PixelAttributes) -> DVec2) -> TextureFootprint {
        let mut right = DVec2::ZERO;
        let mut down = DVec2::ZERO;
        for (corner, plane) in self.corners.iter().zip(&self.planes) {
            let offset = (of(&corner.attributes) - at) * (corner.inverse_w / inverse_w);
            right += offset * plane.gradient.x;
            down += offset * plane.gradient.y;
        }
        TextureFootprint { at, right, down }
    }

    /// Returns the screen-space weights of the corners, each 0..=1. A pixel covered only by snapping gets the weights of the
    /// nearby rim.
    fn weights(&self, column: usize, row: usize) -> [f64; 3] {
        let centre = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
        let weights = DVec3::from(self.planes.each_ref().map(|plane| plane.at(centre))).max(DVec3::ZERO);
        (weights / weights.element_sum()).to_array()
    }
}

/// Linear function of the window position that is 1 at its corner and 0 on the opposite edge.
#[derive(Clone, Copy, Debug)]
struct LinearPlane {
    origin: DVec2,
    gradient: DVec2,
}

impl LinearPlane {
    fn at(&self, window: DVec2) -> f64 {
        (window - self.origin).dot(self.gradient)
    }
}

fn weight_planes(corners: [DVec2; 3]) -> [LinearPlane; 3] {
    let area = doubled_area(corners);
    let [a, b, c] = corners;
    [(b, c), (c, a), (a, b)].map(|(from, to)| LinearPlane { origin: from, gradient: (to - from).perp() / area })
}

/// Edge function of a clockwise triangle (y down) in steps of 1 / [`SUBPIXEL`], in whole numbers. A pixel centre is inside if it
/// is >= 0.
#[derive(Clone, Copy, Debug)]
struct EdgeFunction {
    /// Change per column.
    across: f64,
    /// Change per row.
    down: f64,
    /// Value at the centre of pixel (0, 0).
    start: f64,
}

impl EdgeFunction {
    fn new(from: DVec2, to: DVec2) -> Self {
        let along = to - from;
        // Clockwise with y down: top edges run right, left edges run up. Other edges do not own the pixels on them.
        let top_left = along.y < 0.0 || (along.y == 0.0 && along.x > 0.0);
        let value = along.perp_dot(DVec2::splat(SUBPIXEL / 2.0) - from);
        Self { across: -along.y * SUBPIXEL, down: along.x * SUBPIXEL, start: if top_left { value } else { value - 1.0 } }
    }

    /// Limits the columns of a row to those inside. The quotient cannot round across a whole number: it is at least 1 / across
    /// away from one, more than half a unit in the last place within 2^18 pixels.
    fn limit(&self, row: usize, columns: &mut Range<f64>) {
        let value = self.start + self.down * row as f64;
        if self.across > 0.0 {
            columns.start = columns.start.max((-value / self.across).ceil());
        } else if self.across < 0.0 {
            columns.end = columns.end.min((value / -self.across).floor() + 1.0);
        } else if value < 0.0 {
            columns.end = columns.start;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn corner(x: f64, y: f64) -> WindowCorner {
        WindowCorner { window: DVec2::new(x, y), depth: 0.5, inverse_w: 1.0, attributes: PixelAttributes::default() }
    }

    const SIDE: usize = 24;

    fn count(hits: &mut [u32], corners: [[f64; 2]; 3]) {
        let Some(triangle) = CoveredTriangle::new(corners.map(|[x, y]| corner(x, y))) else { return };
        triangle.spans(SIDE, &(0..SIDE), |row, columns| {
            for column in columns {
                hits[row * SIDE + column] += 1;
            }
        });
    }

    #[test]
    fn top_and_left_edges_own_their_pixels() {
        let mut hits = vec![0; SIDE * SIDE];
        let (low, high) = (2.5, 5.5);
        count(&mut hits, [[low, low], [high, low], [high, high]]);
        count(&mut hits, [[low, low], [high, high], [low, high]]);
        let covered: Vec<_> = (0..SIDE * SIDE).filter(|&i| hits[i] > 0).map(|i| (i % SIDE, i / SIDE)).collect();
        let expected: Vec<_> = (2..5).flat_map(|y| (2..5).map(move |x| (x, y))).collect();
        assert_eq!(covered, expected);
        assert!(hits.iter().all(|&n| n <= 1));
    }

    #[test]
    fn weights_are_linear_and_sum_to_one() {
        let triangle = CoveredTriangle::new([corner(0.0, 0.0), corner(0.0, 20.0), corner(20.0, 0.0)]).expect("has area");
        let weights = triangle.weights(4, 9);
        let by_corner: Vec<_> = triangle.corners.iter().zip(weights).map(|(c, w)| c.window * w).collect();
        let sum = by_corner[0] + by_corner[1] + by_corner[2];
        assert!((sum - DVec2::new(4.5, 9.5)).length() < 1e-12);
        assert!(triangle.counter_clockwise);
    }

    #[test]
    fn invalid_triangles_cover_nothing_and_huge_ones_are_drawn() {
        assert!(CoveredTriangle::new([corner(0.0, f64::NAN), corner(1.0, 0.0), corner(0.0, 1.0)]).is_none());
        assert!(CoveredTriangle::new([corner(0.0, 0.0), corner(1.0, 1.0), corner(2.0, 2.0)]).is_none());
        let mut hits = vec![0; SIDE * SIDE];
        count(&mut hits, [[-1e300, -1e300], [1e300, -1e300], [0.0, 1e300]]);
        count(&mut hits, [[-1e5, -1e5], [1e5, -1e5], [0.0, 2e5]]);
        assert!(hits.iter().all(|&n| n > 0));
    }

    /// Generates a grid of jittered vertices, some snapped onto pixel centres, where the fill rule decides.
    fn lattice() -> impl Strategy<Value = Vec<[f64; 2]>> {
        let jitter = || prop_oneof![Just(0.0), Just(0.5), Just(-0.5), -0.9..0.9f64];
        prop::collection::vec((jitter(), jitter()), 25)
            .prop_map(|v| v.into_iter().enumerate().map(|(i, (x, y))| place(i, x, y)).collect())
    }

    fn place(i: usize, x: f64, y: f64) -> [f64; 2] {
        let on_rim = |k: usize| k == 0 || k == 4;
        let at = |k: usize, jitter: f64| 4.0 + 4.0 * k as f64 + if on_rim(k) { 0.0 } else { jitter };
        [at(i % 5, x), at(i / 5, y)]
    }

    proptest! {
        #[test]
        fn shared_edge_pixels_are_drawn_exactly_once(points in lattice(), turn in prop::bool::ANY) {
            let mut hits = vec![0; SIDE * SIDE];
            for (x, y) in (0..4).flat_map(|y| (0..4).map(move |x| (x, y))) {
                let [a, b, c, d] = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| points[y * 5 + x]);
                let halves = if turn { [[a, b, c], [c, a, d]] } else { [[b, d, a], [b, c, d]] };
                halves.into_iter().for_each(|half| count(&mut hits, half));
            }
            for (i, &n) in hits.iter().enumerate() {
                let inside = (4..20).contains(&(i % SIDE)) && (4..20).contains(&(i / SIDE));
                prop_assert_eq!(n, u32::from(inside), "pixel {}, {}", i % SIDE, i / SIDE);
            }
        }

        #[test]
        fn spans_match_edge_functions(values in prop::array::uniform6(-10.0..40.0f64)) {
            let [a, b, c, d, e, f] = values;
            let Some(triangle) = CoveredTriangle::new([corner(a, b), corner(c, d), corner(e, f)]) else { return Ok(()) };
            let mut expected = Vec::new();
            for i in 0..SIDE * SIDE {
                let (x, y) = ((i % SIDE) as f64, (i / SIDE) as f64);
                if triangle.edges.iter().all(|edge| edge.start + edge.across * x + edge.down * y >= 0.0) {
                    expected.push(i);
                }
            }
            let mut found = Vec::new();
            triangle.spans(SIDE, &(0..SIDE), |row, columns| found.extend(columns.map(|column| row * SIDE + column)));
            prop_assert_eq!(found, expected);
        }
    }
}
