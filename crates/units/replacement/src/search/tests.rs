//! Tests of the grid against the scan that it replaces.

use super::*;
use basrelief_shading::{ReferenceNormals, reference_normals};
use proptest::prelude::*;

/// Computes the nearest by its definition.
fn scan(normals: &[[i16; 3]], n: [i16; 3]) -> u16 {
    let mut best = (i64::MIN, 0);
    for (i, q) in normals.iter().enumerate() {
        let dot = (0..3).map(|k| i64::from(q[k]) * i64::from(n[k])).sum();
        if dot > best.0 {
            best = (dot, i as u16);
        }
    }
    best.1
}

/// A random generator, because `proptest` would take minutes for this many cases.
struct TestRandom(u64);

impl TestRandom {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn normal(&mut self) -> [i16; 3] {
        let [a, b, c] = [self.next(), self.next(), self.next()];
        // Every fourth vector is short, because ties are common there.
        let shift = if a % 4 == 0 { 12 } else { 0 };
        [a, b, c].map(|v| ((v >> 20) as i16) >> shift)
    }
}

#[test]
fn search_equals_scan_for_a_million_directions() {
    let mut random = TestRandom(0x2545_f491_4f6c_dd1d);
    for (table, entries, bits, searches) in [
        (ReferenceNormals::Fibonacci, 256, 16, 150_000),
        (ReferenceNormals::Fibonacci, 64, 16, 300_000),
        (ReferenceNormals::Tetrahedron, 256, 8, 150_000),
        (ReferenceNormals::Fibonacci, 7, 16, 1_000_000),
        (ReferenceNormals::Fibonacci, 1_000, 8, 50_000),
        (ReferenceNormals::Fibonacci, 1, 16, 1_000),
    ] {
        let normals = reference_normals(3, entries, table, true, bits).unwrap();
        let mut search = NearestSearch::new(&normals, usize::MAX);
        for _ in 0..searches {
            let n = random.normal();
            assert_eq!(search.nearest(n), scan(&normals, n), "{table:?} {entries} {n:?}");
        }
    }
}

#[test]
fn search_equals_scan_on_cell_edges() {
    let normals = reference_normals(0, 256, ReferenceNormals::Fibonacci, true, 16).unwrap();
    let mut search = NearestSearch::new(&normals, usize::MAX);
    let edges: Vec<i16> = (-16..=16).flat_map(|i| [-1, 0, 1].map(|d| (i * 2_048 + d).clamp(-32_768, 32_767) as i16)).collect();
    for &a in &edges {
        for &b in &edges {
            for n in [[32_767, a, b], [a, -32_768, b], [b, a, 32_767], [a, b, -32_767], [-32_767, a, b]] {
                assert_eq!(search.nearest(n), scan(&normals, n), "{n:?}");
            }
        }
    }
}

// Claim: as erratum_nearest_normal_has_the_largest_inner_product.
#[test]
fn zero_vector_takes_lowest_index() {
    let normals = reference_normals(0, 256, ReferenceNormals::Fibonacci, true, 16).unwrap();
    assert_eq!(NearestSearch::new(&normals, 1_000_000).nearest([0; 3]), 0);
    assert_eq!(NearestSearch::new(&[], 10).nearest([1, 2, 3]), 0);
}

// Claim: as erratum_nearest_normal_has_the_largest_inner_product.
#[test]
fn erratum_nearest_has_largest_inner_product() {
    let normals = [[0, 0, -32_767], [0, 0, 32_767], [0, 0, 32_767]];
    assert_eq!(NearestSearch::new(&normals, 1_000_000).nearest([0, 0, 9]), 1);
}

#[test]
fn cell_of_full_table_has_few_candidates() {
    let normals = reference_normals(0, 256, ReferenceNormals::Fibonacci, true, 16).unwrap();
    let mut search = NearestSearch::new(&normals, usize::MAX);
    let mut random = TestRandom(1);
    for _ in 0..50_000 {
        search.nearest(random.normal());
    }
    let asked: Vec<u32> = search.finest.iter().map(|[first, end]| end - first).filter(|fours| *fours > 0).collect();
    assert!(asked.len() > 1_000, "{} cells were asked for", asked.len());
    let mean = f64::from(asked.iter().sum::<u32>()) / asked.len() as f64;
    assert!(mean < 1.5, "{mean} times four candidates per cell");
    assert_eq!(NearestSearch::new(&normals, 8).cells, 1);
}

#[test]
fn squares_divide_on_first_direction() {
    let normals = reference_normals(0, 256, ReferenceNormals::Fibonacci, true, 16).unwrap();
    let mut search = NearestSearch::new(&normals, usize::MAX);
    let divided = |search: &NearestSearch| {
        let asked = search.finest.iter().filter(|[_, end]| *end > 0).count();
        search.squares.iter().flatten().count() + asked
    };
    assert_eq!(divided(&search), 0);
    search.nearest([1, 2, 32_767]);
    assert_eq!(divided(&search), 5, "grids of 1, 2, 4, 8 and 16 squares per edge");
    search.nearest([2, 1, 32_766]);
    assert_eq!(divided(&search), 5);
}

/// Returns reference normals of the largest allowed length.
fn longest() -> impl Strategy<Value = [i16; 3]> {
    (0..=32_767_i16, 0..=32_767_i16, any::<[bool; 3]>(), 0..3_usize).prop_map(|(a, b, negative, turn)| {
        let c = (i32::from(i16::MAX) * 2 + 1 - i32::from(a) - i32::from(b)).min(i16::MAX.into()) as i16;
        let mut normal = [a, b, c];
        normal.rotate_left(turn);
        std::array::from_fn(|i| if negative[i] { -normal[i] } else { normal[i] })
    })
}

proptest! {
    /// Clustered tables with duplicates, like code books, and any number of searches.
    #[test]
    fn search_equals_scan_for_any_table(
        normals in prop::collection::vec(prop::array::uniform3(-40i16..40), 1..60),
        directions in prop::collection::vec(prop::array::uniform3(-50i16..50), 200),
        effort in prop_oneof![Just(0usize), Just(2_000), Just(usize::MAX)],
    ) {
        let mut search = NearestSearch::new(&normals, effort);
        for n in directions {
            prop_assert_eq!(search.nearest(n), scan(&normals, n), "{:?}", n);
        }
    }

    #[test]
    fn search_equals_scan_for_extreme_components(
        normals in prop::collection::vec(longest(), 1..40),
        directions in prop::collection::vec(prop::array::uniform3(any::<i16>()), 100),
    ) {
        let mut search = NearestSearch::new(&normals, usize::MAX);
        for n in directions {
            prop_assert_eq!(search.nearest(n), scan(&normals, n), "{:?}", n);
        }
    }
}
