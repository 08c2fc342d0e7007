//! Samples of a grid: fewer points than it has, spread over all of it.
//!
//! An axis is given by its number of values; a point is a place on each axis, from 0. Both samples are the same on every machine for
//! the same seed. On short axes points may repeat; the caller skips them.
//!
//! | sample | property |
//! |---|---|
//! | [`latin_hypercube`] | along every axis, the counts of any two values differ by at most one |
//! | [`sobol`] | the same if the count is a power of two; boxes of several axes are filled evenly, too |

use crate::split_mix_64::SplitMix64;

/// A place on each axis, from 0.
pub type GridPoint = Vec<usize>;

/// Largest number of points of [`sobol`], a limit of its generator.
pub const MOST_SOBOL: usize = 1 << 16;
/// Maximum number of axes of a sample. The library has direction numbers for these.
pub const MOST_AXES: usize = sobol_burley::NUM_DIMENSIONS as usize;
/// Maximum number of points of [`latin_hypercube`].
pub const MOST_LATIN: usize = 100_000;

/// Reason for which a sample is impossible.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SampleError {
    /// An axis has no value.
    #[error("axis {0} has no value; expected one at least")]
    Empty(usize),
    /// Too many axes.
    #[error("{0} axes; expected at most {MOST_AXES}: vary fewer, or several together")]
    Axes(usize),
    /// Too many points.
    #[error("{points} points of a {sample} sample; expected at most {most}")]
    Points {
        /// Name of the method in a plan.
        sample: &'static str,
        /// Requested number of points.
        points: usize,
        /// Maximum number of points.
        most: usize,
    },
}

/// Returns all points of a grid with axes of these lengths; the last axis changes fastest.
///
/// ```
/// assert_eq!(basrelief_dse::sample::full_grid(&[2, 2]), [[0, 0], [0, 1], [1, 0], [1, 1]]);
/// ```
pub fn full_grid(axes: &[usize]) -> Vec<GridPoint> {
    axes.iter().fold(vec![vec![]], |all, &length| {
        all.iter().flat_map(|point| (0..length).map(move |place| [&point[..], &[place]].concat())).collect()
    })
}

/// Latin hypercube sample of McKay, Beckman and Conover (1979): each axis is divided into as many strata as there are points,
/// and each stratum holds one.
///
/// # Errors
/// Too many points or axes, or an axis without value.
///
/// ```
/// let points = basrelief_dse::sample::latin_hypercube(4, &[2, 4], 7).unwrap();
/// let mut second: Vec<usize> = points.iter().map(|point| point[1]).collect();
/// second.sort();
/// assert_eq!(second, [0, 1, 2, 3]);
/// ```
pub fn latin_hypercube(points: usize, axes: &[usize], seed: u32) -> Result<Vec<GridPoint>, SampleError> {
    check("latin_hypercube", points, axes, MOST_LATIN)?;
    let mut random_numbers = SplitMix64::new(seed);
    let mut sample = vec![Vec::with_capacity(axes.len()); points];
    for &length in axes {
        let mut strata: Vec<usize> = (0..points).collect();
        random_numbers.shuffle(&mut strata);
        // Twice the middle of a stratum, so that all stays whole.
        let place = |stratum: usize| (2 * stratum as u128 + 1) * length as u128 / (2 * points as u128);
        sample.iter_mut().zip(strata).for_each(|(point, stratum)| point.push(place(stratum) as usize));
    }
    Ok(sample)
}

/// Sobol sequence with the direction numbers of Joe and Kuo (2008), scrambled after Owen by the hash of Burley (2020), from its
/// start. Counts that are powers of two are the even ones.
///
/// # Errors
/// Too many points or axes, or an axis without value.
pub fn sobol(points: usize, axes: &[usize], seed: u32) -> Result<Vec<GridPoint>, SampleError> {
    check("sobol", points, axes, MOST_SOBOL)?;
    let at = |number: u32, axis: u32, length: usize| {
        // 24 bits, exact in double precision for any length.
        let share = f64::from(sobol_burley::sample(number, axis, seed));
        ((share * length as f64) as usize).min(length - 1)
    };
    let point = |number: u32| (0..).zip(axes).map(|(axis, &length)| at(number, axis, length)).collect();
    Ok((0..points as u32).map(point).collect())
}

fn check(sample: &'static str, points: usize, axes: &[usize], most: usize) -> Result<(), SampleError> {
    if let Some(empty) = axes.iter().position(|&length| length == 0) {
        return Err(SampleError::Empty(empty));
    }
    if axes.len() > MOST_AXES {
        return Err(SampleError::Axes(axes.len()));
    }
    if points > most { Err(SampleError::Points { sample, points, most }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the number of points per value of an axis.
    fn taken(points: &[GridPoint], axis: usize, length: usize) -> Vec<usize> {
        (0..length).map(|value| points.iter().filter(|point| point[axis] == value).count()).collect()
    }

    proptest! {
        #[test]
        fn a_latin_hypercube_takes_each_value_equally_often(
            points in 1usize..60, axes in prop::collection::vec(1usize..70, 1..5), seed: u32
        ) {
            let sample = latin_hypercube(points, &axes, seed).unwrap();
            prop_assert_eq!(sample.len(), points);
            for (axis, &length) in axes.iter().enumerate() {
                let taken = taken(&sample, axis, length);
                let (least, most) = (points / length, points.div_ceil(length));
                prop_assert!(taken.iter().all(|n| (least..=most).contains(n)), "{:?}", taken);
            }
        }

        #[test]
        fn a_sobol_sample_fills_every_elementary_box_of_two_axes(seed: u32, power in 1u32..9) {
            // The (t, m, 2)-net of the first two dimensions has t = 0: a box of each shape for each point.
            let points = 1usize << power;
            for first in 0..=power {
                let axes = [1usize << first, 1usize << (power - first)];
                let mut boxes: Vec<GridPoint> = sobol(points, &axes, seed).unwrap();
                boxes.sort();
                boxes.dedup();
                prop_assert_eq!(boxes.len(), points, "{:?}", axes);
            }
        }
    }

    /// Largest difference between the share of points in a box at the origin and the box's volume, over the boxes of a grid.
    fn discrepancy(points: &[GridPoint], side: usize) -> f64 {
        let corners = (1..=side).flat_map(|x| (1..=side).flat_map(move |y| (1..=side).map(move |z| [x, y, z])));
        let difference = |corner: [usize; 3]| {
            let inside = points.iter().filter(|point| point.iter().zip(corner).all(|(&at, end)| at < end)).count();
            let volume: f64 = corner.iter().map(|&end| end as f64 / side as f64).product();
            (inside as f64 / points.len() as f64 - volume).abs()
        };
        corners.map(difference).fold(0.0, f64::max)
    }

    #[test]
    fn samples_are_more_even_than_chance() {
        let axes = [16; 3];
        let mut random_numbers = SplitMix64::new(5_u64);
        let random: Vec<GridPoint> =
            (0..256).map(|_| axes.iter().map(|&length| random_numbers.below(length)).collect()).collect();
        let by_chance = discrepancy(&random, 16);
        let latin = discrepancy(&latin_hypercube(256, &axes, 5).unwrap(), 16);
        let sobol = discrepancy(&sobol(256, &axes, 5).unwrap(), 16);
        assert!(sobol < 0.025 && sobol < latin && latin < by_chance, "{sobol} {latin} {by_chance}");
    }

    #[test]
    fn seeds_differ_and_the_same_seed_is_the_same_sample() {
        let axes = [5, 7, 3];
        for sample in [latin_hypercube, sobol] {
            assert_eq!(sample(32, &axes, 1), sample(32, &axes, 1));
            assert_ne!(sample(32, &axes, 1), sample(32, &axes, 2));
        }
        // Held to the bit: a resumed sweep must find its points again.
        assert_eq!(latin_hypercube(4, &[4, 9], 1).unwrap(), [[2, 3], [0, 5], [3, 1], [1, 7]]);
        assert_eq!(sobol(4, &[4, 9], 1).unwrap(), [[1, 6], [3, 0], [0, 3], [2, 7]]);
    }

    #[test]
    fn impossible_sample_is_refused() {
        let says = |error: Result<Vec<GridPoint>, SampleError>, text: &str| assert_eq!(error.unwrap_err().to_string(), text);
        says(sobol(4, &[2, 0], 0), "axis 1 has no value; expected one at least");
        says(sobol(MOST_SOBOL + 1, &[2], 0), "65537 points of a sobol sample; expected at most 65536");
        says(latin_hypercube(4, &[1; 257], 0), "257 axes; expected at most 256: vary fewer, or several together");
        assert_eq!(sobol(0, &[3], 0), Ok(vec![]));
        assert_eq!(latin_hypercube(2, &[], 0), Ok(vec![vec![], vec![]]));
        assert_eq!(latin_hypercube(1, &[usize::MAX], 0), Ok(vec![vec![usize::MAX / 2]]));
    }
}
