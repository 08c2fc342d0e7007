//! Search of a Pareto front with few runs, by Bayesian optimization.
//!
//! Ask for the next points with [`next`](ParetoSearch::next), run them, and report their costs with [`tell`](ParetoSearch::tell). The
//! search starts at the cheapest and at the dearest point. Then each objective gets a Gaussian process, and the next point is that with
//! the largest expected gain of hypervolume over the whole grid. Objectives that are known without a run, such as area, are exact.
//! Choices depend on the told costs only, so a search that is repeated makes the same choices. It draws no random numbers.
//!
//! The method and its constants were chosen on 14 grids of all four machines; `tests/oracles/exploration.py` is the same search, written
//! independently, and a test compares both.

mod cholesky;
mod gain;
mod model;

pub use model::SearchAxis;

use gain::{CostScale, Gain, inner_front};
use model::Model;
use std::collections::BTreeMap;

/// Maximum number of points per round.
const MOST_ROUND: usize = 8;
/// Points per round whose exact deviation is computed.
const SCREEN: usize = 512;
/// Points of a large grid that stay candidates in the second and later choices of a round.
const SHORTLIST: usize = 4096;
/// Known points that a model learns from: the front, and the latest.
const MOST_KNOWN: usize = 512;

/// Looks for the Pareto front of a set of points with few runs.
#[derive(Clone, Debug)]
pub struct ParetoSearch {
    axes: Vec<SearchAxis>,
    /// Places of each point on the axes.
    points: Vec<Vec<usize>>,
    /// Objectives that are known without a run, by number: the cost of each point.
    exact: BTreeMap<usize, Vec<f64>>,
    free: Vec<bool>,
    /// Chosen points with their costs, in the order of choice. `None` for a point that failed or violates a constraint.
    told: Vec<(usize, Option<Vec<f64>>)>,
    models: BTreeMap<usize, Model>,
}

/// What a round knows.
struct Round {
    /// Numbers of the objectives that differ between points.
    used: Vec<usize>,
    /// Numbers of the objectives that models learn.
    learned: Vec<usize>,
    /// Scale of each used objective.
    scales: Vec<CostScale>,
    /// Known points, and for each learned objective their values, as the model sees them.
    known: Vec<usize>,
    values: BTreeMap<usize, Vec<f64>>,
    /// Normalized costs of the used objectives, of all known points.
    costs: Vec<Vec<f64>>,
    /// For each used objective, predicted means and deviations of all points.
    means: Vec<Vec<f64>>,
    deviations: Vec<Vec<f64>>,
    /// Probability that a point runs and meets the constraints.
    chance: Vec<f64>,
}

impl ParetoSearch {
    /// Prepares a search among `points`, each with a place on every axis. `exact` has the costs of all points for the objectives that are
    /// known without a run, by number of the objective.
    ///
    /// ```
    /// use basrelief_dse::pareto_search::{ParetoSearch, SearchAxis};
    ///
    /// let axis = SearchAxis { values: 10, categorical: false };
    /// let points: Vec<Vec<usize>> = (0..10).flat_map(|a| (0..10).map(move |b| vec![a, b])).collect();
    /// let mut search = ParetoSearch::new(vec![axis; 2], points.clone(), Default::default());
    /// let mut runs = 0;
    /// while runs < 20 {
    ///     for point in search.next(20 - runs) {
    ///         let [a, b] = points[point][..] else { unreachable!() };
    ///         // More of the first is faster, more of either costs area.
    ///         search.tell(point, Some(vec![20.0 - a as f64, (a + b) as f64]));
    ///         runs += 1;
    ///     }
    /// }
    /// ```
    ///
    /// # Panics
    /// A point with a place outside of an axis, or exact costs for another number of points.
    pub fn new(axes: Vec<SearchAxis>, points: Vec<Vec<usize>>, exact: BTreeMap<usize, Vec<f64>>) -> Self {
        assert!(
            points.iter().all(|point| point.len() == axes.len() && point.iter().zip(&axes).all(|(at, axis)| *at < axis.values))
        );
        assert!(exact.values().all(|costs| costs.len() == points.len()));
        let free = vec![true; points.len()];
        Self { axes, points, exact, free, told: vec![], models: BTreeMap::new() }
    }

    /// Returns at most `most` points to run next, by number, the most promising first. Every one must be [told](Self::tell) before the next
    /// call. The list is empty if no point is left.
    pub fn next(&mut self, most: usize) -> Vec<usize> {
        let most = most.min(self.free.iter().filter(|free| **free).count());
        let chosen = match self.told.iter().filter(|(_, costs)| costs.is_some()).count() {
            _ if most == 0 => vec![],
            _ if self.told.is_empty() => self.ends(),
            0 | 1 => self.farthest().into_iter().collect(),
            _ => return self.round((self.told.len() / 4).clamp(1, MOST_ROUND).min(most)),
        };
        let chosen: Vec<usize> = chosen.into_iter().take(most).collect();
        chosen.iter().for_each(|point| self.free[*point] = false);
        chosen
    }

    /// Reports the costs of a point: finite numbers, as many for every point, of which the smaller is better. `None` for a point that
    /// failed or violates a constraint.
    pub fn tell(&mut self, point: usize, costs: Option<Vec<f64>>) {
        self.free[point] = false;
        self.told.push((point, costs));
    }

    /// Returns the cheapest and the dearest point by the first objective that is known without a run; else the first and the last point.
    fn ends(&self) -> Vec<usize> {
        let last = self.points.len() - 1;
        let Some(costs) = self.exact.values().next() else { return if last > 0 { vec![0, last] } else { vec![0] } };
        let least = (0..=last).fold(0, |best, at| if costs[at] < costs[best] { at } else { best });
        let most = (0..=last).fold(0, |best, at| if costs[at] >= costs[best] { at } else { best });
        if least == most { vec![least] } else { vec![least, most] }
    }

    /// Returns the distance of two points: the sum over the axes of the places between their values, as a share of the axis. Two values of
    /// a categorical axis are a whole axis apart.
    fn distance(&self, a: usize, b: usize) -> f64 {
        let of_axis = |((a, b), axis): ((&usize, &usize), &SearchAxis)| match axis.categorical {
            true => f64::from(u8::from(a != b)),
            false => a.abs_diff(*b) as f64 / (axis.values - 1).max(1) as f64,
        };
        self.points[a].iter().zip(&self.points[b]).zip(&self.axes).map(of_axis).sum()
    }

    /// Returns the free point that is farthest from all chosen points.
    fn farthest(&self) -> Option<usize> {
        let nearest = |at: usize| self.told.iter().map(|(other, _)| self.distance(at, *other)).fold(f64::INFINITY, f64::min);
        let free = (0..self.points.len()).filter(|at| self.free[*at]).map(|at| (nearest(at), at));
        free.reduce(|best, other| if other.0 > best.0 { other } else { best }).map(|(_, at)| at)
    }

    /// Chooses `size` points. After each choice its predicted costs are believed.
    fn round(&mut self, size: usize) -> Vec<usize> {
        let mut round = self.begin_round();
        self.fit(&mut round);
        let (mut chosen, mut candidates) = (vec![], self.candidates());
        while chosen.len() < size && !candidates.is_empty() {
            let Some(point) = self.best(&mut round, &mut candidates) else { break };
            chosen.push(point);
            self.free[point] = false;
            candidates.retain(|at| *at != point);
            if chosen.len() < size {
                self.believe(&mut round, point);
            }
        }
        chosen
    }

    fn candidates(&self) -> Vec<usize> {
        (0..self.points.len()).filter(|at| self.free[*at]).collect()
    }

    /// Gathers the known costs, normalized.
    fn begin_round(&self) -> Round {
        let known: Vec<(usize, &[f64])> =
            self.told.iter().filter_map(|(point, costs)| Some((*point, costs.as_deref()?))).collect();
        let objectives = known.first().map_or(0, |(_, costs)| costs.len());
        let range = |k: usize| -> (f64, f64) {
            let told = || known.iter().map(|(_, costs)| costs[k]);
            let all: Vec<f64> = self.exact.get(&k).map_or_else(|| told().collect(), Clone::clone);
            (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max))
        };
        let ranges: Vec<(f64, f64)> = (0..objectives).map(range).collect();
        let differs = |k: &usize| ranges[*k].1 > ranges[*k].0;
        let mut used: Vec<usize> = (0..objectives).filter(differs).collect();
        if used.is_empty() {
            used.push(0);
        }
        let logarithmic: Vec<bool> = (0..objectives).map(|k| known.iter().all(|(_, costs)| costs[k] > 0.0)).collect();
        let scale = |k: &usize| {
            let (low, high) = ranges[*k];
            CostScale { logarithmic: logarithmic[*k], low, extent: if high > low { 1.1 * (high - low) } else { 1.1 } }
        };
        let scales: Vec<CostScale> = used.iter().map(scale).collect();
        let varies = |k: &usize| known.iter().any(|(_, costs)| costs[*k] != known[0].1[*k]);
        let learned: Vec<usize> = used.iter().copied().filter(|k| !self.exact.contains_key(k)).filter(varies).collect();
        let normalized = |costs: &[f64]| used.iter().zip(&scales).map(|(k, scale)| scale.normalized(costs[*k])).collect();
        let costs: Vec<Vec<f64>> = known.iter().map(|(_, costs)| normalized(costs)).collect();
        let known = latest(known, &costs);
        let value = |k: usize, cost: f64| if logarithmic[k] { libm::log(cost) } else { cost };
        let values = learned.iter().map(|&k| (k, known.iter().map(|(_, costs)| value(k, costs[k])).collect())).collect();
        let constant = |k: &usize| match self.exact.get(k) {
            Some(costs) => costs.iter().map(|cost| value(*k, *cost)).collect(),
            None => vec![value(*k, known[0].1[*k]); self.points.len()],
        };
        let means = used.iter().map(constant).collect();
        let deviations = vec![vec![0.0; self.points.len()]; used.len()];
        let known = known.into_iter().map(|(point, _)| point).collect();
        Round { used, learned, scales, known, values, costs, means, deviations, chance: self.chance() }
    }

    /// Returns the probability that each point runs, from the inverse cubes of its distances to points that did and did not.
    fn chance(&self) -> Vec<f64> {
        if self.told.iter().all(|(_, costs)| costs.is_some()) {
            return vec![1.0; self.points.len()];
        }
        let chance = |point: usize| {
            let weight = |other: usize| 1.0 / libm::pow(self.distance(point, other).max(1e-9), 3.0);
            let sum = |ran: bool| -> f64 {
                self.told.iter().filter(|(_, costs)| costs.is_some() || !ran).map(|(other, _)| weight(*other)).sum()
            };
            (sum(true) / sum(false)).clamp(0.01, 1.0)
        };
        (0..self.points.len()).map(chance).collect()
    }

    /// Learns the known values and predicts all points.
    fn fit(&mut self, round: &mut Round) {
        for (k, values) in &round.values {
            let model = self.models.entry(*k).or_insert_with(|| Model::new(&self.axes));
            let known: Vec<&[usize]> = round.known.iter().map(|at| self.points[*at].as_slice()).collect();
            model.fit(&self.points, &known, values);
        }
        self.predict(round);
    }

    fn predict(&self, round: &mut Round) {
        for (at, k) in round.used.iter().enumerate() {
            if round.learned.contains(k) {
                let prediction = self.models[k].predict();
                (round.means[at], round.deviations[at]) = (prediction.means, prediction.deviations);
            }
        }
    }

    /// Returns the candidate with the largest expected gain. Bounds of all gains come first, then exact deviations of the best.
    fn best(&mut self, round: &mut Round, candidates: &mut Vec<usize>) -> Option<usize> {
        let gain = Gain::new(&inner_front(&round.costs), &round.scales);
        let of = |round: &Round, at: usize| {
            let all = |of_objective: &[Vec<f64>]| of_objective.iter().map(|values| values[at]).collect::<Vec<f64>>();
            gain.of(&all(&round.means), &all(&round.deviations)) * round.chance[at]
        };
        let mut bounds: Vec<(f64, usize)> = candidates.iter().map(|&at| (of(round, at), at)).collect();
        // Equal bounds stay in the order of the points.
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        if bounds.len() > SHORTLIST {
            bounds.truncate(SHORTLIST);
            *candidates = bounds.iter().map(|(_, at)| *at).collect();
            candidates.sort_unstable();
        }
        let screened: Vec<usize> = bounds.into_iter().take(SCREEN).map(|(_, at)| at).collect();
        for (objective, k) in round.used.iter().enumerate().filter(|(_, k)| round.learned.contains(k)) {
            if let Some(model) = self.models.get_mut(k) {
                screened.iter().for_each(|&at| round.deviations[objective][at] = model.deviation(at));
            }
        }
        let first_largest = |best: (f64, usize), other: (f64, usize)| if other.0 > best.0 { other } else { best };
        let best = screened.iter().map(|&at| (of(round, at), at)).reduce(first_largest)?;
        if best.0 > 1e-15 {
            return Some(best.1);
        }
        // No point promises a gain: take the least certain one.
        let doubt = |at: usize| round.deviations.iter().map(|values| values[at]).sum::<f64>() * round.chance[at];
        screened.iter().map(|&at| (doubt(at), at)).reduce(first_largest).map(|(_, at)| at)
    }

    /// Takes the predicted costs of a point for its costs, until it has run.
    fn believe(&mut self, round: &mut Round, point: usize) {
        let costs =
            round.scales.iter().zip(&round.means).map(|(scale, means)| scale.normalized(scale.cost(means[point]))).collect();
        round.costs.push(costs);
        round.known.push(point);
        for (at, k) in round.used.iter().enumerate() {
            if let Some(values) = round.values.get_mut(k) {
                values.push(round.means[at][point]);
                if let Some(model) = self.models.get_mut(k) {
                    model.extend(&self.points, &self.points[point], values);
                }
            }
        }
        self.predict(round);
    }
}

/// Returns at most [`MOST_KNOWN`] of the known points, in order: those of the front, and the latest.
fn latest<'a>(known: Vec<(usize, &'a [f64])>, costs: &[Vec<f64>]) -> Vec<(usize, &'a [f64])> {
    let mut surplus = known.len().saturating_sub(MOST_KNOWN);
    let front = crate::front::nondominated(costs);
    let mut kept = known;
    let mut at = 0;
    kept.retain(|_| {
        let drop = surplus > 0 && front.binary_search(&at).is_err();
        at += 1;
        surplus -= usize::from(drop);
        !drop
    });
    let surplus = kept.len().saturating_sub(MOST_KNOWN);
    kept.split_off(surplus)
}

#[cfg(test)]
mod tests;
