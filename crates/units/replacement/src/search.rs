//! Exact search for the nearest reference normal, without testing them all.
//!
//! The nearest reference normal has the largest inner product with N' in whole numbers. Ties go to the lowest index, and all
//! entries tie for the zero vector. The modelled cycles follow from the configuration alone, not from the host's method.
//!
//! The directions are divided into cells: six faces of a cube, each with a grid of square cells. A cell is the cone over its
//! square. Reference normal i *beats* j on a cone if `<n, q_i> >= <n, q_j>` for all n of the cone, strictly or with i < j. The
//! function `<n, q_i - q_j>` is linear in n, and a cone over a square is spanned by its four corners. So i beats j if the sign
//! holds at the four corners: `<n, q_i - q_j>` is then a sum of the corner values with shares >= 0, not all zero unless n is
//! zero. A normal that is beaten on a cell is never the answer for a direction in it, so the cell's list leaves it out. Beating
//! is transitive and never mutual, so the remaining list includes the answer for each n, and a scan in ascending order finds it.
//! All of this is in whole numbers.
//!
//! Rounding enters only in the choice of the cell of an N': `(a / m + 1) * cells / 2` in single precision, for a component a and
//! the largest m, rounded to the cell with the nearest middle. Quotient, sum and product each round values up to 256 by at most
//! 2^-24 relatively: an absolute error below 2^-14 cells. The quotient is reduced by 1/128 of a cell, so that no direction falls
//! past the first or the last cell. The corners lie 1/32 of a cell outside, so N' is within the cone of its chosen cell.
//!
//! Rejected: a scan (256 entries cost 200 ns and more), and a k-d tree, whose descent mispredicts at every branch.

use basrelief_signals::MapInline as _;
use basrelief_signals::{MAX_STAMP, StampLanes, StampNormals};
use wide::{f32x4, f64x4, i16x8, i32x4, u32x4};

/// Units per half cell. Corners lie `MARGIN` units outside.
const HALF_CELL: i64 = 32;
const MARGIN: i64 = 2;

/// Largest sum of the absolute components of a reference normal. Its product with 32,768 has 32 bits.
const MOST_LENGTH: u32 = 65_535;

/// Shift of a direction towards the middle of its face for the choice of its cell \[cells\].
const INSET: f32 = 1.0 / 128.0;

/// Adding this number rounds |x| <= 2^22 to a whole number in the low 22 bits, because single precision has steps of 1 around it.
const WHOLE: f32 = 12_582_912.0;

/// The same number for double precision, for |x| <= 2^51.
const WHOLE_DOUBLE: f64 = 6_755_399_441_055_744.0;

/// Finest grid: cells per edge of a cube face. The proof above needs at most this many.
const MOST_CELLS: u32 = 256;

/// A reference normal and its index in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct NormalCandidate {
    normal: [i16; 3],
    index: u16,
}

impl NormalCandidate {
    #[inline]
    fn dot(&self, n: [i64; 3]) -> i64 {
        let [x, y, z] = self.normal.map_inline(i64::from);
        x * n[0] + y * n[1] + z * n[2]
    }
}

/// Candidates whose inner products are computed side by side.
const SIDE_BY_SIDE: usize = 4;

/// Four candidates in ascending order. If there are fewer, the last is repeated.
#[derive(Clone, Copy, Debug)]
struct CandidateGroup {
    /// x and y of each.
    xy: i16x8,
    /// z of each, and 0.
    z: i16x8,
    /// Complements of the indexes.
    ranks: i32x4,
}

impl CandidateGroup {
    /// Packs 1..=4 candidates.
    fn new(candidates: &[NormalCandidate]) -> Self {
        let [a, b, c, d]: [NormalCandidate; SIDE_BY_SIDE] = std::array::from_fn(|i| candidates[i.min(candidates.len() - 1)]);
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz], [dx, dy, dz]] = [a, b, c, d].map_inline(|c| c.normal);
        let ranks = i32x4::new([a, b, c, d].map_inline(|c| i32::from(!c.index)));
        Self { xy: i16x8::new([ax, ay, bx, by, cx, cy, dx, dy]), z: i16x8::new([az, 0, bz, 0, cz, 0, dz, 0]), ranks }
    }

    /// Packs inner product and complement of the index of each candidate into one number whose maximum is the answer. A branch on
    /// the larger product could not be predicted, and the complement gives ties to the lowest index. Together they have 48 bits,
    /// which fit in double precision.
    #[inline(always)]
    fn keys(&self, [xy, z]: [i16x8; 2]) -> f64x4 {
        let dots = self.xy.dot(xy) + self.z.dot(z);
        f64x4::from_i32x4(dots) * 65_536.0 + f64x4::from_i32x4(self.ranks)
    }
}

/// Returns the nearest of all these candidates.
#[inline(always)]
fn nearest_among(fours: &[CandidateGroup], [x, y, z]: [i16; 3]) -> u16 {
    let Some((first, others)) = fours.split_first() else { return 0 };
    let n = [i16x8::new([x, y, x, y, x, y, x, y]), i16x8::splat(z)];
    let best = others.iter().fold(first.keys(n), |best, four| best.fast_max(four.keys(n)));
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    let [a, b, c, d] = best.to_array();
    !((larger(larger(a, c), larger(b, d)) + WHOLE_DOUBLE).to_bits() as u16)
}

/// Search structure over one VQ table (121) or code book.
///
/// It is a quadtree of squares over each face. A square is divided when a direction falls into one of its quarters for the first
/// time. Squares without directions are never divided.
#[derive(Clone, Debug)]
pub struct NearestSearch {
    /// Cells per edge of a face in the finest grid, a power of two.
    cells: u32,
    all: Vec<NormalCandidate>,
    /// Remaining candidates on each square of the coarser grids, grid by grid from the whole faces. `None` if not computed yet.
    squares: Vec<Option<Box<[NormalCandidate]>>>,
    /// Range in `fours` of the candidates on each cell, the squares of the finest grid. Empty if not computed yet.
    finest: Vec<[u32; 2]>,
    fours: Vec<CandidateGroup>,
}

impl NearestSearch {
    /// Builds the structure for a table of at most 65,536 unit vectors in steps of 1/32767 (further ones are ignored). The grid
    /// is as fine as pays off for about `searches` searches.
    ///
    /// # Panics
    /// Panics if a vector is so long that inner products with it may have more than 32 bits. Unit vectors are short enough,
    /// however coarsely their components are rounded (to 8 bits or more).
    pub fn new(normals: &[[i16; 3]], searches: usize) -> Self {
        let length = |normal: &[i16; 3]| normal.iter().map(|c| u32::from(c.unsigned_abs())).sum::<u32>();
        assert!(normals.iter().all(|normal| length(normal) <= MOST_LENGTH), "reference normals are unit vectors");
        let all: Vec<NormalCandidate> =
            normals.iter().zip(0..=u16::MAX).map(|(&normal, index)| NormalCandidate { normal, index }).collect();
        let worth = (4 * all.len()).min(searches / 4);
        let cells = (0..).map(|d| 1 << d).find(|&c| c >= MOST_CELLS || (6 * c * c) as usize >= worth).unwrap_or(1);
        let (squares, finest) = (vec![None; first_of_grid(cells)], vec![[0; 2]; (6 * cells * cells) as usize]);
        Self { cells, all, squares, finest, fours: Vec::new() }
    }

    /// Returns the number of entries of the table.
    pub fn entries(&self) -> u32 {
        self.all.len() as u32
    }

    /// Returns the index of the nearest reference normal, or 0 in an empty table.
    #[inline]
    pub fn nearest(&mut self, normal: [i16; 3]) -> u16 {
        self.nearest_of(&StampNormals::all(normal), 1)[0]
    }

    /// Returns the indexes for the first `count` normals.
    #[inline]
    pub fn nearest_of(&mut self, normals: &StampNormals, count: usize) -> [u16; MAX_STAMP] {
        let cells = self.cells_of(normals);
        let mut indexes = [0; MAX_STAMP];
        for (lane, index) in indexes.iter_mut().enumerate().take(count) {
            let normal = normals.lane(lane);
            // All entries tie for the zero vector, not only those left on the cell.
            if normal != [0; 3] {
                *index = nearest_among(self.candidates(cells[lane]), normal);
            }
        }
        indexes
    }

    /// Returns the numbers of the cells of the directions. For the zero vector it is any cell.
    #[inline(always)]
    fn cells_of(&self, normals: &StampNormals) -> [u32; MAX_STAMP] {
        let [x, y, z] = normals.0.map_inline(|c| f32x4::from_i32x4(i32x4::new(c.map_inline(i32::from))));
        let [ax, ay, az] = [x, y, z].map_inline(f32x4::abs);
        let (by_x, by_y) = (ax.simd_ge(ay) & ax.simd_ge(az), ay.simd_ge(az));
        let by_axis = |[x, y, z]: [f32x4; 3]| by_x.select(x, by_y.select(y, z));
        let (m, a, b) = (by_axis([x, y, z]), by_axis([y, z, x]), by_axis([z, x, y]));
        let face = by_axis([0.0, 2.0, 4.0].map_inline(f32x4::splat)) + m.simd_lt(f32x4::ZERO).select(f32x4::ONE, f32x4::ZERO);
        let cells = self.cells as f32;
        let scale = f32x4::splat(0.5 * cells - INSET) / m.abs().fast_max(f32x4::ONE);
        let place = |c: f32x4| ((c * scale + (0.5 * cells - 0.5)) + WHOLE) - WHOLE;
        let number = (face * cells + place(b)) * cells + place(a);
        ((number + WHOLE).to_bits() - u32x4::splat(WHOLE.to_bits())).to_array()
    }

    /// Returns the candidates left on a cell.
    #[inline(always)]
    fn candidates(&mut self, cell: u32) -> &[CandidateGroup] {
        let [first, end] = self.finest[cell as usize];
        let [first, end] = if end > 0 { [first, end] } else { self.divide(cell) };
        &self.fours[first as usize..end as usize]
    }

    /// Computes the candidates of a cell at its first use.
    #[cold]
    fn divide(&mut self, cell: u32) -> [u32; 2] {
        let left = self.left_on(&FaceSquare::new(cell, self.cells), true);
        let first = self.fours.len() as u32;
        self.fours.extend(left.chunks(SIDE_BY_SIDE).map(CandidateGroup::new));
        let place = [first, self.fours.len() as u32];
        self.finest[cell as usize] = place;
        place
    }

    /// Returns the candidates left on a square, out of those left on the surrounding square. The square lies within that one, so
    /// a candidate beaten there is beaten here. (The margin is half as wide, so it also lies within.)
    fn left_on(&mut self, square: &FaceSquare, thorough: bool) -> Vec<NormalCandidate> {
        let Some(around) = square.around() else { return unbeaten(square, &self.all, thorough) };
        let number = first_of_grid(around.cells) + around.number_in_grid();
        if self.squares[number].is_none() {
            self.squares[number] = Some(self.left_on(&around, false).into());
        }
        unbeaten(square, self.squares[number].as_deref().unwrap_or_default(), thorough)
    }
}

/// Returns the number of squares of all coarser grids, at which the grid of `cells` cells per edge begins: 6 (1 + 4 + 16 + ...).
#[inline]
fn first_of_grid(cells: u32) -> usize {
    (2 * (cells * cells - 1)) as usize
}

/// A square of a cube face in one of the grids.
struct FaceSquare {
    face: u32,
    /// Squares per edge of the face.
    cells: u32,
    column: u32,
    row: u32,
}

impl FaceSquare {
    /// Creates square `number` of the grid with `cells` squares per edge of a face.
    fn new(number: u32, cells: u32) -> Self {
        Self { face: number / (cells * cells), cells, column: number % cells, row: number / cells % cells }
    }

    /// Returns the number of the square in its grid.
    #[inline]
    fn number_in_grid(&self) -> usize {
        ((self.face * self.cells + self.row) * self.cells + self.column) as usize
    }

    /// Returns the square of the next coarser grid that contains this square as a quarter.
    fn around(&self) -> Option<Self> {
        let cells = self.cells / 2;
        (cells > 0).then_some(Self { face: self.face, cells, column: self.column / 2, row: self.row / 2 })
    }

    /// Returns the point at `(a, b)` of the face, which extends from `-m` to `m`.
    fn point(&self, m: i64, a: i64, b: i64) -> [i64; 3] {
        let m = if self.face % 2 == 1 { -m } else { m };
        match self.face / 2 {
            0 => [m, a, b],
            1 => [b, m, a],
            _ => [a, b, m],
        }
    }

    /// Returns the corners, in units that make them whole numbers. Their sum is four times the centre.
    fn corners(&self) -> [[i64; 3]; 4] {
        let m = i64::from(self.cells) * HALF_CELL;
        let middle = |i: u32| (2 * i64::from(i) + 1) * HALF_CELL - m;
        let (a, b) = (middle(self.column), middle(self.row));
        let reach = HALF_CELL + MARGIN;
        let corner = |s: i64, t: i64| self.point(m, a + s * reach, b + t * reach);
        [corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1)]
    }
}

/// Returns in ascending order the candidates that the one nearest to the centre does not beat. In the finest cells no other
/// candidate beats them either.
fn unbeaten(square: &FaceSquare, candidates: &[NormalCandidate], thorough: bool) -> Vec<NormalCandidate> {
    let corners = square.corners();
    let mut left: Vec<(NormalCandidate, [i64; 4])> = candidates.iter().map(|c| (*c, corners.map_inline(|n| c.dot(n)))).collect();
    let Some(&champion) = left.iter().max_by_key(|(c, at)| (at.iter().sum::<i64>(), std::cmp::Reverse(c.index))) else {
        return Vec::new();
    };
    left.retain(|one| !beats(&champion, one));
    let mut unbeaten = Vec::with_capacity(left.len());
    unbeaten.extend(left.iter().filter(|one| !thorough || !left.iter().any(|other| beats(other, one))).map(|(c, _)| *c));
    unbeaten
}

fn beats((i, a): &(NormalCandidate, [i64; 4]), (j, b): &(NormalCandidate, [i64; 4])) -> bool {
    let pairs = || a.iter().zip(b);
    pairs().all(|(p, q)| p > q) || (i.index < j.index && pairs().all(|(p, q)| p >= q))
}

#[cfg(test)]
mod tests;
