//! Expected gain of hypervolume: how much a point is likely to add to a front.
//!
//! The region that no point of the front dominates is cut into boxes. With independent objectives, the expected gain is a sum over
//! boxes of products over objectives, so it is exact. Costs are normalized: 0 is the best of all points, 1 the end of the space.

use crate::front::nondominated;

/// Maximum number of boxes. A front with more is thinned, so that four and more objectives stay fast.
const MOST_BOXES: usize = 20_000;

/// Relation of a predicted value to a normalized cost.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostScale {
    /// True if the logarithm of the cost is predicted.
    pub(super) logarithmic: bool,
    /// Cost that is 0 when normalized.
    pub(super) low: f64,
    /// Cost of a normalized unit.
    pub(super) extent: f64,
}

impl CostScale {
    pub(super) fn normalized(&self, cost: f64) -> f64 {
        (cost - self.low) / self.extent
    }

    /// Returns the cost of a predicted value.
    pub(super) fn cost(&self, value: f64) -> f64 {
        // e^700 is close to the largest number.
        if self.logarithmic { libm::exp(value.min(700.0)) } else { value }
    }

    /// Returns the expected distance by which a cost lies below a normalized `limit`, for a value with this mean and deviation.
    fn below(&self, limit: f64, mean: f64, deviation: f64) -> f64 {
        let (limit, s) = (limit * self.extent + self.low, deviation.max(1e-12));
        let tail = |d: f64| 0.5 * libm::erfc(-d / std::f64::consts::SQRT_2);
        let expected = if self.logarithmic {
            let d = if limit > 0.0 { (libm::log(limit) - mean) / s } else { -40.0 };
            limit * tail(d) - libm::exp(mean + s * s / 2.0) * tail(d - s)
        } else {
            let d = (limit - mean) / s;
            (limit - mean) * tail(d) + s * libm::exp(-d * d / 2.0) / (2.0 * std::f64::consts::PI).sqrt()
        };
        if expected > 0.0 { expected / self.extent } else { 0.0 }
    }
}

/// A front, prepared for the gains of many points.
#[derive(Debug)]
pub(super) struct Gain<'a> {
    scales: &'a [CostScale],
    /// For each objective, the ends of its boxes, ascending; below the first there is no end.
    cuts: Vec<Vec<f64>>,
    /// For each box and objective, places of its ends in `cuts`; 0 stands for no end below.
    boxes: Vec<Vec<(usize, usize)>>,
}

/// Normalized costs that no others dominate and that lie inside of the space, each once.
pub(super) fn inner_front(costs: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut front: Vec<Vec<f64>> = nondominated(costs).into_iter().map(|at| costs[at].clone()).collect();
    front.retain(|costs| costs.iter().all(|cost| *cost < 1.0));
    front.sort_by(|a, b| crate::front::lexicographic(a, b));
    front.dedup();
    front
}

impl<'a> Gain<'a> {
    /// Prepares an [inner front](inner_front) with one scale per objective.
    pub(super) fn new(front: &[Vec<f64>], scales: &'a [CostScale]) -> Self {
        let front = thinned(front, scales.len());
        let ranges = boxes(&front, scales.len());
        let ends = |objective: usize| {
            let mut ends: Vec<f64> = ranges.iter().flat_map(|b| [b[objective].0, b[objective].1]).collect();
            ends.retain(|end| *end != f64::NEG_INFINITY);
            ends.sort_by(f64::total_cmp);
            ends.dedup();
            ends
        };
        let cuts: Vec<Vec<f64>> = (0..scales.len()).map(ends).collect();
        let place = |objective: usize, end: f64| cuts[objective].partition_point(|cut| *cut <= end);
        let numbered =
            |b: Vec<(f64, f64)>| b.iter().enumerate().map(|(k, (low, high))| (place(k, *low), place(k, *high))).collect();
        let boxes = ranges.into_iter().map(numbered).collect();
        Self { scales, cuts, boxes }
    }

    /// Returns the expected gain of a point with these means and deviations, one per objective.
    pub(super) fn of(&self, means: &[f64], deviations: &[f64]) -> f64 {
        let below: Vec<Vec<f64>> = (0..self.scales.len())
            .map(|k| {
                let at = |cut: &f64| self.scales[k].below(*cut, means[k], deviations[k]);
                std::iter::once(0.0).chain(self.cuts[k].iter().map(at)).collect()
            })
            .collect();
        let volume =
            |b: &Vec<(usize, usize)>| -> f64 { b.iter().zip(&below).map(|(&(low, high), e)| e[high] - e[low]).product() };
        self.boxes.iter().map(volume).sum()
    }
}

/// Cuts the region below 1 that no point of the front dominates into disjoint boxes: a range for each objective.
fn boxes(front: &[Vec<f64>], objectives: usize) -> Vec<Vec<(f64, f64)>> {
    if objectives == 1 {
        return vec![vec![(f64::NEG_INFINITY, front.iter().map(|costs| costs[0]).fold(1.0, f64::min))]];
    }
    let last = objectives - 1;
    let mut cuts: Vec<f64> = front.iter().map(|costs| costs[last]).filter(|cost| *cost < 1.0).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts.push(1.0);
    let (mut low, mut all) = (f64::NEG_INFINITY, vec![]);
    for high in cuts {
        let below: Vec<Vec<f64>> = front.iter().filter(|costs| costs[last] <= low).map(|costs| costs[..last].to_vec()).collect();
        for mut ranges in boxes(&inner_front(&below), last) {
            ranges.push((low, high));
            all.push(ranges);
        }
        low = high;
    }
    all
}

/// Returns points of a front that are spread over it, few enough for [`MOST_BOXES`]. Gains beside the others are overestimated.
fn thinned(front: &[Vec<f64>], objectives: usize) -> Vec<Vec<f64>> {
    let fits =
        |points: usize| (1..objectives).try_fold(1_usize, |n, _| n.checked_mul(points + 1)).is_some_and(|n| n <= MOST_BOXES);
    if fits(front.len()) {
        return front.to_vec();
    }
    let most = (1..front.len()).take_while(|points| fits(*points)).count().max(1);
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
    let mut kept = vec![0];
    let mut distances: Vec<f64> = front.iter().map(|costs| distance(costs, &front[0])).collect();
    while kept.len() < most {
        // The farthest from all that are kept; of several the first.
        let farthest = (0..front.len()).fold(0, |best, at| if distances[at] > distances[best] { at } else { best });
        kept.push(farthest);
        let nearer = |(costs, old): (&Vec<f64>, &f64)| old.min(distance(costs, &front[farthest]));
        distances = front.iter().zip(&distances).map(nearer).collect();
    }
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|at| front[at].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hypervolume::hypervolume;
    use proptest::prelude::*;

    const LINEAR: CostScale = CostScale { logarithmic: false, low: 0.0, extent: 1.0 };

    proptest! {
        #[test]
        fn certain_gain_is_growth_of_hypervolume(
            costs in prop::collection::vec(prop::collection::vec(0.01f64..0.99, 3), 1..9),
            point in prop::collection::vec(0.01f64..0.99, 3),
            objectives in 1usize..4,
        ) {
            let cut = |costs: &Vec<f64>| costs[..objectives].to_vec();
            let known: Vec<Vec<f64>> = costs.iter().map(cut).collect();
            let point = cut(&point);
            let reference = vec![1.0; objectives];
            let volume = |costs: &[Vec<f64>]| hypervolume(costs, &reference).unwrap();
            let growth = volume(&[known.clone(), vec![point.clone()]].concat()) - volume(&known);
            let scales = vec![LINEAR; objectives];
            let gain = Gain::new(&inner_front(&known), &scales).of(&point, &vec![0.0; objectives]);
            prop_assert!((gain - growth).abs() < 1e-9, "{} {}", gain, growth);
        }
    }

    #[test]
    fn uncertain_gain_is_mean_over_samples() {
        let scales = [LINEAR, CostScale { logarithmic: true, low: 0.5, extent: 4.0 }];
        let front = vec![vec![0.2, 0.7], vec![0.5, 0.3]];
        let (means, deviations) = ([0.3, 0.4], [0.2, 0.5]);
        // Middles of equally likely intervals of the normal distribution, by bisection of its distribution function.
        let quantile = |share: f64| {
            let (mut low, mut high) = (-9.0, 9.0);
            for _ in 0..60 {
                let middle: f64 = (low + high) / 2.0;
                if 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2) < share { low = middle } else { high = middle }
            }
            low
        };
        let steps = 300;
        let normal: Vec<f64> = (0..steps).map(|n| quantile((f64::from(n) + 0.5) / f64::from(steps))).collect();
        let base = hypervolume(&front, &[1.0, 1.0]).unwrap();
        let mut sum = 0.0;
        for a in &normal {
            for b in &normal {
                let point = [means[0] + deviations[0] * a, (libm::exp(means[1] + deviations[1] * b) - 0.5) / 4.0];
                // Below 0 the boxes have no end, and the hypervolume has none either.
                sum += hypervolume(&[&front[..], &[point.to_vec()]].concat(), &[1.0, 1.0]).unwrap() - base;
            }
        }
        let (expected, gain) = (sum / f64::from(steps * steps), Gain::new(&front, &scales).of(&means, &deviations));
        assert!((gain - expected).abs() < 0.002, "{gain} {expected}");
    }

    #[test]
    fn many_objectives_have_few_boxes() {
        let front: Vec<Vec<f64>> =
            (0..200).map(|n| (0..6).map(|k| f64::from((n * (7 + 4 * k) + k) % 199) / 200.0).collect()).collect();
        let scales = vec![LINEAR; 6];
        let gain = Gain::new(&inner_front(&front), &scales);
        assert!(gain.boxes.len() <= MOST_BOXES, "{}", gain.boxes.len());
    }
}
