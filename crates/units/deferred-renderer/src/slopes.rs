//! Set-up of a triangle for the initial rasterization (454): colour, texture coordinates, and the footprint of a pixel.

use crate::config::LightingMode;
use basrelief_shading::{AttributeGradient, LightVector, brightness, fan_triangle};
use basrelief_signals::{Polygon, Vertex};
use glam::Vec3;

/// Set-up of the current triangle.
#[derive(Clone, Debug)]
pub(crate) struct TriangleSlopes {
    /// Number in the fan.
    pub(crate) number: u16,
    /// Colour, including light.
    pub(crate) colour: AttributeGradient<3>,
    /// S and T \[finest texels\].
    pub(crate) coordinates: AttributeGradient<2>,
    /// Footprint of a pixel on the texture.
    pub(crate) footprint: PixelFootprint,
}

/// Change of texture coordinates over the screen: planes of S/w, T/w and 1/w, relative to the first vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelFootprint {
    origin: [f64; 2],
    q: f64,
    /// Change of 1/w per pixel to the right and down.
    q_by: [f64; 2],
    /// Change of (S - S0)/w and (T - T0)/w per pixel.
    st_by: [[f64; 2]; 2],
}

impl PixelFootprint {
    /// Computes the planes from three corners: window position, 1/w, and S, T.
    fn new(corners: [([f64; 2], f64); 3], st: [[f64; 2]; 3]) -> Self {
        let largest = corners.iter().fold(f64::MIN_POSITIVE, |l, c| l.max(c.1));
        let q = corners.map(|c| c.1 / largest);
        let [o, a, b] = corners.map(|c| c.0);
        let (ax, ay, bx, by) = (a[0] - o[0], a[1] - o[1], b[0] - o[0], b[1] - o[1]);
        let scale = 1.0 / (ax * by - bx * ay);
        // Slope of a plane with these differences to the first corner.
        let slope = |da: f64, db: f64| [(da * by - db * ay) * scale, (db * ax - da * bx) * scale];
        let of = |i: usize| slope((st[1][i] - st[0][i]) * q[1], (st[2][i] - st[0][i]) * q[2]);
        Self { origin: o, q: q[0], q_by: slope(q[1] - q[0], q[2] - q[0]), st_by: [of(0), of(1)] }
    }

    /// Returns the square of the longer of the two axes of the pixel's footprint \[finest texels\].
    #[inline]
    pub(crate) fn rho_squared(&self, x: u16, y: u16) -> f32 {
        let (dx, dy) = (f64::from(x) + 0.5 - self.origin[0], f64::from(y) + 0.5 - self.origin[1]);
        let inverse = 1.0 / (self.q + self.q_by[0] * dx + self.q_by[1] * dy);
        let st = self.st_by.map(|by| (by[0] * dx + by[1] * dy) * inverse);
        let axis = |i: usize| {
            let [s, t] = [0, 1].map(|c| self.st_by[c][i] - st[c] * self.q_by[i]);
            s * s + t * t
        };
        (axis(0).max(axis(1)) * inverse * inverse) as f32
    }
}

/// Lighting of vertices, if enabled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VertexLight<'a> {
    pub(crate) lighting: LightingMode,
    /// Lights as seen from the centre of the object.
    pub(crate) lights: &'a [LightVector],
}

impl VertexLight<'_> {
    /// Returns the brightness of a vertex, which the geometry processor computed. Bump targets have none and are lit here, by the
    /// same formula.
    fn of(&self, vertex: &Vertex, polygon: &Polygon) -> f32 {
        let [rest, specular] = match self.lighting {
            LightingMode::None => return 1.0,
            LightingMode::Gouraud if polygon.bump => {
                brightness(Vec3::from(vertex.normal), &polygon.material.lighting, self.lights)
            }
            LightingMode::Gouraud => vertex.brightness,
        };
        rest + specular
    }
}

impl TriangleSlopes {
    /// Sets up a triangle of the polygon's fan. `size` is that of its texture \[finest texels\].
    pub(crate) fn new(polygon: &Polygon, size: [f32; 2], number: u16, light: VertexLight<'_>) -> Option<Self> {
        let vertices = fan_triangle(polygon, number)?;
        let factor = polygon.material.base_color;
        let colours = vertices.map(|v| {
            let light = light.of(v, polygon);
            [0, 1, 2].map(|i| factor[i] * v.color[i] * light)
        });
        let st = vertices.map(|v| [v.uv[0] * size[0], v.uv[1] * size[1]]);
        let corner = |i: usize| {
            let [x, y, _, q] = vertices[i].position.map(f64::from);
            ([x, y], q)
        };
        Some(Self {
            number,
            colour: AttributeGradient::new([&colours[0], &colours[1], &colours[2]]),
            coordinates: AttributeGradient::new([&st[0], &st[1], &st[2]]),
            footprint: PixelFootprint::new([corner(0), corner(1), corner(2)], st.map(|c| c.map(f64::from))),
        })
    }
}
