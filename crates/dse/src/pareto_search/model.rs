//! Gaussian process: predicts an objective at every point from the known points.
//!
//! The correlation of two points is a product over the axes: exp(-(d / l)^2 / 2). On an axis of numbers, d is the distance of the ranks
//! of two values, from 0 to 1; on another axis it is 1 for different values. The lengths l maximize the likelihood, with a prior near
//! 1. Ranks suit axes such as 16, 64, 256 without a choice of scale.

use super::cholesky::{Cholesky, dot};
use std::collections::BTreeMap;

/// Lengths that tuning may choose, as powers of two.
const LENGTHS: [f64; 8] = [0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// Noise on the diagonal, in shares of the variance: keeps the factor positive.
const NUGGET: f64 = 1e-6;
/// Weight of the prior of the lengths.
const PRIOR: f64 = 0.1;
/// Points that the lengths are tuned on: the latest.
const TUNED: usize = 120;
/// Growth of the number of points after which lengths are tuned again.
const AGAIN: f64 = 1.2;

/// An axis of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchAxis {
    /// Number of values; at least one.
    pub values: usize,
    /// True if the values have no order.
    pub categorical: bool,
}

/// Correlations of a set of axes with one length each.
#[derive(Clone, Debug)]
struct Kernel {
    /// For each axis, the correlation by distance of places.
    by_distance: Vec<Vec<f64>>,
}

impl Kernel {
    fn new(axes: &[SearchAxis], lengths: &[f64]) -> Self {
        let of_axis = |(axis, length): (&SearchAxis, &f64)| {
            let correlation = |d: f64| libm::exp(-0.5 * (d / length) * (d / length));
            let steps = axis.values.saturating_sub(1).max(1) as f64;
            (0..axis.values)
                .map(|step| correlation(if axis.categorical { step.min(1) as f64 } else { step as f64 / steps }))
                .collect()
        };
        Self { by_distance: axes.iter().zip(lengths).map(of_axis).collect() }
    }

    fn correlation(&self, a: &[usize], b: &[usize]) -> f64 {
        self.by_distance.iter().zip(a.iter().zip(b)).map(|(by_distance, (a, b))| by_distance[a.abs_diff(*b)]).product()
    }

    /// Returns the row of the covariance matrix for `point` after `known`.
    fn row(&self, known: &[&[usize]], point: &[usize]) -> Vec<f64> {
        known.iter().map(|other| self.correlation(point, other)).chain([1.0 + NUGGET]).collect()
    }
}

/// Mean and variance of a process that is known at some points, for values of mean 0 and variance 1.
#[derive(Clone, Debug, Default)]
struct Posterior {
    mean: f64,
    variance: f64,
    /// Right-hand side of the predicted mean, before it is solved backward.
    residual: Vec<f64>,
}

impl Posterior {
    fn new(factor: &Cholesky, values: &[f64]) -> Self {
        let (a, b) = (factor.forward(values), factor.forward(&vec![1.0; values.len()]));
        let mean = dot(&a, &b) / dot(&b, &b);
        let residual: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - mean * b).collect();
        // As if two more points with variance 1 had been seen.
        let variance = (dot(&residual, &residual) + 2.0) / (values.len() as f64 + 2.0);
        Self { mean, variance, residual }
    }
}

/// Predicted mean and standard deviation of each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Prediction {
    pub(super) means: Vec<f64>,
    pub(super) deviations: Vec<f64>,
}

/// A Gaussian process for one objective.
#[derive(Clone, Debug)]
pub(super) struct Model {
    axes: Vec<SearchAxis>,
    /// Length of each axis; empty until the first fit.
    lengths: Vec<f64>,
    /// Number of points at the last tuning.
    tuned_at: usize,
    kernel: Kernel,
    factor: Cholesky,
    /// Correlation of every point of the grid with each known point.
    columns: Vec<Vec<f64>>,
    known: Vec<Vec<usize>>,
    /// By point of the grid: its correlations with the known points, and the solution of the factor for them.
    solved: BTreeMap<usize, (Vec<f64>, Vec<f64>)>,
    posterior: Posterior,
    /// Of the known values.
    scale: ValueScale,
}

impl Model {
    pub(super) fn new(axes: &[SearchAxis]) -> Self {
        Self {
            axes: axes.into(),
            lengths: vec![],
            tuned_at: 0,
            kernel: Kernel::new(axes, &vec![1.0; axes.len()]),
            factor: Cholesky::default(),
            columns: vec![],
            known: vec![],
            solved: BTreeMap::new(),
            posterior: Posterior::default(),
            scale: ValueScale { mean: 0.0, deviation: 1.0 },
        }
    }

    /// Learns the values of these points from the beginning, and tunes the lengths if many points are new.
    pub(super) fn fit(&mut self, grid: &[Vec<usize>], known: &[&[usize]], values: &[f64]) {
        self.tune(known, &ValueScale::of(values).apply(values));
        self.kernel = Kernel::new(&self.axes, &self.lengths);
        (self.factor, self.columns, self.known) = (Cholesky::default(), vec![], vec![]);
        self.solved.clear();
        for point in known {
            self.add(grid, point);
        }
        self.learn(values);
    }

    /// Adds the last of these values, at `point`, and keeps the lengths.
    pub(super) fn extend(&mut self, grid: &[Vec<usize>], point: &[usize], values: &[f64]) {
        self.add(grid, point);
        self.learn(values);
    }

    fn add(&mut self, grid: &[Vec<usize>], point: &[usize]) {
        let known: Vec<&[usize]> = self.known.iter().map(Vec::as_slice).collect();
        let mut row = self.kernel.row(&known, point);
        while !self.factor.push(row.clone()) {
            // Points are different, so this is rounding. A larger nugget for one point changes little.
            if let Some(variance) = row.last_mut() {
                *variance += NUGGET;
            }
        }
        self.columns.push(grid.iter().map(|other| self.kernel.correlation(other, point)).collect());
        self.known.push(point.into());
    }

    fn learn(&mut self, values: &[f64]) {
        self.scale = ValueScale::of(values);
        self.posterior = Posterior::new(&self.factor, &self.scale.apply(values));
    }

    fn tune(&mut self, known: &[&[usize]], values: &[f64]) {
        if !self.lengths.is_empty() && (values.len() as f64) < AGAIN * self.tuned_at as f64 {
            return;
        }
        self.tuned_at = values.len();
        let latest = values.len().saturating_sub(TUNED);
        let misfit = |lengths: &[f64]| misfit(&Kernel::new(&self.axes, lengths), &known[latest..], &values[latest..], lengths);
        let isotropic = LENGTHS.map(|length| vec![length; self.axes.len()]);
        let start = if self.lengths.is_empty() {
            let first_least = |a: (f64, Vec<f64>), b: (f64, Vec<f64>)| if b.0 < a.0 { b } else { a };
            isotropic.into_iter().map(|lengths| (misfit(&lengths), lengths)).reduce(first_least).map(|(_, lengths)| lengths)
        } else {
            Some(self.lengths.clone())
        };
        self.lengths = descended(start.unwrap_or_default(), misfit);
    }

    /// Predicts every point of the grid. A deviation is what it would be if the nearest known point alone were known, which is no less
    /// than the exact [`deviation`](Self::deviation), and takes time in proportion to the known points.
    pub(super) fn predict(&self) -> Prediction {
        let weights = self.factor.backward(self.posterior.residual.clone());
        let points = self.columns.first().map_or(0, Vec::len);
        let (mut sums, mut nearest) = (vec![0.0; points], vec![0.0_f64; points]);
        for (column, weight) in self.columns.iter().zip(&weights) {
            for ((sum, nearest), correlation) in sums.iter_mut().zip(&mut nearest).zip(column) {
                *sum += correlation * weight;
                *nearest = nearest.max(*correlation);
            }
        }
        let ValueScale { mean, deviation: unit } = self.scale;
        let deviation = |nearest: f64| (self.posterior.variance * (1.0 - nearest * nearest)).max(0.0).sqrt() * unit;
        Prediction {
            means: sums.into_iter().map(|sum| (self.posterior.mean + sum) * unit + mean).collect(),
            deviations: nearest.into_iter().map(deviation).collect(),
        }
    }

    /// Returns the standard deviation of the prediction at a point of the grid.
    pub(super) fn deviation(&mut self, point: usize) -> f64 {
        // After a believed point, only the last element of each solution is new.
        let (correlations, solved) = self.solved.entry(point).or_default();
        let new = self.columns.iter().skip(correlations.len()).map(|column| column[point]);
        correlations.extend(new);
        self.factor.extend_forward(solved, correlations);
        (self.posterior.variance * (1.0 - dot(solved, solved))).max(0.0).sqrt() * self.scale.deviation
    }
}

/// Mean and standard deviation; 1 in place of a deviation of 0.
#[derive(Clone, Copy, Debug)]
struct ValueScale {
    mean: f64,
    deviation: f64,
}

impl ValueScale {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let deviation = (values.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>() / n).sqrt();
        Self { mean, deviation: if deviation > 0.0 { deviation } else { 1.0 } }
    }

    /// Returns the values with a mean of 0 and a deviation of 1.
    fn apply(self, values: &[f64]) -> Vec<f64> {
        values.iter().map(|y| (y - self.mean) / self.deviation).collect()
    }
}

/// Returns the negative logarithm of the likelihood of lengths, with their prior. Infinite if rounding prevents it.
fn misfit(kernel: &Kernel, known: &[&[usize]], values: &[f64], lengths: &[f64]) -> f64 {
    let mut factor = Cholesky::default();
    if !known.iter().enumerate().all(|(n, point)| factor.push(kernel.row(&known[..n], point))) {
        return f64::INFINITY;
    }
    let variance = Posterior::new(&factor, values).variance;
    let prior: f64 = lengths.iter().map(|length| libm::log(*length) * libm::log(*length)).sum();
    0.5 * (values.len() as f64 + 2.0) * libm::log(variance) + factor.half_log_determinant() + PRIOR * prior
}

/// Doubles and halves one length at a time while the misfit falls, at most three times over all axes.
fn descended(mut lengths: Vec<f64>, misfit: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut least = misfit(&lengths);
    for _ in 0..3 {
        let before = least;
        for axis in 0..lengths.len() {
            for factor in [2.0, 0.5] {
                let mut moved = lengths.clone();
                moved[axis] *= factor;
                if !LENGTHS.contains(&moved[axis]) {
                    continue;
                }
                let value = misfit(&moved);
                if value < least - 1e-9 {
                    (least, lengths) = (value, moved);
                }
            }
        }
        if least == before {
            break;
        }
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_are_predicted_exactly() {
        let axes = [SearchAxis { values: 9, categorical: false }, SearchAxis { values: 3, categorical: true }];
        let grid: Vec<Vec<usize>> = (0..9).flat_map(|a| (0..3).map(move |b| vec![a, b])).collect();
        let value = |point: &[usize]| (point[0] * point[0]) as f64 + [0.0, 7.0, 3.0][point[1]];
        let known: Vec<&[usize]> = grid.iter().step_by(2).map(Vec::as_slice).collect();
        let values: Vec<f64> = known.iter().map(|point| value(point)).collect();
        let mut model = Model::new(&axes);
        model.fit(&grid, &known, &values);
        let prediction = model.predict();
        for (number, point) in grid.iter().enumerate() {
            let (error, exact) = ((prediction.means[number] - value(point)).abs(), model.deviation(number));
            // The nugget keeps the exact deviation of a known point above 0.
            assert!(exact <= prediction.deviations[number] + 0.1, "{point:?}: {exact} {}", prediction.deviations[number]);
            if number % 2 == 0 {
                assert!(error < 0.1 && exact < 0.2, "{point:?}: {error} {exact}");
            } else {
                assert!(error < 5.0 && exact > 0.0, "{point:?}: {error} {exact}");
            }
        }
        // A believed mean adds a point without tuning, and makes its neighbourhood certain.
        let believed = [values, vec![prediction.means[1]]].concat();
        model.extend(&grid, &grid[1], &believed);
        assert!(model.deviation(1) < 0.2);
    }
}
