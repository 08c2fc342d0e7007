//! Finds the Pareto front of a plan with few of its points.
//!
//! [`ParetoSearch`] chooses the next points from the figures of the known points. They are run like the points of a sweep, and stored in
//! the same folder. A killed exploration makes the same choices again and finds their results. It also reuses the points of a sweep.
//!
//! Hardware figures follow from the configuration alone. An objective of them is known for every point without a run, and a point that
//! violates a constraint on them is never run.

use crate::front::candidates;
use crate::hypervolume::ObjectiveSpace;
use crate::pareto_search::{ParetoSearch, SearchAxis};
use crate::plan::{Axis, Plan, PlanPoint};
use crate::tables::table_of;
use crate::{Cell, SplitMix64, SweepError, SweepFolder, SweepHost, SweepJob, SweepProgress, execute, figures};
use basrelief_report::model::Hardware;
use basrelief_threads as threads;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

/// Points per piece of work of one thread.
const PIECE: usize = 64;
/// Time of a resimulation, as a share of the time of a run: 154 of 447 ns per fragment on the host that the lab notebook names.
const RESIMULATION: f64 = 0.35;

/// Limit of an exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// Maximum number of points.
    Points(usize),
    /// Time after which no round begins. The choices are the same as without it, but their number depends on the host.
    Time(Duration),
}

/// Options of an exploration.
#[derive(Clone, Copy, Debug)]
pub struct ExploreOptions {
    /// Limit.
    pub budget: Budget,
    /// Order of points that promise the same: 0 takes the first in the plan; another seed lists some axes backwards.
    pub seed: u32,
}

/// Result of an exploration.
#[derive(Debug)]
pub struct ExplorationResult {
    /// The plan with the points alone that were chosen.
    pub plan: Plan,
    /// Numbers of points by the way in which their results were obtained.
    pub tally: SweepProgress,
    /// Share of the hypervolume of the whole grid. `None` unless all points of the grid have results and the volume is positive.
    pub share: Option<f64>,
    /// Number of points that are unfit by their configuration alone, and so never run.
    pub unfit: usize,
    /// True if the whole grid was run, because that is no more work than the exploration.
    pub grid_was_cheaper: bool,
}

/// Chooses points of a plan, a few at a time, and runs them: the front of these is close to that of all.
///
/// # Errors
/// A plan of several inputs; and those of [`execute()`].
pub fn explore(
    plan: Plan,
    options: ExploreOptions,
    work: &SweepJob<'_>,
    folder: &SweepFolder,
    host: &dyn SweepHost,
) -> Result<ExplorationResult, SweepError> {
    if plan.inputs.len() != 1 {
        let count = plan.inputs.len();
        return Err(SweepError(format!(
            "input: {count} inputs; expected one: a front is of one input, so write a plan for each"
        )));
    }
    let known = known_costs(&plan);
    let grid_was_cheaper = matches!(options.budget, Budget::Points(points) if grid_is_cheaper(&plan, points));
    let mut tally = SweepProgress::default();
    let chosen: BTreeSet<usize> = if grid_was_cheaper {
        let points: Vec<&PlanPoint> = plan.points.iter().collect();
        tally = execute(&plan, &SweepJob { points: &points, ..*work }, folder, host)?;
        (0..plan.points.len()).collect()
    } else {
        search(&plan, &known, options, &mut |points, tally| costs(&plan, points, work, folder, host, tally), &mut tally)?
    };
    let share = hypervolume_share(&plan, &chosen, folder)?;
    let unfit = known.iter().filter(|known| known.is_none()).count();
    let mut number = 0..;
    let mut plan = plan;
    plan.points.retain(|_| number.next().is_some_and(|number| chosen.contains(&number)));
    Ok(ExplorationResult { plan, tally, share, unfit, grid_was_cheaper })
}

/// Runs points and returns the costs of each. `None` for a point that failed or violates a constraint.
type RunPoints<'a> = dyn FnMut(&[&PlanPoint], &mut SweepProgress) -> Result<Vec<Option<Vec<f64>>>, SweepError> + 'a;

/// Returns the numbers of the chosen points.
fn search(
    plan: &Plan,
    known: &[Option<BTreeMap<usize, f64>>],
    options: ExploreOptions,
    run: &mut RunPoints<'_>,
    tally: &mut SweepProgress,
) -> Result<BTreeSet<usize>, SweepError> {
    let began = Instant::now();
    let numbers = order(plan, known, options.seed);
    let places = numbers.iter().map(|number| plan.points[*number].places.clone()).collect();
    let mut search = ParetoSearch::new(plan.axes.iter().map(search_axis).collect(), places, exact(known, &numbers));
    let mut chosen = BTreeSet::new();
    loop {
        let left = match options.budget {
            Budget::Points(points) => points.saturating_sub(chosen.len()),
            Budget::Time(time) if began.elapsed() >= time => 0,
            Budget::Time(_) => usize::MAX,
        };
        let next = search.next(left);
        if next.is_empty() {
            return Ok(chosen);
        }
        let points: Vec<&PlanPoint> = next.iter().map(|at| &plan.points[numbers[*at]]).collect();
        let costs = run(&points, tally)?;
        chosen.extend(next.iter().map(|at| numbers[*at]));
        next.into_iter().zip(costs).for_each(|(at, costs)| search.tell(at, costs));
    }
}

/// Returns the fit points in the order of the plan, where a seed other than 0 lists about half of the axes backwards.
fn order(plan: &Plan, known: &[Option<BTreeMap<usize, f64>>], seed: u32) -> Vec<usize> {
    let mut random_numbers = SplitMix64::new(seed);
    let backwards: Vec<bool> = plan.axes.iter().map(|_| seed > 0 && random_numbers.next_u64() % 2 == 1).collect();
    let mut numbers: Vec<usize> = (0..plan.points.len()).filter(|number| known[*number].is_some()).collect();
    let place = |(axis, backwards): (&Axis, &bool), place: usize| if *backwards { axis.values.len() - 1 - place } else { place };
    numbers.sort_by_key(|number| {
        let places = &plan.points[*number].places;
        plan.axes.iter().zip(&backwards).zip(places).map(|(axis, at)| place(axis, *at)).collect::<Vec<_>>()
    });
    numbers
}

/// Words are categories; two of them, such as false and true, need no order.
fn search_axis(axis: &Axis) -> SearchAxis {
    let number = |cells: &Vec<Cell>| cells.first().is_some_and(|cell| cell.number().is_some());
    SearchAxis { values: axis.values.len(), categorical: axis.values.len() > 2 && !axis.cells.iter().all(number) }
}

/// Costs of the objectives that all of these points have without a run.
fn exact(known: &[Option<BTreeMap<usize, f64>>], numbers: &[usize]) -> BTreeMap<usize, Vec<f64>> {
    let mut exact: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (objective, cost) in numbers.iter().filter_map(|number| known[*number].as_ref()).flatten() {
        exact.entry(*objective).or_default().push(*cost);
    }
    exact.retain(|_, costs| costs.len() == numbers.len());
    exact
}

/// Returns, for each point, the costs of the objectives that are known without a run. `None` for a point whose configuration does not fit
/// together or violates a constraint.
fn known_costs(plan: &Plan) -> Vec<Option<BTreeMap<usize, f64>>> {
    let of_point = |point: &PlanPoint| {
        let config = plan.config(&point.places).ok()?;
        let (pieces, model) = (config.hardware().ok()?, config.area_model());
        let hardware: Vec<Hardware> = pieces.iter().map(|piece| Hardware::new(piece, &model)).collect();
        let figures = figures::figures(&json!({ "hardware": hardware }));
        let figure = |name: &str| figures.iter().find(|figure| figure.name == name).and_then(|figure| figure.cell.number());
        let violated = plan.constraints.iter().any(|rule| figure(&rule.column).is_some_and(|value| !rule.keeps(value)));
        let cost = |(at, objective): (usize, &crate::Objective)| Some((at, objective.goal.cost(figure(&objective.column)?)));
        (!violated).then(|| plan.objectives.iter().enumerate().filter_map(cost).collect())
    };
    let pieces = plan.points.chunks(PIECE).collect();
    threads::par_map(pieces, |piece: &[PlanPoint]| piece.iter().map(of_point).collect::<Vec<_>>()).into_iter().flatten().collect()
}

/// Returns true if all points take no more work than `budget` of them. Points that share a run within a round need one run and
/// resimulations; a later round needs another run.
fn grid_is_cheaper(plan: &Plan, budget: usize) -> bool {
    let (points, works) = (plan.points.len() as f64, plan.min_runs() as f64);
    let work = |points: f64| {
        let runs = works * (1.0 - libm::pow(1.0 - 1.0 / works, points));
        runs + RESIMULATION * (points - runs)
    };
    let (mut told, mut sum) = (2_usize.min(budget), work(2.0));
    while told < budget {
        let size = (told / 4).clamp(1, 8).min(budget - told);
        sum += work(size as f64);
        told += size;
    }
    budget >= plan.points.len() || sum >= works + RESIMULATION * (points - works)
}

/// Runs points. Returns the costs of each point that has a result and meets the constraints.
fn costs(
    plan: &Plan,
    points: &[&PlanPoint],
    work: &SweepJob<'_>,
    folder: &SweepFolder,
    host: &dyn SweepHost,
    tally: &mut SweepProgress,
) -> Result<Vec<Option<Vec<f64>>>, SweepError> {
    let ran = execute(plan, &SweepJob { points, ..*work }, folder, host)?;
    tally.add(&ran);
    let of_rows: BTreeMap<usize, Vec<f64>> = candidates(&table_of(plan, points, folder)?).into_iter().collect();
    Ok((0..points.len()).map(|row| of_rows.get(&row).cloned()).collect())
}

/// The share of the whole grid's hypervolume that the chosen points have.
fn hypervolume_share(plan: &Plan, chosen: &BTreeSet<usize>, folder: &SweepFolder) -> Result<Option<f64>, SweepError> {
    if plan.points.iter().any(|point| folder.find(&point.id).is_missing()) {
        return Ok(None);
    }
    let all: Vec<&PlanPoint> = plan.points.iter().collect();
    let costs = candidates(&table_of(plan, &all, folder)?);
    let of_all: Vec<Vec<f64>> = costs.iter().map(|(_, costs)| costs.clone()).collect();
    let of_chosen: Vec<Vec<f64>> = costs.into_iter().filter(|(row, _)| chosen.contains(row)).map(|(_, costs)| costs).collect();
    let volumes =
        ObjectiveSpace::of(&of_all).and_then(|space| Some((space.hypervolume(&of_chosen)?, space.hypervolume(&of_all)?)));
    Ok(volumes.filter(|(_, all)| *all > 0.0).map(|(chosen, all)| chosen / all))
}
