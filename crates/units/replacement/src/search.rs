//! The nearest reference normal, exactly, without trying them all.
//!
//! Nearest means the largest inner product with N' in whole numbers; ties go to the lowest index; everything ties for the
//! zero vector. The modelled cycles are those of the configuration, whatever the host does.
//!
//! The directions are divided into cells: six faces of a cube, each with a grid of square cells. A cell is the cone over
//! its square. Reference normal i *beats* j on a cone if `<n, q_i> >= <n, q_j>` for all n of the cone, strictly or with
//! i < j. As `<n, q_i - q_j>` is linear in n and a cone over a square is spanned by its four corners, it beats j if the
//! sign holds at the four corners: then `<n, q_i - q_j>` is a sum of them with shares >= 0, not all of which are zero
//! unless n is. Whoever is beaten on a cell is never the answer for a direction in it, so the cell's list leaves it out.
//! Beating is transitive and never mutual, so who is left includes, for each n, the answer; scanning the list in
//! ascending order finds it. All of this is in whole numbers.
//!
//! Rounding enters only where the cell of an N' is found: `(a / m + 1) * cells / 2` in single precision, for a component
//! a and the largest m. Quotient, sum and product round by at most 2^-24 each, relatively, of values up to 2: an absolute
//! error below 4 * 2^-24 * cells, or 2^-14 cells for the finest grid of 256. The corners lie 1/32 of a cell outside, 512
//! times that, so N' is within the cone of the cell it falls into.
//!
//! Rejected: a scan (256 entries cost 200 ns and more), and a k-d tree, whose descent mispredicts at every branch.

/// Units per half cell; corners stand `MARGIN` of them outside.
const HALF_CELL: i64 = 32;
const MARGIN: i64 = 2;

/// Finest grid: cells per edge of a cube face. The proof above needs at most this.
const MOST_CELLS: u32 = 256;

/// A reference normal and its index in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Candidate {
    normal: [i16; 3],
    index: u16,
}

impl Candidate {
    #[inline]
    fn dot(&self, n: [i64; 3]) -> i64 {
        let [x, y, z] = self.normal.map(i64::from);
        x * n[0] + y * n[1] + z * n[2]
    }
}

/// Search structure over one VQ table (121) or code book.
///
/// A quadtree of squares over each face: a square is divided when a direction falls into one of its quarters for the first
/// time: what no direction falls into is never divided.
#[derive(Clone, Debug)]
pub struct NearestSearch {
    /// Cells per edge of a face in the finest grid, a power of two.
    cells: u32,
    all: Vec<Candidate>,
    /// Candidates left on each square: grid after grid, from the whole faces to the finest. `None`: not asked for yet.
    squares: Vec<Option<Box<[Candidate]>>>,
}

impl NearestSearch {
    /// For a table of at most 65,536 normals (more are ignored) that will be searched about `searches` times: the grid is
    /// as fine as pays.
    pub fn new(normals: &[[i16; 3]], searches: usize) -> Self {
        let all: Vec<Candidate> = normals.iter().zip(0..=u16::MAX).map(|(&normal, index)| Candidate { normal, index }).collect();
        let worth = (4 * all.len()).min(searches / 4);
        let cells = (0..).map(|d| 1 << d).find(|&c| c >= MOST_CELLS || (6 * c * c) as usize >= worth).unwrap_or(1);
        Self { cells, all, squares: vec![None; first_of_grid(2 * cells)] }
    }

    /// Entries of the table.
    pub fn entries(&self) -> u32 {
        self.all.len() as u32
    }

    /// Index of the nearest reference normal; 0 in an empty table.
    #[inline]
    pub fn nearest(&mut self, normal: [i16; 3]) -> u16 {
        let Some(square) = Square::of(normal, self.cells) else { return 0 };
        if self.squares[square.number()].is_none() {
            self.divide(&square);
        }
        let n = normal.map(i64::from);
        // Product and index in one number, of which the largest is sought: a branch on which is larger could not be
        // predicted. Products have 33 bits; the complement of the index makes ties go to the lowest.
        let key = |c: &Candidate| c.dot(n) << 16 | i64::from(!c.index);
        let left = self.squares[square.number()].as_deref().unwrap_or_default();
        left.iter().map(key).max().map_or(0, |best| !(best as u16))
    }

    /// Finds who is left on a square, from those left on the square around it: it lies within that one, so whoever is beaten
    /// there is beaten here. (The margin is half as wide: also within.)
    #[cold]
    fn divide(&mut self, square: &Square) {
        let thorough = square.cells == self.cells;
        let left = match square.around() {
            None => unbeaten(square, &self.all, thorough),
            Some(around) => {
                if self.squares[around.number()].is_none() {
                    self.divide(&around);
                }
                let candidates = self.squares[around.number()].as_deref().unwrap_or_default();
                unbeaten(square, candidates, thorough)
            }
        };
        self.squares[square.number()] = Some(left.into());
    }
}

/// Squares of all coarser grids: where the grid of `cells` cells per edge begins. 6 (1 + 4 + 16 + ...).
#[inline]
fn first_of_grid(cells: u32) -> usize {
    (2 * (cells * cells - 1)) as usize
}

/// A square of a cube face at some fineness.
struct Square {
    face: u32,
    /// Squares per edge of the face.
    cells: u32,
    column: u32,
    row: u32,
}

impl Square {
    /// The square that a direction falls into; none for the zero vector.
    #[inline]
    fn of(normal: [i16; 3], cells: u32) -> Option<Self> {
        let [x, y, z] = normal.map(i32::from);
        let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
        let (axis, m, a, b) = if ax >= ay && ax >= az {
            (0, x, y, z)
        } else if ay >= az {
            (1, y, z, x)
        } else {
            (2, z, x, y)
        };
        if m == 0 {
            return None;
        }
        let scale = 1.0 / m.abs() as f32;
        let half = 0.5 * cells as f32;
        let place = |c: i32| (((c as f32 * scale + 1.0) * half) as u32).min(cells - 1);
        Some(Self { face: 2 * axis + u32::from(m < 0), cells, column: place(a), row: place(b) })
    }

    /// Its number among the squares of all grids.
    #[inline]
    fn number(&self) -> usize {
        first_of_grid(self.cells) + ((self.face * self.cells + self.row) * self.cells + self.column) as usize
    }

    /// The square of the next coarser grid that it is a quarter of.
    fn around(&self) -> Option<Self> {
        let cells = self.cells / 2;
        (cells > 0).then_some(Self { face: self.face, cells, column: self.column / 2, row: self.row / 2 })
    }

    /// The point at `(a, b)` of the face, where the face reaches from `-m` to `m`.
    fn point(&self, m: i64, a: i64, b: i64) -> [i64; 3] {
        let m = if self.face % 2 == 1 { -m } else { m };
        match self.face / 2 {
            0 => [m, a, b],
            1 => [b, m, a],
            _ => [a, b, m],
        }
    }

    fn centre_and_corners(&self) -> ([i64; 3], [[i64; 3]; 4]) {
        let m = i64::from(self.cells) * HALF_CELL;
        let middle = |i: u32| (2 * i64::from(i) + 1) * HALF_CELL - m;
        let (a, b) = (middle(self.column), middle(self.row));
        let reach = HALF_CELL + MARGIN;
        let corner = |s: i64, t: i64| self.point(m, a + s * reach, b + t * reach);
        (self.point(m, a, b), [corner(-1, -1), corner(1, -1), corner(-1, 1), corner(1, 1)])
    }
}

/// Candidates that the one nearest to the centre does not beat, in the finest cells also none of the others, ascending.
fn unbeaten(square: &Square, candidates: &[Candidate], thorough: bool) -> Vec<Candidate> {
    let (centre, corners) = square.centre_and_corners();
    let at_corners = |c: &Candidate| corners.map(|n| c.dot(n));
    let Some(nearest) = candidates.iter().max_by_key(|c| (c.dot(centre), std::cmp::Reverse(c.index))) else {
        return Vec::new();
    };
    let champion = (nearest.index, at_corners(nearest));
    let scored = candidates.iter().map(|c| (c, at_corners(c)));
    let left: Vec<_> = scored.filter(|(c, at)| !beats(champion, (c.index, *at))).collect();
    let stays = |&(c, at): &(&Candidate, [i64; 4])| {
        !thorough || !left.iter().any(|&(other, other_at)| beats((other.index, other_at), (c.index, at)))
    };
    left.iter().filter(|c| stays(c)).map(|(c, _)| **c).collect()
}

fn beats((i, a): (u16, [i64; 4]), (j, b): (u16, [i64; 4])) -> bool {
    let pairs = || a.into_iter().zip(b);
    pairs().all(|(p, q)| p > q) || (i < j && pairs().all(|(p, q)| p >= q))
}

#[cfg(test)]
mod tests;
