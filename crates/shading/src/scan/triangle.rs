//! Set-up of a triangle: exact edge functions, depth and weights.
//!
//! Coordinates are snapped to the sub-pixel grid. From there on coverage is integer arithmetic without rounding. Limits: a
//! coordinate is clamped to +-2^19 pixels, a grid has at most 2^10 steps per pixel, and a screen has at most 2^14 pixels per
//! side. An edge function therefore stays below 2^61.

use super::MAX_BLOCK;
use basrelief_signals::{Fragment, Vertex, layout};
use basrelief_signals::{MapInline as _, from_fn_inline};
use serde::{Deserialize, Serialize};

/// Largest coordinate \[pixels\]. The guard band of the geometry processor is far inside.
const MAX_COORDINATE: f64 = (1u32 << 19) as f64;

/// A point on the sub-pixel grid.
pub type GridPoint = [i64; 2];

/// Returns the position of a vertex on the grid of 2^-`bits` pixel. NaN counts as 0.
#[inline]
pub fn snap(vertex: &Vertex, bits: u32) -> GridPoint {
    let steps = f64::from(1u32 << bits);
    let to_grid = |v: f32| {
        let scaled = f64::from(v).clamp(-MAX_COORDINATE, MAX_COORDINATE) * steps + 0.5;
        // Rounds towards minus infinity. The library function would be a call.
        let whole = scaled as i64;
        whole - i64::from(whole as f64 > scaled)
    };
    [to_grid(vertex.position[0]), to_grid(vertex.position[1])]
}

/// Returns twice the signed area. It is positive if the corners run clockwise on the screen.
#[inline]
pub fn doubled_grid_area([a, b, c]: [GridPoint; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// An edge function: positive inside the triangle, 0 on the edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EdgeFunction {
    /// Change per pixel in x and y, in units of 2^bits.
    step: [i64; 2],
    /// Value at the centre of pixel (0, 0).
    origin: i64,
    /// Coverage offset: a pixel is on the inner side if `step . (x, y) + cover >= 0`. The offset is the origin, less one if the
    /// top-left rule gives the edge to the other side, in units of `step`, rounded down. It is exact because the products are
    /// whole.
    cover: i64,
}

impl EdgeFunction {
    fn new(from: GridPoint, to: GridPoint, sign: i64, bits: u32) -> Self {
        let half = 1i64 << (bits - 1);
        let step = [sign * (from[1] - to[1]), sign * (to[0] - from[0])];
        let origin = step[0] * (half - from[0]) + step[1] * (half - from[1]);
        // As y runs down, a left edge has a function that grows to the right, and a top edge one that grows downwards.
        let top_left = step[0] > 0 || (step[0] == 0 && step[1] > 0);
        Self { step, origin, cover: (origin - i64::from(!top_left)) >> bits }
    }

    #[inline]
    fn at(&self, x: i32, y: i32, bits: u32) -> i64 {
        ((self.step[0] * i64::from(x) + self.step[1] * i64::from(y)) << bits) + self.origin
    }

    #[inline]
    fn covers(&self, x: i32, y: i32) -> bool {
        self.step[0] * i64::from(x) + self.step[1] * i64::from(y) + self.cover >= 0
    }

    /// Cuts the spans (first column, column behind the last) of the rows from `top` on to the inner side of the edge. `across` is
    /// 0, or 1 for the spans of columns. The sign is tested once instead of in every row, and the divisions of the rows do not
    /// depend on each other.
    #[inline]
    fn clip(&self, across: usize, top: i32, spans: &mut [[i32; 2]]) {
        let (a, b) = (self.step[across], self.step[1 - across]);
        let rows = (i64::from(top)..).map(|y| b * y + self.cover).zip(spans);
        if a > 0 {
            rows.for_each(|(value, span)| span[0] = span[0].max(column(-floor_division(value, a))));
        } else if a < 0 {
            rows.for_each(|(value, span)| span[1] = span[1].min(column(floor_division(value, -a) + 1)));
        } else {
            rows.filter(|(value, _)| *value < 0).for_each(|(_, span)| *span = [0, 0]);
        }
    }
}

#[inline]
fn column(x: i64) -> i32 {
    x.clamp(-1, i64::from(i32::MAX)) as i32
}

/// Computes `floor(v / d)` for |v| < 2^53, d > 0. Floating-point division costs a third of the integer instruction. Both operands
/// are exact there, and a quotient that is not whole is at least 1 / d from the next whole number, which is more than the
/// rounding error.
#[inline]
fn floor_division(v: i64, d: i64) -> i64 {
    let truncated = (v as f64 / d as f64) as i64;
    truncated - i64::from(truncated * d > v)
}

/// The three edges of a triangle, which define its coverage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TriangleEdges {
    /// Edge `i` lies opposite corner `i`. The three values sum to `area`.
    edges: [EdgeFunction; 3],
    /// Twice the area, > 0.
    area: i64,
}

impl TriangleEdges {
    /// Creates the edges. `sign` is +-1: the winding that counts as positive. Returns `None` if the triangle winds the other way
    /// or has no area.
    #[inline]
    pub fn new(corners: [GridPoint; 3], sign: i64, bits: u32) -> Option<Self> {
        let area = sign * doubled_grid_area(corners);
        let [a, b, c] = corners;
        let edge = |from, to| EdgeFunction::new(from, to, sign, bits);
        (area > 0).then(|| Self { edges: [edge(b, c), edge(c, a), edge(a, b)], area })
    }

    /// Returns true if the centre of this pixel is covered. On an edge, the top-left rule decides.
    pub fn covers(&self, x: i32, y: i32) -> bool {
        self.edges.iter().all(|e| e.covers(x, y))
    }
}

/// Bounds of the pixels that may be covered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelBounds {
    /// First column and column behind the last.
    pub x: [i32; 2],
    /// First row and row behind the last.
    pub y: [i32; 2],
}

impl PixelBounds {
    #[inline]
    fn new(corners: [GridPoint; 3], screen: [u32; 2], bits: u32) -> Option<Self> {
        let half = 1i64 << (bits - 1);
        let range = |axis: usize| {
            let [a, b, c] = corners.map_inline(|p| p[axis]);
            let first = -((half - a.min(b).min(c)) >> bits);
            let end = ((a.max(b).max(c) - half) >> bits) + 1;
            [first.max(0) as i32, end.clamp(0, i64::from(screen[axis])) as i32]
        };
        let (x, y) = (range(0), range(1));
        (x[0] < x[1] && y[0] < y[1]).then_some(Self { x, y })
    }
}

/// A triangle of a fan, ready to be walked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RasterTriangle {
    /// Bounds of its fragments.
    pub bounds: PixelBounds,
    edges: TriangleEdges,
    /// Depth of each corner \[steps of the z-buffer per unit of its edge function\].
    depth: [f64; 3],
    /// 1 / w of each corner, relative to the largest.
    inverse_w: [f32; 3],
    /// 1 / (twice the area).
    inverse_area: f64,
    /// Number in the fan.
    number: u16,
    bits: u32,
    z_max: u32,
}

/// Parameters of a triangle's set-up besides its vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RasterGrid {
    /// Width and height \[pixels\].
    pub screen: [u32; 2],
    /// Sub-pixel bits, 1..=10.
    pub bits: u32,
    /// Largest depth value.
    pub z_max: u32,
    /// Side of the blocks in which a triangle is visited \[pixels\], 1..=[`MAX_BLOCK`].
    pub block: u32,
    /// True if blocks are visited column by column, each column by column, instead of by rows.
    pub columns: bool,
}

impl RasterGrid {
    /// Creates a raster of `screen` pixels with depth values of `z_bits` (1..=32) bits.
    pub fn new(screen: [u32; 2], bits: u32, z_bits: u32, block: u32) -> Self {
        let z_max = u32::MAX >> 32u32.saturating_sub(z_bits).min(31);
        Self { screen: screen.map(|side| side.min(layout::MAX_SIDE)), bits, z_max, block, columns: false }
    }
}

impl RasterTriangle {
    /// Creates triangle `number` of a fan that winds with `sign`. Returns `None` if it covers no pixel.
    pub fn new(vertices: [&Vertex; 3], number: u16, sign: i64, raster: RasterGrid) -> Option<Self> {
        let RasterGrid { screen, bits, z_max, .. } = raster;
        let corners = vertices.map_inline(|v| snap(v, bits));
        let bounds = PixelBounds::new(corners, screen, bits)?;
        let edges = TriangleEdges::new(corners, sign, bits)?;
        let scale = f64::from(z_max) / edges.area as f64;
        let depth = vertices.map_inline(|v| f64::from(v.position[2]) * scale);
        let inverse_w = relative(vertices.map_inline(|v| v.position[3]));
        let inverse_area = 1.0 / edges.area as f64;
        Some(Self { bounds, edges, depth, inverse_w, inverse_area, number, bits, z_max })
    }

    /// Returns the triangle's number in its fan.
    pub fn number(&self) -> u16 {
        self.number
    }

    /// Computes the covered columns of `count` rows from `top` on, without the last. A span is empty if its first column is not
    /// below its last.
    #[inline]
    pub fn spans(&self, top: i32, count: i32, spans: &mut [[i32; 2]; MAX_BLOCK]) {
        self.spans_across(0, top, count, spans);
    }

    /// Computes [`RasterTriangle::spans`]. If `across` is 1, columns and rows are exchanged: covered rows of columns.
    #[inline]
    pub(super) fn spans_across(&self, across: usize, top: i32, count: i32, spans: &mut [[i32; 2]; MAX_BLOCK]) {
        let bounds = [self.bounds.x, self.bounds.y];
        let [first, end] = bounds[1 - across];
        let (skip, take) = ((first - top).max(0) as usize, count.min(end - top) as usize);
        *spans = [[0, 0]; MAX_BLOCK];
        let Some(rows) = spans.get_mut(skip..take) else { return };
        rows.fill(bounds[across]);
        for edge in &self.edges.edges {
            edge.clip(across, top.max(first), rows);
        }
    }

    /// Returns the three edge functions of a covered pixel, each >= 0. They sum to twice the area.
    #[inline]
    pub fn shares(&self, x: i32, y: i32) -> [f64; 3] {
        let TriangleEdges { edges, area } = &self.edges;
        let (e1, e2) = (edges[1].at(x, y, self.bits), edges[2].at(x, y, self.bits));
        [area - e1 - e2, e1, e2].map_inline(|e| e as f64)
    }

    /// Returns the depth of a covered pixel with these shares \[steps of the z-buffer\], neither rounded nor clamped. All terms
    /// of the sum are >= 0, so nothing cancels.
    #[inline]
    pub fn exact_depth(&self, share: [f64; 3]) -> f64 {
        share[0] * self.depth[0] + share[1] * self.depth[1] + share[2] * self.depth[2]
    }

    #[inline]
    fn depth(&self, share: [f64; 3]) -> u32 {
        ((self.exact_depth(share) + 0.5) as u32).min(self.z_max)
    }

    /// Returns 1 / (twice the area). Shares times it are weights that sum to 1.
    #[inline]
    pub fn inverse_area(&self) -> f64 {
        self.inverse_area
    }

    /// Returns the fragment of a covered pixel, with perspective-correct weights.
    #[inline]
    pub fn fragment(&self, x: i32, y: i32) -> Fragment {
        let share = self.shares(x, y);
        let q: [f32; 3] = from_fn_inline(|i| share[i] as f32 * self.inverse_w[i]);
        let scale = 1.0 / (q[0] + q[1] + q[2]);
        let weights = [q[1] * scale, q[2] * scale];
        Fragment { x: x as u16, y: y as u16, z: self.depth(share), weights, triangle: self.number }
    }

    /// Returns the fragment of a covered pixel, with weights that are linear on the screen.
    #[inline]
    pub fn linear_fragment(&self, x: i32, y: i32) -> Fragment {
        let share = self.shares(x, y);
        let weights = [(share[1] * self.inverse_area) as f32, (share[2] * self.inverse_area) as f32];
        Fragment { x: x as u16, y: y as u16, z: self.depth(share), weights, triangle: self.number }
    }
}

/// Returns 1 / w relative to the largest, so that products with edge functions neither overflow nor all vanish. A set that is not
/// positive and finite, possible only in a damaged trace, counts as equal.
fn relative(inverse_w: [f32; 3]) -> [f32; 3] {
    let [a, b, c] = inverse_w;
    if inverse_w.iter().all(|q| *q > 0.0 && q.is_finite()) {
        inverse_w.map_inline(|q| (q / a.max(b).max(c)).max(1e-12))
    } else {
        [1.0; 3]
    }
}
