//! Pictures with detail down to the single texel, each of its own kind and seed.
//!
//! A painting computes everything that does not differ from texel to texel before its first texel. Sines and cosines of each texel took a
//! third of the time of the whole `gallery`.

use super::pattern::{floor, scatter, smoothstep};
use super::stage::PI;
use glam::DVec3;

/// A picture over the unit square.
pub(super) trait Painting: Sync {
    /// Returns the colour at the centre of a texel.
    fn at(&self, u: f64, v: f64) -> DVec3;
}

/// Creates the painting of the kind and in the colours that its number says. `width`: texels of a row.
pub(super) fn painting(number: u32, width: u32) -> Box<dyn Painting> {
    match number % 4 {
        0 => Box::new(Landscape::new(number, width)),
        1 => Box::new(Mosaic::new(number)),
        2 => Box::new(Rings::new(number)),
        _ => Box::new(Stripes::new(number)),
    }
}

/// Hills before each other under an evening sky.
pub(super) struct Landscape {
    seed: u32,
    zenith: DVec3,
    sun: [f64; 2],
    /// Colours of the ridges, from the farthest to the nearest.
    lands: [DVec3; 4],
    /// Heights of the ridges in each column of texels.
    heights: Vec<[f64; 4]>,
}

impl Landscape {
    /// Creates a landscape for a texture of this width in texels.
    pub(super) fn new(seed: u32, width: u32) -> Self {
        let hue = scatter(1, 2, seed);
        let ridge = |ridge: usize| (ridge as f64 / 3.0, 2.0 * PI * scatter(ridge as i64, 0, seed));
        let height = |(depth, phase): (f64, f64), u: f64| {
            let wave = libm::sin((5.0 + 3.0 * depth) * u + phase) + 0.5 * libm::sin((13.0 + 4.0 * depth) * u + 2.0 * phase);
            0.45 + 0.16 * depth - 0.05 * wave
        };
        let heights = |column: u32| {
            let u = (f64::from(column) + 0.5) / f64::from(width);
            std::array::from_fn(|number| height(ridge(number), u))
        };
        let land = |number: usize| {
            let (depth, _) = ridge(number);
            palette(hue + 0.12 * depth) * (0.75 - 0.45 * depth)
        };
        Self {
            seed,
            zenith: palette(hue + 0.5),
            sun: [0.2 + 0.6 * scatter(3, 1, seed), 0.2 + 0.15 * scatter(3, 2, seed)],
            lands: std::array::from_fn(land),
            heights: (0..width).map(heights).collect(),
        }
    }
}

impl Painting for Landscape {
    fn at(&self, u: f64, v: f64) -> DVec3 {
        let sky = self.zenith.lerp(DVec3::new(0.98, 0.85, 0.60), v);
        let [x, y] = self.sun;
        let from_sun = ((u - x) * (u - x) + (v - y) * (v - y)).sqrt();
        let color = sky.lerp(DVec3::new(1.0, 0.97, 0.85), 1.0 - smoothstep(0.05, 0.07, from_sun));
        let ridges = self.lands.iter().zip(self.heights[(u * self.heights.len() as f64) as usize]);
        let before =
            |color: DVec3, (&land, height): (&DVec3, f64)| color.lerp(land, smoothstep(height - 0.002, height + 0.002, v));
        ridges.fold(color, before) * grain(self.seed, u, v)
    }
}

/// Coloured stones in lines of mortar.
pub(super) struct Mosaic {
    seed: u32,
    /// Colours of the stones, by row and column; the first column begins left of the picture.
    stones: Vec<[DVec3; Mosaic::COLUMNS]>,
}

impl Mosaic {
    const ROWS: usize = 40;
    /// Each row is shifted by up to 0.15 columns.
    const COLUMNS: usize = Self::ROWS + 2;

    /// Creates a mosaic.
    pub(super) fn new(seed: u32) -> Self {
        let stone = |i: f64, j: f64| {
            let swirl = libm::sin(0.35 * i + 3.0 * scatter(1, 1, seed)) * libm::cos(0.28 * j - 2.0 * scatter(2, 1, seed));
            palette(scatter(5, 5, seed) + 0.3 * swirl) * (0.7 + 0.3 * scatter(i as i64, j as i64, seed))
        };
        let row = |j: usize| std::array::from_fn(|i| stone(i as f64 - 1.0, j as f64));
        Self { seed, stones: (0..Self::ROWS).map(row).collect() }
    }
}

impl Painting for Mosaic {
    fn at(&self, u: f64, v: f64) -> DVec3 {
        let (x, y) = (u * Self::ROWS as f64, v * Self::ROWS as f64);
        let shift = 0.3 * (scatter(floor(y) as i64, 7, self.seed) - 0.5);
        let (i, j) = (floor(x + shift), floor(y));
        let inside = |f: f64| f.min(1.0 - f);
        let edge = inside(x + shift - i).min(inside(y - j));
        let stone = self.stones[j as usize][(i + 1.0) as usize];
        DVec3::splat(0.22).lerp(stone, smoothstep(0.06, 0.10, edge)) * grain(self.seed, u, v)
    }
}

/// Rings around two centres that cross.
pub(super) struct Rings {
    seed: u32,
    /// Centres, each with its angular frequency.
    around: [([f64; 2], f64); 2],
    hue: f64,
    other: DVec3,
}

impl Rings {
    /// Creates rings.
    pub(super) fn new(seed: u32) -> Self {
        let around = |k: i64| ([scatter(k, 8, seed), scatter(k, 9, seed)], 60.0 + 40.0 * scatter(k, 3, seed));
        Self { seed, around: [around(0), around(1)], hue: scatter(2, 2, seed), other: palette(scatter(2, 3, seed)) }
    }
}

impl Painting for Rings {
    fn at(&self, u: f64, v: f64) -> DVec3 {
        let [a, b] = self.around.map(|(centre, frequency)| {
            let (x, y) = (u - centre[0], v - centre[1]);
            libm::sin(frequency * (x * x + y * y).sqrt())
        });
        let base = palette(self.hue + 0.12 * a).lerp(self.other, 0.5 + 0.5 * b);
        base * (0.75 + 0.25 * a * b) * grain(self.seed, u, v)
    }
}

/// Slanting stripes of many widths, with a fine hatching.
pub(super) struct Stripes {
    seed: u32,
    slant: f64,
    /// Colours of the stripes, the first with number [`Stripes::FIRST`].
    colors: Vec<DVec3>,
}

impl Stripes {
    /// The picture crosses the stripes between -18 and 42, each moved by up to 0.8.
    const FIRST: i64 = -20;
    const LAST: i64 = 44;

    /// Creates stripes.
    pub(super) fn new(seed: u32) -> Self {
        let color = |stripe: i64| palette(scatter(stripe, 6, seed)) * (0.55 + 0.45 * scatter(stripe, 5, seed));
        Self { seed, slant: 1.5 * scatter(4, 4, seed) - 0.75, colors: (Self::FIRST..=Self::LAST).map(color).collect() }
    }
}

impl Painting for Stripes {
    fn at(&self, u: f64, v: f64) -> DVec3 {
        let at = 24.0 * (u + self.slant * v);
        let stripe = floor(at + 0.8 * libm::sin(0.7 * at)) as i64;
        let hatch = 0.9 + 0.1 * libm::sin(2.0 * PI * 90.0 * (v - self.slant * u));
        self.colors[(stripe - Self::FIRST) as usize] * hatch * grain(self.seed, u, v)
    }
}

/// The brush and the canvas: some hundred threads per side.
fn grain(seed: u32, u: f64, v: f64) -> f64 {
    0.93 + 0.07 * scatter(floor(u * 420.0) as i64, floor(v * 420.0) as i64, seed + 77)
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
        let points = || (0..400).map(|i| (f64::from(i % 20) / 20.0 + 0.025, f64::from(i / 20) / 20.0 + 0.017));
        let mean = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|number| painting(number, 20));
            points().map(|(u, v)| (a.at(u, v) - b.at(u, v)).length()).sum::<f64>() / 400.0
        };
        for number in 0..12 {
            assert_eq!(mean(number, number), 0.0);
            assert!(mean(number, number + 4) > 0.05, "{number}: same kind, other colours");
            assert!(points().all(|(u, v)| (0.0..=1.1).contains(&painting(number, 20).at(u, v).max_element())));
        }
    }
}
