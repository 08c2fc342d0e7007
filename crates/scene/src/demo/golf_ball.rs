//! A golf ball: all of its shape is in the normal map.

use super::framing;
use super::pattern::smoothstep;
use super::stage::{Globe, PI, Stage, Workshop, sphere};
use glam::{DMat4, DVec3};

const DIMPLES: u32 = 336;

/// Angular radius of a dimple.
const RADIUS: f64 = 0.098;

/// Steepest slope within a dimple.
const SLOPE: f64 = 0.62;

/// A white ball with 336 dimples, evenly spread, and a printed mark. The normal map is computed on the sphere itself, not
/// from a flat height map, so the dimples are round up to the poles.
pub(super) fn build() -> Stage {
    let mut shop = Workshop::default();
    let globe = Globe::new([1024, 512]);
    let centres: Vec<DVec3> = (0..DIMPLES).map(centre).collect();
    let map = shop.globe_normals("dimples", &globe, |texel| dimpled_normal(&centres, globe.direction(texel), globe.east(texel)));
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

/// Tangent-space normal at a point of the sphere: x east, y north.
fn dimpled_normal(centres: &[DVec3], here: DVec3, east: DVec3) -> DVec3 {
    let north = here.cross(east);
    // The lattice is sorted by y, so only a few centres are near.
    let number = |y: f64| ((1.0 - y) * 0.5 * f64::from(DIMPLES)).clamp(0.0, f64::from(DIMPLES)) as usize;
    let near = number(here.y + RADIUS)..(number(here.y - RADIUS) + 1).min(centres.len());
    let mut slope = DVec3::ZERO;
    for &centre in &centres[near] {
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
