//! Code books: reference normals computed from the surface's own N' (spec variants (b) and (e)).

use crate::NearestSearch;
use basrelief_shading::quantize_unit;

/// A direction and its number of occurrences.
type WeightedDirection = ([i16; 3], i64);

/// A code book, and the effort of its clustering.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CodeBook {
    /// The reference normals.
    pub normals: Vec<[i16; 3]>,
    /// Number of seeds that had to be found. It is 0 if no more directions are distinct than there are entries.
    pub seeds: u32,
    /// Passes over all directions that moved entries, or found that none moved.
    pub passes: u32,
}

/// Computes at most `entries` reference normals for `normals` by k-means. Seeds are as far from each other as possible. Then
/// `passes` times, every direction joins its nearest reference normal, which moves to the mean of its directions.
///
/// Directions are unit vectors of `entry_bits` bits before they are clustered. If no more than `entries` of them are distinct,
/// they are the code book, in ascending order. Otherwise the book has the order of the seeds. The zero vector has no direction
/// and is left out, except from a book of nothing else. All arithmetic except the length of a mean is in whole numbers and in a
/// fixed order, so every platform computes the same bits.
pub fn build_code_book(normals: impl Iterator<Item = [i16; 3]>, entries: u32, passes: u32, entry_bits: u32) -> CodeBook {
    let directions = count_directions(normals, entry_bits);
    let entries = entries.max(1) as usize;
    if directions.is_empty() {
        return CodeBook { normals: vec![[0; 3]], ..CodeBook::default() };
    }
    if directions.len() <= entries {
        return CodeBook { normals: directions.into_iter().map(|(d, _)| d).collect(), ..CodeBook::default() };
    }
    let mut book = CodeBook { normals: seeds(&directions, entries), seeds: entries as u32, passes: 0 };
    while book.passes < passes {
        let moved = means(&directions, &book.normals, entry_bits);
        book.passes += 1;
        if moved == book.normals {
            break;
        }
        book.normals = moved;
    }
    book
}

fn count_directions(normals: impl Iterator<Item = [i16; 3]>, bits: u32) -> Vec<WeightedDirection> {
    let mut all: Vec<[i16; 3]> = normals.map(|n| unit(n.map(i64::from), bits)).filter(|d| *d != [0; 3]).collect();
    all.sort_unstable();
    let mut counted: Vec<WeightedDirection> = Vec::new();
    for direction in all {
        match counted.last_mut() {
            Some((last, count)) if *last == direction => *count += 1,
            _ => counted.push((direction, 1)),
        }
    }
    counted
}

/// Returns the vector at unit length in steps of 1/32767. Zero stays zero.
fn unit(v: [i64; 3], bits: u32) -> [i16; 3] {
    let v = v.map(|c| c as f64);
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    if length > 0.0 { v.map(|c| quantize_unit(c / length, bits)) } else { [0; 3] }
}

/// Returns the seeds. The first is the most frequent direction. Each further seed is the direction farthest from all before it
/// (the lowest of several).
fn seeds(directions: &[WeightedDirection], entries: usize) -> Vec<[i16; 3]> {
    let mut book = Vec::with_capacity(entries);
    let mut next = directions.iter().rev().max_by_key(|(_, count)| *count).map(|(d, _)| *d);
    let mut nearest = vec![i64::MIN; directions.len()];
    while let Some(seed) = next.filter(|_| book.len() < entries) {
        book.push(seed);
        for (best, (direction, _)) in nearest.iter_mut().zip(directions) {
            *best = (*best).max(dot(seed, *direction));
        }
        next = nearest.iter().zip(directions).min_by_key(|(best, _)| **best).map(|(_, (d, _))| *d);
    }
    book
}

fn dot(a: [i16; 3], b: [i16; 3]) -> i64 {
    (0..3).map(|i| i64::from(a[i]) * i64::from(b[i])).sum()
}

/// Computes one pass. A reference normal without directions does not move.
fn means(directions: &[WeightedDirection], book: &[[i16; 3]], bits: u32) -> Vec<[i16; 3]> {
    let mut search = NearestSearch::new(book, directions.len());
    let mut sums = vec![[0_i64; 3]; book.len()];
    for (direction, count) in directions {
        if let Some(sum) = sums.get_mut(usize::from(search.nearest(*direction))) {
            for (s, c) in sum.iter_mut().zip(direction) {
                *s += i64::from(*c) * count;
            }
        }
    }
    let mean = |(sum, old): (&[i64; 3], &[i16; 3])| if *sum == [0; 3] { *old } else { unit(*sum, bits) };
    sums.iter().zip(book).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_shading::{ReferenceNormals, reference_normals};
    use proptest::prelude::*;

    #[test]
    fn few_distinct_normals_become_the_book() {
        let normals = [[0, 0, 5], [0, 7, 0], [0, 0, 9], [0; 3], [0, 7, 0]];
        let book = build_code_book(normals.into_iter(), 2, 8, 16);
        assert_eq!((book.normals, book.seeds, book.passes), (vec![[0, 0, 32_767], [0, 32_767, 0]], 0, 0));
        assert_eq!(build_code_book([[0; 3]; 4].into_iter(), 2, 8, 16).normals, [[0; 3]]);
    }

    #[test]
    fn k_means_finds_clusters() {
        // Three tight bunches, in whose middles three entries must end.
        let bunch = |x: i16, y: i16, z: i16| (-5..=5).map(move |d| [x + 10 * d, y - 10 * d, z + 5 * d]);
        let normals = bunch(30_000, 300, 200).chain(bunch(-200, 30_000, 0)).chain(bunch(100, 200, -30_000));
        let mut book = build_code_book(normals, 3, 8, 16).normals;
        book.sort_unstable();
        for (entry, axis, sign) in [(book[0], 1, 1), (book[1], 2, -1), (book[2], 0, 1)] {
            assert!(entry[axis] * sign > 32_700, "{book:?}");
        }
    }

    /// Returns the mean squared distance between unit normals and their entries, in units of the unit vector.
    fn error(normals: &[[i16; 3]], book: &[[i16; 3]]) -> f64 {
        let mut search = NearestSearch::new(book, normals.len());
        let one = |n: &[i16; 3]| {
            let q = book[usize::from(search.nearest(*n))];
            (0..3).map(|i| (f64::from(n[i] - q[i]) / 32_767.0).powi(2)).sum::<f64>()
        };
        normals.iter().map(one).sum::<f64>() / normals.len() as f64
    }

    #[test]
    fn code_book_beats_fixed_table_of_same_size() {
        // A cap of the sphere, similar to the normals of a polygon.
        let sphere = reference_normals(0, 20_000, ReferenceNormals::Fibonacci, true, 16).unwrap();
        let cap: Vec<[i16; 3]> = sphere.into_iter().filter(|n| n[2] > 26_000).collect();
        let fixed = reference_normals(1, 64, ReferenceNormals::Fibonacci, true, 16).unwrap();
        let book = build_code_book(cap.iter().copied(), 64, 8, 16).normals;
        assert_eq!(book.len(), 64);
        assert!(error(&cap, &book) < 0.2 * error(&cap, &fixed));
        let seeded = build_code_book(cap.iter().copied(), 64, 0, 16).normals;
        assert!(error(&cap, &book) < error(&cap, &seeded));
    }

    proptest! {
        #[test]
        fn book_never_exceeds_requested_entries(
            normals in prop::collection::vec(prop::array::uniform3(-99i16..99), 1..300), entries in 1u32..40,
        ) {
            let book = build_code_book(normals.iter().copied(), entries, 3, 10);
            prop_assert!((1..=entries as usize).contains(&book.normals.len()));
            let mut mirrored = normals.clone();
            mirrored.reverse();
            prop_assert_eq!(book, build_code_book(mirrored.into_iter(), entries, 3, 10));
        }
    }
}
