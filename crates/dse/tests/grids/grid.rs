//! Grids that were swept as a whole, as CSV files, and the order in which a search chooses their points.

use basrelief_dse::ObjectiveSpace;
use basrelief_dse::pareto_search::{ParetoSearch, SearchAxis};
use basrelief_dse::sample::full_grid;
use std::collections::BTreeMap;
use std::error::Error;

/// All points of a plan with their costs; the last axis changes fastest.
pub struct Grid {
    pub axes: Vec<SearchAxis>,
    pub places: Vec<Vec<usize>>,
    /// `None` for a point that failed.
    pub costs: Vec<Option<Vec<f64>>>,
    /// Objectives that are known without a run.
    exact: BTreeMap<usize, Vec<f64>>,
}

impl Grid {
    /// Reads columns `axis NAME`, then `min NAME` or `max NAME` for objectives, which are empty for a point that failed.
    pub fn read(path: &str) -> Result<Self, Box<dyn Error>> {
        let mut reader = csv::Reader::from_path(path)?;
        let head: Vec<String> = reader.headers()?.iter().map(Into::into).collect();
        let rows = reader.records().collect::<Result<Vec<_>, _>>()?;
        let (of_axes, objectives): (Vec<usize>, Vec<usize>) = (0..head.len()).partition(|at| head[*at].starts_with("axis "));
        let columns: Vec<(Vec<&str>, bool)> = of_axes.iter().map(|at| values(rows.iter().map(|row| &row[*at]))).collect();
        let axes: Vec<SearchAxis> =
            columns.iter().map(|(values, categorical)| SearchAxis { values: values.len(), categorical: *categorical }).collect();
        let places = full_grid(&axes.iter().map(|axis| axis.values).collect::<Vec<_>>());
        let mut costs = vec![None; places.len()];
        for row in &rows {
            let place = |((values, _), at): (&(Vec<&str>, bool), &usize)| values.iter().position(|value| *value == &row[*at]);
            let point: Vec<usize> = columns.iter().zip(&of_axes).filter_map(place).collect();
            let number = point.iter().zip(&axes).fold(0, |number, (at, axis)| number * axis.values + at);
            let cost = |&at: &usize| Some(row[at].parse::<f64>().ok()? * if head[at].starts_with("min ") { 1.0 } else { -1.0 });
            costs[number] = objectives.iter().map(cost).collect();
        }
        let known = |name: &str| name.contains("hardware") || name.contains("memories.bytes");
        let known = objectives.iter().enumerate().filter(|(_, at)| known(&head[**at])).map(|(k, _)| k);
        let exact = known.map(|k| (k, filled(&places, &costs, k))).collect();
        Ok(Self { axes, places, costs, exact })
    }

    /// Returns the points that a search chooses, in order.
    pub fn order(&self, budget: usize) -> Vec<usize> {
        let mut search = ParetoSearch::new(self.axes.clone(), self.places.clone(), self.exact.clone());
        let mut order = vec![];
        loop {
            let next = search.next(budget - order.len());
            if next.is_empty() {
                return order;
            }
            for point in next {
                search.tell(point, self.costs[point].clone());
                order.push(point);
            }
        }
    }

    /// Returns the share of the hypervolume of all points that these have.
    #[allow(dead_code, reason = "the example uses it, and the test does not")]
    pub fn share(&self, points: &[usize]) -> Option<f64> {
        let all: Vec<Vec<f64>> = self.costs.iter().flatten().cloned().collect();
        let some: Vec<Vec<f64>> = points.iter().filter_map(|at| self.costs[*at].clone()).collect();
        let space = ObjectiveSpace::of(&all)?;
        Some(space.hypervolume(&some)? / space.hypervolume(&all)?)
    }
}

/// The values of an axis in order, and true if they are categories.
fn values<'a>(column: impl Iterator<Item = &'a str>) -> (Vec<&'a str>, bool) {
    let mut seen: Vec<&str> = vec![];
    column.for_each(|value| {
        if !seen.contains(&value) {
            seen.push(value)
        }
    });
    let number = |value: &str| value.split('+').next().and_then(|value| value.parse::<f64>().ok());
    if seen.iter().all(|value| number(value).is_some()) {
        seen.sort_by(|a, b| number(a).partial_cmp(&number(b)).unwrap_or(std::cmp::Ordering::Equal));
        return (seen, false);
    }
    let categorical = seen.len() > 2;
    (seen, categorical)
}

/// The costs of all points by one objective. A failed point has the cost of the nearest point that ran.
fn filled(places: &[Vec<usize>], costs: &[Option<Vec<f64>>], k: usize) -> Vec<f64> {
    let distance = |a: &[usize], b: &[usize]| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).sum::<usize>();
    let ran = || places.iter().zip(costs).filter_map(|(place, costs)| Some((place, costs.as_ref()?[k])));
    let nearest = |place: &Vec<usize>| ran().min_by_key(|(other, _)| distance(place, other)).map_or(0.0, |(_, cost)| cost);
    places.iter().zip(costs).map(|(place, costs)| costs.as_ref().map_or_else(|| nearest(place), |costs| costs[k])).collect()
}
