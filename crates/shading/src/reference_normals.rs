//! Reference normals: the contents of the VQ tables (121), one table per MIP level.

use crate::lod::LEVELS;
use std::f64::consts::PI;

/// Maximum number of entries of a table, because indexes have 16 bits.
pub const MAX_ENTRIES: usize = 65_536;

/// Distribution of the reference normals of a table over the sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceNormals {
    /// Spherical Fibonacci lattice: even for every number of entries (assumed).
    #[default]
    Fibonacci,
    /// Face normals of a tetrahedron whose faces are divided k x k and projected onto the sphere: 4 k^2 entries (stated: the
    /// polyhedron of 256 faces; k = 8).
    Tetrahedron,
}

/// A table that cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// The number of entries exceeds the range of an index.
    #[error("a VQ table of {0} entries: expected 1..={MAX_ENTRIES}; change `replacement.entries`")]
    Entries(usize),
    /// The tetrahedron has no division into this many faces.
    #[error(
        "a tetrahedron has 4 k^2 faces, not {entries}; set `replacement.entries` to {below} or {above}, or \
         `replacement.table` to fibonacci"
    )]
    Tetrahedron {
        /// Requested number of entries.
        entries: usize,
        /// Next smaller number of entries that exists.
        below: usize,
        /// Next larger number of entries that exists.
        above: usize,
    },
}

impl ReferenceNormals {
    /// Checks that a table of this many entries exists.
    ///
    /// # Errors
    /// Returns an error with the nearest valid sizes if it does not.
    pub fn check(self, entries: usize) -> Result<(), TableError> {
        if !(1..=MAX_ENTRIES).contains(&entries) {
            return Err(TableError::Entries(entries));
        }
        match self {
            Self::Fibonacci => Ok(()),
            Self::Tetrahedron => divisions(entries).map(|_| ()),
        }
    }
}

/// VQ tables (121) of a machine. The replacement unit searches them, and the brightness fetch unit lights them.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct TableSet {
    /// Entries of the table of each MIP level, unless an object fixes the number.
    pub entries: [u32; LEVELS],
    /// Distribution over the sphere.
    pub table: ReferenceNormals,
    /// True if each level has vectors of its own.
    pub distinct: bool,
    /// Bits per component, 8..=16.
    pub entry_bits: u32,
}

impl TableSet {
    /// Returns the number of entries of a level's table. Levels above 7 count as 7. `object` is the number that an object fixes.
    #[inline]
    pub fn entries(&self, level: u8, object: Option<u32>) -> u32 {
        object.unwrap_or(self.entries[usize::from(level).min(LEVELS - 1)])
    }

    /// Returns the reference normals of a level's table of `entries` entries.
    ///
    /// # Errors
    /// Returns an error if no such table exists.
    pub fn normals(&self, level: u8, entries: u32) -> Result<Vec<[i16; 3]>, TableError> {
        reference_normals(level, entries as usize, self.table, self.distinct, self.entry_bits)
    }

    /// Checks the table sizes of all levels.
    ///
    /// # Errors
    /// Returns the error of the first level whose table does not exist.
    pub fn check(&self) -> Result<(), TableError> {
        self.entries.iter().try_for_each(|&n| self.table.check(n as usize))
    }

    /// Returns the bytes of one entry as loaded: three components, packed (derived).
    pub fn entry_bytes(&self) -> u32 {
        (3 * self.entry_bits).div_ceil(8)
    }
}

/// Rounds a component -1..=1 to `bits` (8..=16, clamped), in steps of 1/32767. All normals are stored in this form.
#[inline]
pub fn quantize_unit(c: f64, bits: u32) -> i16 {
    let steps = f64::from((1_i32 << (bits.clamp(8, 16) - 1)) - 1);
    ((c * steps).round() * (32_767.0 / steps)).round() as i16
}

/// Computes the VQ table (121) of MIP level `level`: `entries` unit vectors in world space, in steps of 1/32767. Each component
/// is quantized to `entry_bits` bits (8..=16, clamped).
///
/// If `distinct` is true, the vectors of level k are those of level 0 turned by a rotation of its own. Quantization errors then
/// differ between levels, and interpolation averages them (stated). Otherwise every level has the vectors of level 0, for the
/// ablation.
///
/// # Errors
/// Returns an error if no table of this size exists.
pub fn reference_normals(
    level: u8,
    entries: usize,
    table: ReferenceNormals,
    distinct: bool,
    entry_bits: u32,
) -> Result<Vec<[i16; 3]>, TableError> {
    table.check(entries)?;
    let vectors = match table {
        ReferenceNormals::Fibonacci => fibonacci(entries),
        ReferenceNormals::Tetrahedron => tetrahedron(divisions(entries)?),
    };
    let turn = rotation(if distinct { level } else { 0 });
    Ok(vectors.into_iter().map(|v| turn.map(|row| dot(row, v)).map(|c| quantize_unit(c, entry_bits))).collect())
}

/// Returns n points: heights divide the sphere into equal areas, and longitudes step by the golden ratio.
fn fibonacci(n: usize) -> Vec<[f64; 3]> {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / n as f64;
        let turns = i as f64 * golden;
        let angle = 2.0 * PI * (turns - turns.floor());
        let radius = (1.0 - z * z).sqrt();
        [radius * libm::cos(angle), radius * libm::sin(angle), z]
    };
    (0..n).map(point).collect()
}

fn divisions(entries: usize) -> Result<usize, TableError> {
    let k = (1..).take_while(|k| 4 * k * k <= entries).last().unwrap_or(1);
    if 4 * k * k == entries {
        return Ok(k);
    }
    Err(TableError::Tetrahedron { entries, below: 4 * k * k, above: 4 * (k + 1) * (k + 1) })
}

const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
/// Counter-clockwise seen from outside.
const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

fn tetrahedron(k: usize) -> Vec<[f64; 3]> {
    let mut normals = Vec::with_capacity(4 * k * k);
    for face in FACES {
        let [a, b, c] = face.map(|i| CORNERS[i]);
        // Points of the divided face, projected onto the sphere. Without the projection all k^2 normals of a face would be equal.
        let point = |i: usize, j: usize| {
            let (s, t) = (i as f64 / k as f64, j as f64 / k as f64);
            unit(std::array::from_fn(|d| a[d] + s * (b[d] - a[d]) + t * (c[d] - a[d])))
        };
        for i in 0..k {
            for j in 0..k - i {
                normals.push(face_normal(point(i, j), point(i + 1, j), point(i, j + 1)));
                if i + j + 2 <= k {
                    normals.push(face_normal(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)));
                }
            }
        }
    }
    normals
}

fn face_normal(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    unit([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

/// Returns the rows of the rotation matrix of a level (assumed), the identity for level 0. The axis is no symmetry axis of either
/// table. Each level turns by the golden angle, so any two levels are at least 0.3 rad apart.
fn rotation(level: u8) -> [[f64; 3]; 3] {
    let angle = f64::from(level) * PI * (3.0 - 5f64.sqrt());
    let (s, c) = (libm::sin(angle), libm::cos(angle));
    let [x, y, z] = unit([1.0, 2.0, 4.0]);
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn set(level: u8, table: ReferenceNormals, distinct: bool) -> BTreeSet<[i16; 3]> {
        reference_normals(level, 256, table, distinct, 16).unwrap().into_iter().collect()
    }

    // Claim: as claim_1_7_each_level_has_its_own_map_and_table.
    #[test]
    fn claim_1_levels_share_no_reference_normal() {
        for table in [ReferenceNormals::Fibonacci, ReferenceNormals::Tetrahedron] {
            let all: BTreeSet<[i16; 3]> = (0..8).flat_map(|level| set(level, table, true)).collect();
            assert_eq!(all.len(), 8 * 256, "{table:?}");
        }
    }

    #[test]
    fn identical_tables_equal_level_0() {
        for level in 0..8 {
            assert_eq!(set(level, ReferenceNormals::Fibonacci, false), set(0, ReferenceNormals::Fibonacci, true));
        }
    }

    #[test]
    fn divided_tetrahedron_has_256_outward_faces() {
        let normals = tetrahedron(8);
        assert_eq!(normals.len(), 256);
        let sum = normals.iter().fold([0.0; 3], |s, n| [s[0] + n[0], s[1] + n[1], s[2] + n[2]]);
        assert!(sum.iter().all(|c| c.abs() < 1e-9), "{sum:?}");
        for corner in CORNERS {
            let nearest = normals.iter().map(|&n| dot(n, unit(corner))).fold(-1.0, f64::max);
            assert!(nearest > 0.98, "{nearest}");
        }
    }

    #[test]
    fn tables_cover_the_sphere() {
        // Largest angle from any direction to the nearest of 256 entries. A perfect covering would have 0.136 rad.
        let probes = fibonacci(5_000);
        for (table, limit) in [(ReferenceNormals::Fibonacci, 0.17), (ReferenceNormals::Tetrahedron, 0.35)] {
            let normals = reference_normals(3, 256, table, true, 16).unwrap();
            let cosine = |p: [f64; 3]| normals.iter().map(|n| dot(n.map(|c| f64::from(c) / 32_767.0), p)).fold(-1.0, f64::max);
            let worst = probes.iter().map(|&p| cosine(p)).fold(1.0, f64::min);
            assert!(libm::acos(worst) < limit, "{table:?}: {}", libm::acos(worst));
        }
    }

    #[test]
    fn invalid_table_size_error_names_valid_sizes() {
        let error = |n, table| reference_normals(0, n, table, true, 16).unwrap_err().to_string();
        assert!(error(0, ReferenceNormals::Fibonacci).contains("1..=65536"));
        assert!(error(65_537, ReferenceNormals::Fibonacci).contains("replacement.entries"));
        assert!(error(200, ReferenceNormals::Tetrahedron).contains("196 or 256"));
        assert!(error(3, ReferenceNormals::Tetrahedron).contains("4 or 16"));
        assert_eq!(reference_normals(7, 65_536, ReferenceNormals::Tetrahedron, true, 16).unwrap().len(), 65_536);
    }

    #[test]
    fn object_fixes_number_of_entries() {
        let tables = TableSet {
            entries: [256, 128, 64, 32, 16, 16, 16, 16],
            table: ReferenceNormals::Fibonacci,
            distinct: true,
            entry_bits: 11,
        };
        assert_eq!([0, 2, 9].map(|k| tables.entries(k, None)), [256, 64, 16]);
        assert_eq!(tables.entries(2, Some(100)), 100);
        assert_eq!(tables.entry_bytes(), 5);
        assert!(tables.check().is_ok());
        assert!(TableSet { entries: [0; 8], ..tables }.check().is_err());
    }

    proptest! {
        #[test]
        fn entries_are_unit_vectors_within_half_a_step(n in 1usize..2_000, level in 0u8..8, bits in 8u32..=16) {
            let step = 32_767.0 / f64::from((1 << (bits - 1)) - 1);
            for v in reference_normals(level, n, ReferenceNormals::Fibonacci, true, bits).unwrap() {
                let length = dot(v.map(f64::from), v.map(f64::from)).sqrt();
                prop_assert!((length - 32_767.0).abs() <= 0.5 * 3f64.sqrt() * (step + 1.0));
            }
        }
    }
}
