//! Triangles in window coordinates, with their edges and the attributes of their fragments.

use basrelief_signals::{Polygon, Vertex};
use std::array;

/// Largest depth.
pub(crate) const MAX_DEPTH: u32 = (1 << 24) - 1;
/// Interpolated attributes: normal, tangent, coordinates of the normal map.
pub(crate) const ATTRIBUTES: usize = 8;
/// Steps of a coordinate per pixel.
const SUBPIXELS: i64 = 256;
/// Coordinate of the centre of the first pixel.
const CENTRE: i64 = SUBPIXELS / 2;

/// An edge function, positive inside.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    /// Growth per step of x and of y.
    pub(crate) step: [i64; 2],
    /// Value at the centre of the first pixel.
    pub(crate) first: i64,
    /// The same per pixel, one less for an edge whose pixels belong to the neighbour. Negative outside.
    pub(crate) first_coverage: i64,
}

impl Edge {
    fn new(sign: i64, from: [i64; 2], to: [i64; 2]) -> Self {
        let step = [sign * (from[1] - to[1]), sign * (to[0] - from[0])];
        let first = step[0] * (CENTRE - from[0]) + step[1] * (CENTRE - from[1]);
        let owns_pixels = step[0] > 0 || (step[0] == 0 && step[1] > 0);
        Self { step, first, first_coverage: (first - i64::from(!owns_pixels)).div_euclid(SUBPIXELS) }
    }

    /// Returns the value at the centre of a pixel.
    pub(crate) fn at(&self, [x, y]: [i64; 2]) -> i64 {
        SUBPIXELS * (self.step[0] * x + self.step[1] * y) + self.first
    }

    /// Returns the value at the centre of a pixel, per pixel.
    pub(crate) fn coverage(&self, [x, y]: [i64; 2]) -> i64 {
        self.step[0] * x + self.step[1] * y + self.first_coverage
    }

    /// Returns the growth per pixel in x.
    pub(crate) fn per_column(&self) -> i64 {
        SUBPIXELS * self.step[0]
    }
}

/// A triangle that may cover pixels.
pub(crate) struct Triangle {
    /// First column and end.
    pub(crate) columns: [i64; 2],
    /// First row and end.
    pub(crate) rows: [i64; 2],
    /// The edge opposite each vertex.
    pub(crate) edges: [Edge; 3],
    pub(crate) doubled_area: i64,
    /// Depth of each vertex per doubled area.
    pub(crate) depths: [f64; 3],
    /// 1 / w of each vertex, relative to the largest.
    pub(crate) inverse_w: [f32; 3],
    /// Value at the first vertex, and the differences to it at the others.
    pub(crate) attributes: [[f32; 3]; ATTRIBUTES],
    pub(crate) handedness: f32,
    /// Number among all triangles.
    pub(crate) number: u32,
    /// Finer of the two levels of the normal map.
    pub(crate) level: usize,
    /// Weights of the two levels.
    pub(crate) weights: [f32; 2],
}

/// Returns the triangles of a polygon. Each is numbered after `first`.
pub(crate) fn triangles(polygon: &Polygon, size: [usize; 2], first: u32) -> impl Iterator<Item = Triangle> {
    let corners: Vec<[i64; 2]> = polygon.vertices.iter().map(|v| [snap(v.position[0]), snap(v.position[1])]).collect();
    let count = polygon.vertices.len() - 2;
    let sign = (0..count).map(|i| doubled_area([corners[0], corners[i + 1], corners[i + 2]])).sum::<i64>().signum();
    (0..count).filter_map(move |i| {
        let of = [0, i + 1, i + 2];
        let (corners, vertices) = (of.map(|v| corners[v]), of.map(|v| &polygon.vertices[v]));
        Triangle::new(sign, corners, vertices, polygon.lod, size, first + i as u32)
    })
}

impl Triangle {
    /// Returns `None` if the triangle covers no pixel.
    fn new(sign: i64, corners: [[i64; 2]; 3], vertices: [&Vertex; 3], lod: u8, size: [usize; 2], number: u32) -> Option<Self> {
        let doubled_area = sign * doubled_area(corners);
        let [columns, rows] = [0, 1].map(|axis| pixels(corners.map(|corner| corner[axis]), size[axis]));
        if doubled_area <= 0 || columns[0] >= columns[1] || rows[0] >= rows[1] {
            return None;
        }
        let [a, b, c] = corners;
        let scale = f64::from(MAX_DEPTH) / doubled_area as f64;
        let w = vertices.map(|vertex| vertex.position[3]);
        let largest = w[0].max(w[1]).max(w[2]);
        let values = vertices.map(attributes);
        let (level, weights) = levels(lod);
        Some(Self {
            columns,
            rows,
            edges: [Edge::new(sign, b, c), Edge::new(sign, c, a), Edge::new(sign, a, b)],
            doubled_area,
            depths: vertices.map(|vertex| f64::from(vertex.position[2]) * scale),
            inverse_w: w.map(|w| (w / largest).max(1e-12)),
            attributes: array::from_fn(|i| [values[0][i], values[1][i] - values[0][i], values[2][i] - values[0][i]]),
            handedness: vertices[0].tangent[3],
            number,
            level,
            weights,
        })
    }
}

/// Rounds a coordinate to steps.
fn snap(coordinate: f32) -> i64 {
    (f64::from(coordinate).clamp(-524_288.0, 524_288.0) * SUBPIXELS as f64 + 0.5).floor() as i64
}

fn doubled_area([a, b, c]: [[i64; 2]; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Returns the first pixel with its centre between these coordinates, and the end.
fn pixels([a, b, c]: [i64; 3], size: usize) -> [i64; 2] {
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    let first = -(CENTRE - least).div_euclid(SUBPIXELS);
    let end = (most - CENTRE).div_euclid(SUBPIXELS) + 1;
    [first.max(0), end.clamp(0, size as i64)]
}

fn attributes(vertex: &Vertex) -> [f32; ATTRIBUTES] {
    let ([nx, ny, nz], [tx, ty, tz, _], [u, v]) = (vertex.normal, vertex.tangent, vertex.uv_normal);
    [nx, ny, nz, tx, ty, tz, u, v]
}

/// Returns the finer of the two levels of a level of detail in eighths, and their weights.
fn levels(lod: u8) -> (usize, [f32; 2]) {
    let (level, rest) = (usize::from(lod / 8).min(7), lod % 8);
    let coarser = if lod >= 56 { 0.0 } else { f32::from(rest) / 8.0 };
    (level, [1.0 - coarser, coarser])
}
