//! Pictures with detail down to the single texel, each of its own kind and seed.

use super::pattern::{scatter, smoothstep};
use super::stage::PI;
use glam::DVec3;

/// A painting of the kind and in the colours that its number says.
pub(super) fn painting(number: u32, u: f64, v: f64) -> DVec3 {
    let paint = [landscape, mosaic, rings, stripes][number as usize % 4];
    paint(number, u, v)
}

/// Hills before each other under an evening sky.
pub(super) fn landscape(seed: u32, u: f64, v: f64) -> DVec3 {
    let hue = scatter(1, 2, seed);
    let sky = palette(hue + 0.5).lerp(DVec3::new(0.98, 0.85, 0.60), v);
    let sun = [0.2 + 0.6 * scatter(3, 1, seed), 0.2 + 0.15 * scatter(3, 2, seed)];
    let from_sun = ((u - sun[0]) * (u - sun[0]) + (v - sun[1]) * (v - sun[1])).sqrt();
    let mut color = sky.lerp(DVec3::new(1.0, 0.97, 0.85), 1.0 - smoothstep(0.05, 0.07, from_sun));
    for ridge in 0..4_i64 {
        let depth = ridge as f64 / 3.0;
        let phase = 2.0 * PI * scatter(ridge, 0, seed);
        let wave = libm::sin((5.0 + 3.0 * depth) * u + phase) + 0.5 * libm::sin((13.0 + 4.0 * depth) * u + 2.0 * phase);
        let height = 0.45 + 0.16 * depth - 0.05 * wave;
        let land = palette(hue + 0.12 * depth) * (0.75 - 0.45 * depth);
        color = color.lerp(land, smoothstep(height - 0.002, height + 0.002, v));
    }
    color * grain(seed, u, v)
}

/// Coloured stones in lines of mortar.
pub(super) fn mosaic(seed: u32, u: f64, v: f64) -> DVec3 {
    let (x, y) = (u * 40.0, v * 40.0);
    let shift = 0.3 * (scatter(y.floor() as i64, 7, seed) - 0.5);
    let (i, j) = ((x + shift).floor(), y.floor());
    let inside = |f: f64| f.min(1.0 - f);
    let edge = inside(x + shift - i).min(inside(y - j));
    let swirl = libm::sin(0.35 * i + 3.0 * scatter(1, 1, seed)) * libm::cos(0.28 * j - 2.0 * scatter(2, 1, seed));
    let stone = palette(scatter(5, 5, seed) + 0.3 * swirl) * (0.7 + 0.3 * scatter(i as i64, j as i64, seed));
    DVec3::splat(0.22).lerp(stone, smoothstep(0.06, 0.10, edge)) * grain(seed, u, v)
}

/// Rings around two centres that cross.
pub(super) fn rings(seed: u32, u: f64, v: f64) -> DVec3 {
    let around = |k: i64| {
        let (x, y) = (u - scatter(k, 8, seed), v - scatter(k, 9, seed));
        libm::sin((60.0 + 40.0 * scatter(k, 3, seed)) * (x * x + y * y).sqrt())
    };
    let (a, b) = (around(0), around(1));
    let base = palette(scatter(2, 2, seed) + 0.12 * a).lerp(palette(scatter(2, 3, seed)), 0.5 + 0.5 * b);
    base * (0.75 + 0.25 * a * b) * grain(seed, u, v)
}

/// Slanting stripes of many widths, with a fine hatching.
pub(super) fn stripes(seed: u32, u: f64, v: f64) -> DVec3 {
    let slant = 1.5 * scatter(4, 4, seed) - 0.75;
    let at = 24.0 * (u + slant * v);
    let stripe = (at + 0.8 * libm::sin(0.7 * at)).floor() as i64;
    let hatch = 0.9 + 0.1 * libm::sin(2.0 * PI * 90.0 * (v - slant * u));
    palette(scatter(stripe, 6, seed)) * (0.55 + 0.45 * scatter(stripe, 5, seed)) * hatch * grain(seed, u, v)
}

/// The brush and the canvas: some hundred threads per side.
fn grain(seed: u32, u: f64, v: f64) -> f64 {
    0.93 + 0.07 * scatter((u * 420.0).floor() as i64, (v * 420.0).floor() as i64, seed + 77)
}

/// A colour of the circle of hues, one turn per unit.
fn palette(hue: f64) -> DVec3 {
    let wave = |shift: f64| 0.56 + 0.38 * libm::cos(2.0 * PI * (hue - shift));
    DVec3::new(wave(0.0), wave(0.36), wave(0.62))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paintings_differ_and_are_the_same_every_time() {
        let points = || (0..400).map(|i| (f64::from(i % 20) / 20.0 + 0.013, f64::from(i / 20) / 20.0 + 0.017));
        let mean = |a: u32, b: u32| points().map(|(u, v)| (painting(a, u, v) - painting(b, u, v)).length()).sum::<f64>() / 400.0;
        for number in 0..12 {
            assert_eq!(mean(number, number), 0.0);
            assert!(mean(number, number + 4) > 0.05, "{number}: same kind, other colours");
            assert!(points().all(|(u, v)| (0.0..=1.1).contains(&painting(number, u, v).max_element())));
        }
    }
}
