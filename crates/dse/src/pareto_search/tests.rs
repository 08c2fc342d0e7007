//! Tests of the search.

use super::*;
use crate::sample::full_grid;
use proptest::prelude::*;

fn numeric(values: usize) -> SearchAxis {
    SearchAxis { values, categorical: false }
}

fn grid(axes: &[SearchAxis]) -> Vec<Vec<usize>> {
    full_grid(&axes.iter().map(|axis| axis.values).collect::<Vec<_>>())
}

/// Runs a search and returns the points in the order of choice.
fn searched(
    axes: &[SearchAxis],
    budget: usize,
    exact: BTreeMap<usize, Vec<f64>>,
    run: impl Fn(&[usize]) -> Option<Vec<f64>>,
) -> Vec<usize> {
    let points = grid(axes);
    let mut search = ParetoSearch::new(axes.into(), points.clone(), exact);
    let mut order = vec![];
    loop {
        let next = search.next(budget - order.len());
        if next.is_empty() {
            return order;
        }
        for point in next {
            search.tell(point, run(&points[point]));
            order.push(point);
        }
    }
}

/// Cycles fall with either place, and the area rises.
fn costs(point: &[usize]) -> Option<Vec<f64>> {
    let [a, b] = [point[0] as f64, point[1] as f64];
    Some(vec![1000.0 / (1.0 + a) + 500.0 / (1.0 + b), 3.0 * a + b * b])
}

#[test]
fn search_beats_evenly_spread_points() {
    let axes = [numeric(12), numeric(12)];
    let points = grid(&axes);
    let all: Vec<Vec<f64>> = points.iter().filter_map(|point| costs(point)).collect();
    let space = crate::ObjectiveSpace::of(&all).unwrap();
    let share = |chosen: Vec<usize>| {
        let costs: Vec<Vec<f64>> = chosen.into_iter().map(|at| all[at].clone()).collect();
        space.hypervolume(&costs).unwrap() / space.hypervolume(&all).unwrap()
    };
    let found = share(searched(&axes, 20, BTreeMap::new(), costs));
    let spread = share((0..20).map(|n| n * 7).collect());
    assert!(found > 0.985 && found > spread + 0.01, "{found} {spread}");
}

#[test]
fn start_is_cheapest_and_dearest_by_known_cost() {
    let axes = [numeric(3), numeric(4)];
    let area = grid(&axes).iter().map(|point| (2 - point[0]) as f64 + point[1] as f64).collect();
    let order = searched(&axes, 2, [(1, area)].into(), costs);
    // Place (2, 0) has area 0, and (0, 3) has area 5.
    assert_eq!(order, [8, 3]);
}

#[test]
fn failed_points_are_not_chosen_twice_and_all_end() {
    let axes = [numeric(4), SearchAxis { values: 3, categorical: true }];
    let order = searched(&axes, 99, BTreeMap::new(), |point| costs(point).filter(|_| point[1] != 1));
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..12).collect::<Vec<_>>());
    assert_eq!(searched(&axes, 99, BTreeMap::new(), |_| None).len(), 12);
    assert_eq!(searched(&[], 5, BTreeMap::new(), |_| Some(vec![1.0])), [0]);
}

#[test]
fn unfit_region_is_avoided() {
    let axes = [numeric(10), numeric(10)];
    let order = searched(&axes, 30, BTreeMap::new(), |point| costs(point).filter(|_| point[0] < 5));
    let unfit = order.iter().filter(|at| **at / 10 >= 5).count();
    assert!(unfit <= 10, "{unfit} of 30 runs");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn budget_extends_the_same_choices(weights in prop::array::uniform4(1u8..9)) {
        let run = |point: &[usize]| {
            let [a, b, c] = [0, 1, 2].map(|k| point[k] as f64);
            let [p, q, r, s] = weights.map(f64::from);
            Some(vec![p * a + q * (4.0 - b), r * (5.0 - a) * (1.0 + c), s * c + b])
        };
        let axes = [numeric(5), numeric(4), numeric(3)];
        let order = searched(&axes, 24, BTreeMap::new(), run);
        // Rounds end elsewhere with a smaller budget, but only the last round differs.
        prop_assert_eq!(&searched(&axes, 12, BTreeMap::new(), run)[..10], &order[..10]);
    }
}

#[test]
fn four_objectives_stay_bounded() {
    let axes = [numeric(6), numeric(6), numeric(6)];
    let run = |point: &[usize]| {
        let [a, b, c] = [0, 1, 2].map(|k| point[k] as f64);
        Some(vec![a, b, c, 15.0 - a - b - c])
    };
    assert_eq!(searched(&axes, 60, BTreeMap::new(), run).len(), 60);
}
