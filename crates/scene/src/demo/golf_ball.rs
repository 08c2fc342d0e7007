//! A golf ball: all of its shape is in the normal map.

use super::pattern::smoothstep;
use super::stage::{DemoBuilder, DemoScene, PI, SphereMap, framing, sphere};
use glam::{DMat4, DVec3};

const DIMPLES: u32 = 336;

/// Angular radius of a dimple.
const RADIUS: f64 = 0.098;

/// Steepest slope within a dimple.
const SLOPE: f64 = 0.62;

/// A white ball with 336 dimples, evenly spread, and a printed mark. The normal map is computed on the sphere itself, not
/// from a flat height map, so the dimples are round up to the poles.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let globe = SphereMap::new([1024, 512]);
    let dimples = DimpleIndex::new(&globe);
    let normal = |texel| dimpled_normal(dimples.near(texel), globe.direction(texel), globe.east(texel));
    let map = shop.globe_normals("dimples", &globe, normal);
    let print = shop.globe_colors("print", &globe, printed_color);
    let material = shop.material("golf ball", [1.0, 1.0, 0.97], Some(print), Some(map));
    shop.place("golf ball", sphere(96, 48, [1.0, 1.0]), DMat4::IDENTITY, &material);
    shop.stage(framing([-0.6; 3], [0.6; 3], 30.0, 20.0), [0.15, 0.75, 0.6])
}

/// Centre of dimple `i`: a Fibonacci lattice, from the north pole to the south pole.
fn centre(i: u32) -> DVec3 {
    let golden = PI * (3.0 - 5.0f64.sqrt());
    let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(DIMPLES);
    let ring = (1.0 - y * y).max(0.0).sqrt();
    let turn = golden * f64::from(i);
    DVec3::new(ring * libm::cos(turn), y, ring * libm::sin(turn))
}

/// Which dimples are near: of some thirty at the same height, three or so.
struct DimpleIndex {
    /// Squares of texels in a row.
    width: u32,
    /// The centres of the dimples that reach into each square, in their order.
    squares: Vec<Vec<DVec3>>,
}

impl DimpleIndex {
    /// Side of a square \[texels\].
    const SIDE: u32 = 16;

    fn new(globe: &SphereMap) -> Self {
        let centres: Vec<DVec3> = (0..DIMPLES).map(centre).collect();
        let [width, height] = globe.size.map(|size| size.div_ceil(Self::SIDE));
        let squares = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
        Self { width, squares: squares.map(|square| reaching(&centres, globe, square)).collect() }
    }

    fn near(&self, texel: [u32; 2]) -> &[DVec3] {
        let [column, row] = texel.map(|i| i / Self::SIDE);
        &self.squares[(row * self.width + column) as usize]
    }
}

/// Returns the centres that are less than [`RADIUS`] away from any texel of a square.
fn reaching(centres: &[DVec3], globe: &SphereMap, square: [u32; 2]) -> Vec<DVec3> {
    let texel =
        |place: [u32; 2]| globe.direction([0, 1].map(|i| (square[i] * DimpleIndex::SIDE + place[i]).min(globe.size[i] - 1)));
    let (middle, last) = (texel([DimpleIndex::SIDE / 2; 2]), DimpleIndex::SIDE - 1);
    // Corners are farthest from the middle.
    let corners = [[0, 0], [last, 0], [0, last], [last, last]].map(|corner| middle.dot(texel(corner)));
    let reach = libm::acos(corners.into_iter().fold(1.0, f64::min));
    let farthest = libm::cos((RADIUS + reach + 1e-6).min(PI));
    centres.iter().copied().filter(|centre| middle.dot(*centre) > farthest).collect()
}

/// Tangent-space normal at a point of the sphere, with the dimples that may be there: x east, y north.
fn dimpled_normal(near: &[DVec3], here: DVec3, east: DVec3) -> DVec3 {
    let north = here.cross(east);
    let mut slope = DVec3::ZERO;
    for &centre in near {
        let cosine = here.dot(centre).min(1.0);
        // Cheap and safe: cos x >= 1 - x^2 / 2.
        if cosine < 1.0 - RADIUS * RADIUS / 2.0 {
            continue;
        }
        let t = libm::acos(cosine) / RADIUS;
        if t < 1.0 {
            let outward = (here * cosine - centre).normalize_or_zero();
            slope += outward * (SLOPE * t * (1.0 - smoothstep(0.78, 1.0, t)));
        }
    }
    DVec3::new(-slope.dot(east), -slope.dot(north), 1.0).normalize()
}

/// White, with a ring and a dot printed where the camera looks.
fn printed_color(here: DVec3) -> DVec3 {
    let mark = DVec3::new(0.55, 0.25, 0.8).normalize();
    let cosine = here.dot(mark).clamp(-1.0, 1.0);
    // Cheap and safe: cos 0.306 is 0.9535, and nothing is printed farther from the mark.
    if cosine < 0.95 {
        return DVec3::ONE;
    }
    let angle = libm::acos(cosine);
    let beyond = |limit: f64| smoothstep(limit - 0.006, limit + 0.006, angle);
    let (white, red, blue) = (DVec3::ONE, DVec3::new(0.85, 0.12, 0.10), DVec3::new(0.08, 0.2, 0.55));
    white.lerp(blue, beyond(0.24) - beyond(0.30)).lerp(red, 1.0 - beyond(0.13))
}
