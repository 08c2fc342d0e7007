//! Finds the Pareto front of a plan with few of its points.
//!
//! [`Explorer`] chooses the next points from the figures of the known points. They are run like the points of a sweep, and stored in the
//! same folder. The measured bottleneck of a Pareto-optimal point selects the axis to raise; the extra run that measures it does not
//! count as a point. A killed exploration resumes, and reuses the points of a sweep.

use crate::explorer::{Explorer, KnownCosts};
use crate::one::limits;
use crate::plan::{Plan, PlanPoint};
use crate::tables::table_of;
use crate::{SweepError, SweepFolder, SweepHost, SweepJob, SweepProgress, execute};
use crate::{candidates, hypervolume::ObjectiveSpace};
use basrelief_parameters::Effect;
use basrelief_report::model::RelaxedCycles;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Points per round. Independent of the number of threads, so that the points are the same.
const ROUND: usize = 8;
/// Numbers that begin the coarse sample.
const SEED: u32 = 1;

/// Result of an exploration.
#[derive(Debug)]
pub struct ExplorationResult {
    /// The plan with the points alone that were chosen.
    pub plan: Plan,
    /// Numbers of points by the way in which their results were obtained.
    pub tally: SweepProgress,
    /// Share of the hypervolume of the whole grid. `None` unless all points of the grid have results and the volume is positive.
    pub share: Option<f64>,
}

/// Chooses at most `budget` points of a plan, a few at a time, and runs them: the front of these is close to that of all.
///
/// # Errors
/// A plan of several inputs, or with samples of its own; and those of [`execute()`].
pub fn explore(
    plan: Plan,
    budget: usize,
    work: &SweepJob<'_>,
    (folder, host): (&SweepFolder, &dyn SweepHost),
) -> Result<ExplorationResult, SweepError> {
    if plan.inputs.len() != 1 {
        let count = plan.inputs.len();
        return Err(SweepError(format!(
            "input: {count} inputs; expected one: a front is of one input, so write a plan for each"
        )));
    }
    let lengths: Vec<usize> = plan.axes.iter().map(|axis| axis.values.len()).collect();
    let explorer = Explorer::new(&lengths, budget, SEED).map_err(|error| SweepError(error.to_string()))?;
    let places: BTreeMap<&[usize], usize> =
        plan.points.iter().enumerate().map(|(number, point)| (point.places.as_slice(), number)).collect();
    let timing = timing_axes(&plan);
    let hints = RefCell::new(BTreeMap::new());
    let hint = |place: &[usize]| {
        let Some(&number) = places.get(place).filter(|_| !timing.is_empty()) else { return vec![] };
        let found = || limiting_axes(&timing, &limits(&plan, &plan.points[number], host));
        hints.borrow_mut().entry(number).or_insert_with(found).clone()
    };
    let mut known = KnownCosts::new();
    let (mut chosen, mut tally) = (BTreeSet::new(), SweepProgress::default());
    loop {
        let next = explorer.next(&known, ROUND, &hint);
        if next.is_empty() {
            break;
        }
        let numbers: Vec<usize> = next.iter().filter_map(|place| places.get(place.as_slice()).copied()).collect();
        let points: Vec<&PlanPoint> = numbers.iter().map(|&number| &plan.points[number]).collect();
        let costs = costs(&plan, &points, work, (folder, host), &mut tally)?;
        // An excluded point is chosen once, and never again.
        known.extend(next.iter().map(|place| (place.clone(), None)));
        known.extend(points.iter().zip(costs).map(|(point, costs)| (point.places.clone(), costs)));
        chosen.extend(numbers);
    }
    let share = hypervolume_share(&plan, &chosen, folder)?;
    let mut number = 0..;
    let mut plan = plan;
    plan.points.retain(|_| number.next().is_some_and(|number| chosen.contains(&number)));
    Ok(ExplorationResult { plan, tally, share })
}

/// Axes of timing parameters, which relaxations set: their numbers, and the groups of their parameters.
fn timing_axes(plan: &Plan) -> Vec<(usize, Vec<String>)> {
    let timing: BTreeSet<String> =
        plan.machine.parameters().into_iter().filter(|p| p.effect == Effect::Timing).map(|p| p.key).collect();
    let all = plan.axes.iter().enumerate().filter(|(_, axis)| axis.keys.iter().all(|key| timing.contains(key)));
    all.map(|(number, axis)| (number, axis.keys.iter().map(|key| group(key).to_owned()).collect())).collect()
}

/// The group of a parameter: all of its name but the last part.
fn group(key: &str) -> &str {
    key.rsplit_once('.').map_or("", |(group, _)| group)
}

/// Numbers of the axes with a parameter of a bottleneck, largest saving first. For a pair, the single savings give the order.
fn limiting_axes(axes: &[(usize, Vec<String>)], limits: &[RelaxedCycles]) -> Vec<usize> {
    let mut found = Vec::new();
    for RelaxedCycles { set, .. } in limits.iter().filter(|limit| !limit.resource.contains(" and ")) {
        let is_of = |of: &String| set.iter().filter_map(|set| set.split_once('=')).any(|(key, _)| group(key) == of);
        let all = axes.iter().filter(|(_, groups)| groups.iter().any(is_of)).map(|(number, _)| *number);
        let new: Vec<usize> = all.filter(|number| !found.contains(number)).collect();
        found.extend(new);
    }
    found
}

/// Runs points. Returns the costs of each point that has a result and meets the constraints.
fn costs(
    plan: &Plan,
    points: &[&PlanPoint],
    work: &SweepJob<'_>,
    (folder, host): (&SweepFolder, &dyn SweepHost),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(resource: &str, set: &str) -> RelaxedCycles {
        RelaxedCycles { resource: resource.into(), what: "ideal".into(), set: vec![set.into()], cycles: 1, saved: 1 }
    }

    #[test]
    fn bottlenecks_map_to_axes_by_parameters() {
        let axes = [(0, "fifo.a"), (2, "fifo.b"), (3, "memory.m")].map(|(number, group)| (number, vec![group.to_owned()]));
        let limits = [
            limit("a and m", "fifo.a.depth=65536"),
            limit("m", "memory.m.cl=0"),
            limit("search", "ideal.units=search"),
            limit("b", "fifo.b.depth=65536"),
            limit("m", "memory.m.part=ideal"),
        ];
        assert_eq!(limiting_axes(&axes, &limits), [3, 2]);
        assert_eq!(limiting_axes(&axes, &[]), [0; 0]);
    }
}
