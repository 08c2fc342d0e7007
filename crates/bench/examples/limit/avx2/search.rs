//! Search for the nearest reference normal: the cells of the replacement unit, with four candidates at a time.

use super::lanes::F32x8;
use super::lanes::I32x8;
use pulp::cast;
use pulp::x86::V3;
use std::arch::x86_64::{__m128i, __m256d};
use std::cmp::Reverse;
use std::iter::zip;

/// A reference normal and its number.
type Candidate = ([i16; 3], u16);

/// Four candidates in a register.
#[derive(Clone, Copy)]
struct FourCandidates {
    xy: __m128i,
    z: __m128i,
    /// Larger for smaller numbers.
    ranks: __m128i,
}

/// Grid on the six faces of a cube. Each cell lists the candidates for the normals that point to it.
pub(crate) struct NormalGrid {
    /// Cells per side of a face, a power of two.
    cells: u32,
    all: Vec<Candidate>,
    /// Candidates of the coarser grids.
    coarse: Vec<Option<Vec<Candidate>>>,
    /// First and end of the candidates of each cell in `fours`. Empty for a cell that no normal has reached.
    finest: Vec<[u32; 2]>,
    fours: Vec<FourCandidates>,
}

impl NormalGrid {
    pub(crate) fn new(normals: &[[i16; 3]]) -> Self {
        let all: Vec<Candidate> = zip(normals, 0..).map(|(normal, number)| (*normal, number)).collect();
        let fits = |cells: &u32| *cells >= 256 || (6 * cells * cells) as usize >= 4 * all.len();
        let cells = (0..=8).map(|bits| 1 << bits).find(fits).unwrap_or(256);
        let coarse = vec![None; 2 * (cells as usize * cells as usize - 1)];
        Self { cells, all, coarse, finest: vec![[0; 2]; 6 * (cells * cells) as usize], fours: vec![] }
    }

    /// Returns the cells of eight normals with components in steps of 1/32767.
    #[inline(always)]
    pub(crate) fn cells_of(&self, simd: V3, [x, y, z]: [F32x8; 3]) -> I32x8 {
        let s = |number| F32x8::splat(simd, number);
        let is_x = x.abs().ge(y.abs()) & x.abs().ge(z.abs());
        let is_y = y.abs().ge(z.abs());
        let by_axis = |x: F32x8, y: F32x8, z: F32x8| is_x.select(x, is_y.select(y, z));
        let (main, a, b) = (by_axis(x, y, z), by_axis(y, z, x), by_axis(z, x, y));
        let face = by_axis(s(0.0), s(2.0), s(4.0)) + (main.lt(s(0.0)) & 1.0);
        let cells = self.cells as f32;
        let scale = s(0.5 * cells - 1.0 / 128.0) / main.abs().max(s(1.0));
        let place = |component: F32x8| (component * scale + (0.5 * cells - 0.5)).round();
        ((face * cells + place(b)) * cells + place(a)).round_to_int()
    }

    /// Returns the number of the reference normal that is nearest to the normal x, y, z in this cell.
    #[inline(always)]
    pub(crate) fn nearest(&mut self, simd: V3, cell: u32, [x, y, z]: [i16; 3]) -> u16 {
        if [x, y, z] == [0; 3] {
            return 0;
        }
        let [first, end] = match self.finest[cell as usize] {
            [_, 0] => self.list(cell),
            known => known,
        };
        let normal: (__m128i, __m128i) = (cast([x, y, x, y, x, y, x, y]), cast([z, 0, z, 0, z, 0, z, 0]));
        let four = &self.fours[first as usize..end as usize];
        let mut best = keys(simd, &four[0], normal);
        for candidates in &four[1..] {
            best = simd.avx._mm256_max_pd(best, keys(simd, candidates, normal));
        }
        let [a, b, c, d]: [f64; 4] = cast(best);
        // Adding 1.5 * 2^52 puts the low bits of the key into those of the sum.
        !((a.max(b).max(c.max(d)) + 6_755_399_441_055_744.0).to_bits() as u16)
    }

    /// Lists the candidates of a cell.
    #[cold]
    #[inline(never)]
    fn list(&mut self, cell: u32) -> [u32; 2] {
        let cells = self.cells;
        let place = Place { cells, face: cell / (cells * cells), column: cell % cells, row: cell / cells % cells };
        let left = self.left_in(place, true);
        let first = self.fours.len() as u32;
        for group in left.chunks(4) {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| group[i.min(group.len() - 1)]);
            self.fours.push(FourCandidates {
                xy: cast([a.0[0], a.0[1], b.0[0], b.0[1], c.0[0], c.0[1], d.0[0], d.0[1]]),
                z: cast([a.0[2], 0, b.0[2], 0, c.0[2], 0, d.0[2], 0]),
                ranks: cast([a, b, c, d].map(|candidate| u32::from(!candidate.1))),
            });
        }
        self.finest[cell as usize] = [first, self.fours.len() as u32];
        self.finest[cell as usize]
    }

    /// Returns the candidates of a cell of this grid or of a coarser one.
    fn left_in(&mut self, place: Place, is_finest: bool) -> Vec<Candidate> {
        if place.cells == 1 {
            return place.unbeaten(&self.all, is_finest);
        }
        let Place { cells, face, column, row } = place;
        let parent = Place { cells: cells / 2, face, column: column / 2, row: row / 2 };
        let half = parent.cells;
        let number = (2 * (half * half - 1) + (face * half + parent.row) * half + parent.column) as usize;
        let known = self.coarse[number].take().unwrap_or_else(|| self.left_in(parent, false));
        let left = place.unbeaten(&known, is_finest);
        self.coarse[number] = Some(known);
        left
    }
}

/// Returns the keys of four candidates: the product with the normal, then the rank.
#[inline(always)]
fn keys(simd: V3, four: &FourCandidates, (xy, z): (__m128i, __m128i)) -> __m256d {
    let (avx, sse2) = (simd.avx, simd.sse2);
    let product = sse2._mm_add_epi32(sse2._mm_madd_epi16(four.xy, xy), sse2._mm_madd_epi16(four.z, z));
    let high = avx._mm256_mul_pd(avx._mm256_cvtepi32_pd(product), avx._mm256_set1_pd(65_536.0));
    avx._mm256_add_pd(high, avx._mm256_cvtepi32_pd(four.ranks))
}

/// A cell.
#[derive(Clone, Copy)]
struct Place {
    cells: u32,
    face: u32,
    column: u32,
    row: u32,
}

impl Place {
    /// Returns the corners of the cell, a little outside, so that rounding leaves each normal within its cell.
    fn corners(self) -> [[i64; 3]; 4] {
        let side = i64::from(self.cells) * 32;
        let [a, b] = [self.column, self.row].map(|at| (2 * i64::from(at) + 1) * 32 - side);
        let point = |a: i64, b: i64| {
            let main = if self.face % 2 == 1 { -side } else { side };
            match self.face / 2 {
                0 => [main, a, b],
                1 => [b, main, a],
                _ => [a, b, main],
            }
        };
        [point(a - 34, b - 34), point(a + 34, b - 34), point(a - 34, b + 34), point(a + 34, b + 34)]
    }

    /// Removes candidates that another one beats at all corners. `is_thorough` compares all pairs.
    fn unbeaten(self, candidates: &[Candidate], is_thorough: bool) -> Vec<Candidate> {
        let corners = self.corners();
        let product = |normal: [i16; 3], corner: [i64; 3]| -> i64 { zip(normal, corner).map(|(n, c)| i64::from(n) * c).sum() };
        let at_corners = |candidate: &Candidate| (*candidate, corners.map(|corner| product(candidate.0, corner)));
        let mut left: Vec<(Candidate, [i64; 4])> = candidates.iter().map(at_corners).collect();
        let Some(&best) = left.iter().max_by_key(|((_, number), at)| (at.iter().sum::<i64>(), Reverse(*number))) else {
            return vec![];
        };
        left.retain(|other| !beats(&best, other));
        left.iter().filter(|one| !is_thorough || !left.iter().any(|other| beats(other, one))).map(|one| one.0).collect()
    }
}

/// Returns true if the first candidate is nearer at all corners, or as near with a smaller number.
fn beats(((_, first), a): &(Candidate, [i64; 4]), ((_, second), b): &(Candidate, [i64; 4])) -> bool {
    zip(a, b).all(|(a, b)| a > b) || (first < second && zip(a, b).all(|(a, b)| a >= b))
}
