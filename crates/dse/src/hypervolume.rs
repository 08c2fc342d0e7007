//! Hypervolume: the quality of a front as one number.
//!
//! The hypervolume of a front is the part of the space of costs that at least one of its points dominates, up to a reference
//! point. The larger, the better; a point that another dominates adds nothing. It is exact: the space is cut at every point
//! into slices along the last cost, and each slice is measured with one cost less.

use crate::front::{lexicographic, nondominated};
use crate::table::Table;

/// Maximum work in points over all nested slices, about half a second.
const MOST_WORK: f64 = 2e7;

/// The space that a front is measured in.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectiveSpace {
    /// Least cost by each objective.
    pub best: Vec<f64>,
    /// The corner up to which volume counts.
    pub reference: Vec<f64>,
}

impl ObjectiveSpace {
    /// Room beyond the worst point, as a share of the distance from best to worst, so that the ends of a front count, too.
    pub const MARGIN: f64 = 0.1;

    /// The space of all these costs: from the best by each objective to a tenth beyond the worst. Nothing without costs.
    pub fn of(costs: &[Vec<f64>]) -> Option<Self> {
        let extreme = |pick: fn(f64, f64) -> f64| {
            let merged = costs.iter().cloned().reduce(|a, b| a.iter().zip(&b).map(|(&a, &b)| pick(a, b)).collect());
            merged.filter(|merged| !merged.is_empty())
        };
        let (best, worst) = (extreme(f64::min)?, extreme(f64::max)?);
        let reference = best.iter().zip(&worst).map(|(best, worst)| worst + Self::MARGIN * (worst - best)).collect();
        Some(Self { best, reference })
    }

    /// The space of a table's [candidates](crate::candidates).
    pub fn of_table(table: &Table) -> Option<Self> {
        let costs: Vec<Vec<f64>> = crate::candidates(table).into_iter().map(|(_, costs)| costs).collect();
        Self::of(&costs)
    }

    /// Returns the share of the space that these costs dominate, from 0 to 1. An objective with equal costs in all points does not count.
    ///
    /// Returns `None` if it would take too long: from about a thousand points with three objectives, a hundred with four.
    pub fn hypervolume(&self, costs: &[Vec<f64>]) -> Option<f64> {
        let spread = |at: &usize| self.reference[*at] > self.best[*at];
        let counted: Vec<usize> = (0..self.best.len()).filter(spread).collect();
        let scaled = |cost: &Vec<f64>| -> Vec<f64> {
            // Costs below the best known costs count as the best known costs.
            counted.iter().map(|&at| ((cost[at] - self.best[at]) / (self.reference[at] - self.best[at])).max(0.0)).collect()
        };
        let scaled: Vec<Vec<f64>> = costs.iter().map(scaled).collect();
        hypervolume(&scaled, &vec![1.0; counted.len()])
    }
}

/// Returns the exact volume that these costs dominate up to a reference point. Equal to the bit for any order of the costs.
///
/// Returns `None` if points ^ (objectives - 1) exceeds 2e7, because it would take too long.
///
/// ```
/// use basrelief_dse::hypervolume::hypervolume;
///
/// // Two rectangles of 3 x 1 and 1 x 3 that share a square.
/// assert_eq!(hypervolume(&[[0.0, 2.0], [2.0, 0.0]], &[3.0, 3.0]), Some(5.0));
/// ```
pub fn hypervolume(costs: &[impl AsRef<[f64]>], reference: &[f64]) -> Option<f64> {
    let within = |cost: &&[f64]| cost.iter().zip(reference).all(|(cost, end)| cost < end);
    let points: Vec<&[f64]> = costs.iter().map(AsRef::as_ref).filter(within).collect();
    let points: Vec<&[f64]> = nondominated(&points).into_iter().map(|at| points[at]).collect();
    let work = (1..reference.len()).fold(1.0, |work, _| work * points.len() as f64);
    (work <= MOST_WORK).then(|| volume(points, reference))
}

/// Returns the volume of points that do not dominate each other.
fn volume(mut points: Vec<&[f64]>, reference: &[f64]) -> f64 {
    let Some((&end, rest)) = reference.split_last() else { return if points.is_empty() { 0.0 } else { 1.0 } };
    let last = rest.len();
    if rest.is_empty() {
        return points.iter().map(|point| end - point[0]).fold(0.0, f64::max);
    }
    points.sort_by(|a, b| a[last].partial_cmp(&b[last]).unwrap_or(std::cmp::Ordering::Equal).then(lexicographic(a, b)));
    if last == 1 {
        return area(&points, rest[0], end);
    }
    let ends = points.iter().skip(1).map(|point| point[last]).chain([end]);
    let mut below: Vec<&[f64]> = vec![];
    let mut sum = 0.0;
    for (point, end) in points.iter().zip(ends) {
        add(&mut below, &point[..last]);
        if end > point[last] {
            sum += (end - point[last]) * volume(below.clone(), rest);
        }
    }
    sum
}

/// Adds a point to a front.
fn add<'a>(front: &mut Vec<&'a [f64]>, point: &'a [f64]) {
    let covers = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a <= b);
    if !front.iter().any(|other| covers(other, point)) {
        front.retain(|other| !covers(point, other));
        front.push(point);
    }
}

/// Returns the area below points sorted by their last cost, which form the steps of a stair.
fn area(points: &[&[f64]], right: f64, top: f64) -> f64 {
    let (mut left, mut sum) = (right, 0.0);
    for point in points.iter().filter(|point| point[0] < right) {
        if point[0] < left {
            sum += (left - point[0]) * (top - point[1]);
            left = point[0];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Counts the unit cubes below `side` that a point dominates.
    fn counted(costs: &[Vec<f64>], objectives: usize, side: usize) -> f64 {
        let cube = |number: usize| -> Vec<f64> {
            (0..objectives).scan(number, |rest, _| Some((std::mem::replace(rest, *rest / side) % side) as f64)).collect()
        };
        let dominated = |cube: &Vec<f64>| costs.iter().any(|cost| cost.iter().zip(cube).all(|(cost, at)| cost <= at));
        (0..side.pow(objectives as u32)).map(cube).filter(dominated).count() as f64
    }

    fn whole_costs() -> impl Strategy<Value = (usize, Vec<Vec<f64>>)> {
        let number = (0u8..8).prop_map(f64::from);
        (1usize..5).prop_flat_map(move |n| (Just(n), prop::collection::vec(prop::collection::vec(number.clone(), n), 0..12)))
    }

    proptest! {
        #[test]
        fn the_volume_is_that_of_counted_cubes((objectives, costs) in whole_costs()) {
            prop_assert_eq!(hypervolume(&costs, &vec![6.0; objectives]), Some(counted(&costs, objectives, 6)));
        }

        #[test]
        fn the_order_of_points_changes_no_bit(costs in prop::collection::vec(prop::array::uniform3(0.0f64..1.0), 0..20)) {
            let reversed: Vec<_> = costs.iter().rev().collect();
            prop_assert_eq!(hypervolume(&costs, &[1.0; 3]), hypervolume(&reversed, &[1.0; 3]));
        }

        #[test]
        fn the_share_is_between_0_and_1_and_no_other_unit_changes_it(
            costs in prop::collection::vec(prop::array::uniform3(0u32..9), 1..20)
        ) {
            let scaled = |factor: f64| -> Vec<Vec<f64>> {
                costs.iter().map(|cost| cost.map(|c| f64::from(c) * factor).into()).collect()
            };
            let share = |costs: Vec<Vec<f64>>| ObjectiveSpace::of(&costs).unwrap().hypervolume(&costs).unwrap();
            let (one, other) = (share(scaled(1.0)), share(scaled(1000.0)));
            prop_assert!((0.0..=1.0).contains(&one) && (one - other).abs() < 1e-12, "{} {}", one, other);
        }
    }

    #[test]
    fn the_ends_of_a_front_count_and_equal_costs_do_not() {
        let costs = [[0.0, 10.0, 5.0], [10.0, 0.0, 5.0]].map(Vec::from);
        let space = ObjectiveSpace::of(&costs).unwrap();
        assert_eq!(space, ObjectiveSpace { best: vec![0.0, 0.0, 5.0], reference: vec![11.0, 11.0, 5.0] });
        // Two strips of 11 x 1 that share a square, of 11 x 11.
        let share = space.hypervolume(&costs).unwrap();
        assert!((share - 21.0 / 121.0).abs() < 1e-12, "{share}");
        // All equal by every objective: nothing is left to be gained.
        assert_eq!(ObjectiveSpace::of(&costs[..1]).unwrap().hypervolume(&costs[..1]), Some(1.0));
        assert_eq!(ObjectiveSpace::of(&[]), None);
    }

    #[test]
    fn too_many_points_are_refused() {
        let sphere = |n: usize| -> Vec<[f64; 4]> { (0..n).map(|i| [i as f64, (n - i) as f64, 0.0, 0.0]).collect() };
        assert!(hypervolume(&sphere(20), &[1e9; 4]).is_some());
        assert_eq!(hypervolume(&sphere(2000), &[1e9; 4]), None);
    }
}
