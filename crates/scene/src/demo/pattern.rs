//! Patterns over the unit square that repeat without seams.

use super::stage::PI;
use glam::DVec2;

/// 0 below `low`, 1 above `high`, smooth between.
pub(super) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    ease(((x - low) / (high - low)).clamp(0.0, 1.0))
}

/// Rises from 0 to 1 with t, level at both ends.
fn ease(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// A number in 0..1 that looks arbitrary but depends on the arguments only.
pub(super) fn scatter(x: i64, y: i64, seed: u32) -> f64 {
    let mut h = (x as u32).wrapping_mul(0x85eb_ca6b) ^ (y as u32).wrapping_mul(0xc2b2_ae35) ^ seed.wrapping_mul(0x27d4_eb2f);
    for _ in 0..2 {
        h ^= h >> 15;
        h = h.wrapping_mul(0x2c1b_3c6d);
        h ^= h >> 13;
    }
    f64::from(h) / 4_294_967_296.0
}

/// Smooth noise of several scales, 0..1.
pub(super) struct Noise {
    /// The coarsest first.
    lattices: [Lattice; 4],
}

impl Noise {
    /// Noise with `cells` cells per side of the coarsest lattice.
    pub(super) fn new(cells: usize, seed: u32) -> Self {
        Self { lattices: [0, 1, 2, 3].map(|k| Lattice::new(cells << k, seed + k)) }
    }

    /// Returns the noise at a point.
    pub(super) fn at(&self, u: f64, v: f64) -> f64 {
        let weights = [0.5, 0.25, 0.125, 0.0625];
        self.lattices.iter().zip(weights).map(|(lattice, weight)| lattice.at(u, v) * weight).sum::<f64>() / 0.9375
    }
}

/// Numbers at the points of a lattice that repeats. Hashing them for every texel took most of the time of a texture.
struct Lattice {
    side: usize,
    /// Row by row. The first number of a row also ends it, and the first row also ends the lattice.
    numbers: Vec<f64>,
}

impl Lattice {
    fn new(side: usize, seed: u32) -> Self {
        let number = |y: usize, x: usize| scatter((x % side) as i64, (y % side) as i64, seed);
        Self { side, numbers: (0..=side).flat_map(|y| (0..=side).map(move |x| number(y, x))).collect() }
    }

    /// Interpolates between the four numbers around a point.
    fn at(&self, u: f64, v: f64) -> f64 {
        let ((i, x), (j, y)) = (lattice_place(u, self.side), lattice_place(v, self.side));
        let (fx, fy) = (ease(x), ease(y));
        let first = j * (self.side + 1) + i;
        let row = |at: usize| {
            let [left, right] = [self.numbers[at], self.numbers[at + 1]];
            left + (right - left) * fx
        };
        let (near, far) = (row(first), row(first + self.side + 1));
        near + (far - near) * fy
    }
}

/// Returns the largest whole number that is not above `x`, which must fit into 64 bits. Without SSE 4.1, `f64::floor` is a call.
#[inline]
pub(super) fn floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

/// Returns the lattice point before a place, and the distance from it. `side`: lattice points per 1.
#[inline]
fn lattice_place(place: f64, side: usize) -> (usize, f64) {
    let x = place * side as f64;
    let whole = x as i32;
    // Almost always. The remainder is a division.
    if x >= 0.0 && (whole as usize) < side {
        return (whole as usize, x - f64::from(whole));
    }
    let floor = floor(x);
    ((floor as i64).rem_euclid(side as i64) as usize, x - floor)
}

/// Courses of stones: how many bricks and courses per tile, every other course shifted by half a brick.
pub(super) struct BrickPattern {
    bricks: i64,
    courses: i64,
    seed: u32,
    waver: Noise,
    face: Noise,
    mortar: Noise,
    shade: Noise,
}

impl BrickPattern {
    pub(super) fn new(bricks: i64, courses: i64, seed: u32) -> Self {
        let noise = |cells: usize, offset: u32| Noise::new(cells, seed + offset);
        Self { bricks, courses, seed, waver: noise(16, 9), face: noise(32, 1), mortar: noise(64, 2), shade: noise(24, 4) }
    }

    /// The brick at a point, and how far inside it the point is \[courses\]: negative in the mortar.
    fn locate(&self, u: f64, v: f64) -> ((i64, i64), f64) {
        // Weathered edges are not straight.
        let waver = 0.05 * (self.waver.at(u, v) - 0.5);
        let y = v * self.courses as f64;
        let bottom = floor(y);
        let course = (bottom as i64).rem_euclid(self.courses);
        let x = u * self.bricks as f64 + 0.5 * (course % 2) as f64;
        let left = floor(x);
        let brick = (left as i64).rem_euclid(self.bricks);
        let length = self.courses as f64 / self.bricks as f64;
        let inside = |f: f64| f.min(1.0 - f);
        let edge = (inside(x - left) * length).min(inside(y - bottom));
        ((brick, course), edge - 0.05 + waver)
    }

    /// Height, 0..1.
    pub(super) fn height(&self, u: f64, v: f64) -> f64 {
        let ((i, j), edge) = self.locate(u, v);
        let face = 0.7 + 0.15 * scatter(i, j, self.seed) + 0.15 * self.face.at(u, v);
        let mortar = 0.15 + 0.12 * self.mortar.at(u, v);
        mortar + (face - mortar) * smoothstep(-0.01, 0.09, edge)
    }

    /// Share of stone (1) against mortar (0), and the stone's own shade, 0..1.
    pub(super) fn stone(&self, u: f64, v: f64) -> (f64, f64) {
        let ((i, j), edge) = self.locate(u, v);
        let shade = 0.65 * scatter(i, j, self.seed + 3) + 0.35 * self.shade.at(u, v);
        (smoothstep(-0.01, 0.03, edge), shade)
    }
}

/// Height of a plain weave with this many threads per side (even), 0..1.
pub(super) fn weave(u: f64, v: f64, threads: f64) -> f64 {
    let p = DVec2::new(u, v) * threads;
    let round = |across: f64| {
        let x = (across - floor(across) - 0.5) / 0.46;
        (1.0 - x * x).max(0.0).sqrt()
    };
    let sign = |i: f64| if floor(i).rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
    // Threads rise and dive once every two crossings, those across just when the others do not.
    let lift = |wave: f64| 0.35 + 0.325 * (1.0 + wave);
    let warp = round(p.x) * lift(sign(p.x) * libm::sin(PI * p.y));
    let weft = round(p.y) * lift(-sign(p.y) * libm::sin(PI * p.x));
    warp.max(weft)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_repeat_without_seams() {
        let (wall, noise) = (BrickPattern::new(6, 12, 1), Noise::new(4, 7));
        for k in 0..50 {
            let t = f64::from(k) / 50.0;
            for f in [&|u, v| noise.at(u, v), &|u, v| weave(u, v, 8.0)] as [&dyn Fn(f64, f64) -> f64; 2] {
                assert!((f(t, 0.0) - f(t, 1.0)).abs() < 1e-9 && (f(0.0, t) - f(1.0, t)).abs() < 1e-9);
            }
            assert!((wall.height(t, 0.0) - wall.height(t, 1.0)).abs() < 1e-9);
            assert!((wall.height(0.0, t) - wall.height(1.0, t)).abs() < 1e-9);
        }
    }

    #[test]
    fn lattice_place_wraps_on_both_sides() {
        for (place, expected) in [
            (0.0, (0, 0.0)),
            (0.3125, (1, 0.25)),
            (1.0, (0, 0.0)),
            (1.5, (2, 0.0)),
            (-0.0625, (3, 0.75)),
            (-1.0, (0, 0.0)),
            (2e9, (0, 0.0)),
        ] {
            assert_eq!(lattice_place(place, 4), expected, "{place}");
        }
    }

    #[test]
    fn floor_is_that_of_the_standard_library() {
        for x in [0.0, 0.3, 1.0, 41.999_999, -0.15, -1.0, -1.5, 1e15, -1e15 - 0.5] {
            assert_eq!(floor(x), x.floor());
        }
    }

    #[test]
    fn heights_stay_between_zero_and_one() {
        let (wall, noise) = (BrickPattern::new(6, 12, 1), Noise::new(4, 1));
        for i in 0..100 {
            for j in 0..100 {
                let (u, v) = (f64::from(i) / 100.0, f64::from(j) / 100.0);
                for h in [wall.height(u, v), wall.stone(u, v).0, wall.stone(u, v).1, noise.at(u, v), weave(u, v, 6.0)] {
                    assert!((0.0..=1.0).contains(&h), "{h}");
                }
            }
        }
    }
}
