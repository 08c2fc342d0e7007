//! Share of the hypervolume that exploration finds on a grid that was swept as a whole, by number of runs.
//!
//! ```text
//! cargo run -p basrelief-dse --example explored -- sweep.csv "cycles.total min" "hardware.area_ge min" -- fifo.indexes.depth ...
//! ```
//!
//! Objectives come before the second `--`, axes after it. For each budget it prints the smallest and the mean share over eight
//! seeds, and the same of a Sobol sequence of as many points.

use basrelief_dse::explorer::{Explorer, KnownCosts};
use basrelief_dse::sample::{GridPoint, sobol};
use basrelief_dse::{Objective, ObjectiveSpace};
use std::collections::BTreeMap;
use std::error::Error;

const PERCENT: [usize; 4] = [5, 10, 15, 25];
const SEEDS: u32 = 8;
/// Number of points per round of the exploration.
const BATCH: usize = 8;

/// A grid that is known as a whole.
struct Grid {
    lengths: Vec<usize>,
    costs: BTreeMap<GridPoint, Option<Vec<f64>>>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = "expected: sweep.csv OBJECTIVE ... -- AXIS ...";
    let (file, rest) = arguments.split_first().ok_or(usage)?;
    let mut parts = rest.split(|word| word == "--");
    let objectives = parts.next().ok_or(usage)?.iter().map(|word| word.parse()).collect::<Result<Vec<Objective>, _>>()?;
    let grid = read(file, &objectives, parts.next().ok_or(usage)?)?;
    let all: Vec<Vec<f64>> = grid.costs.values().flatten().cloned().collect();
    let space = ObjectiveSpace::of(&all).ok_or("no point has all objectives")?;
    let whole = space.hypervolume(&all).ok_or("too many points on the front")?;
    println!("{} points, {} run; hypervolume {whole:.6}", grid.lengths.iter().product::<usize>(), grid.costs.len());
    println!("percent  points  explored: least, mean  sampled: least, mean");
    for percent in PERCENT {
        let budget = (grid.costs.len() * percent / 100).max(1);
        let share = |costs: Vec<Vec<f64>>| space.hypervolume(&costs).map_or(0.0, |volume| volume / whole);
        let explored =
            (0..SEEDS).map(|seed| Ok(share(explore(&grid, budget, seed)?))).collect::<Result<Vec<f64>, Box<dyn Error>>>()?;
        let sample = |seed| Ok(share(sobol(budget, &grid.lengths, seed)?.iter().filter_map(|point| grid.at(point)).collect()));
        let sampled = (0..SEEDS).map(sample).collect::<Result<Vec<f64>, Box<dyn Error>>>()?;
        println!("{percent:7}  {budget:6}  {}          {}", told(&explored), told(&sampled));
    }
    Ok(())
}

impl Grid {
    fn at(&self, point: &GridPoint) -> Option<Vec<f64>> {
        self.costs.get(point).cloned().flatten()
    }
}

fn told(shares: &[f64]) -> String {
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    format!("{:.4}, {mean:.4}", shares.iter().copied().fold(1.0, f64::min))
}

/// Costs of all that an exploration runs.
fn explore(grid: &Grid, budget: usize, seed: u32) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let explorer = Explorer::new(&grid.lengths, budget, seed)?;
    let mut known = KnownCosts::new();
    loop {
        let points = explorer.next(&known, BATCH, &|_| vec![]);
        if points.is_empty() {
            return Ok(known.into_values().flatten().collect());
        }
        known.extend(points.into_iter().map(|point| (point.clone(), grid.at(&point))));
    }
}

fn read(file: &str, objectives: &[Objective], axes: &[String]) -> Result<Grid, Box<dyn Error>> {
    let mut reader = csv::Reader::from_path(file)?;
    let headers = reader.headers()?.clone();
    // A header is a name and a unit.
    let column = |name: &str| {
        let found = headers.iter().position(|header| header.split(" [").next() == Some(name));
        found.ok_or_else(|| format!("{file} has no column `{name}`"))
    };
    let objectives = objectives.iter().map(|of| Ok((column(&of.column)?, of.goal))).collect::<Result<Vec<_>, String>>()?;
    let axes = axes.iter().map(|name| column(name)).collect::<Result<Vec<_>, String>>()?;
    let rows = reader.records().collect::<Result<Vec<_>, _>>()?;
    // Values in the order of the plan, which is that of the rows.
    let mut values: Vec<Vec<String>> = vec![vec![]; axes.len()];
    let mut costs = BTreeMap::new();
    for row in &rows {
        let place = |(values, &at): (&mut Vec<String>, &usize)| {
            values.iter().position(|value| *value == row[at]).unwrap_or_else(|| {
                values.push(row[at].into());
                values.len() - 1
            })
        };
        let point: GridPoint = values.iter_mut().zip(&axes).map(place).collect();
        let cost = objectives.iter().map(|&(at, goal)| row[at].parse().ok().map(|x| goal.cost(x))).collect();
        costs.insert(point, cost);
    }
    Ok(Grid { lengths: values.iter().map(Vec::len).collect(), costs })
}
