//! The front of a plan with few of its points.
//!
//! Which points come next follows from the figures of those that are known, by [`Explorer`]; they are run as those of a sweep are, and
//! lie in the same folder. So an exploration that was killed goes on, and what a sweep has run is not run again.

use crate::plan::{Plan, Point};
use crate::tables::table_of;
use crate::{Folder, Found, Host, SweepError, Tally, Work, execute};
use basrelief_charts::explore::{Explorer, Known};
use basrelief_charts::{candidates, hypervolume::Space};
use std::collections::{BTreeMap, BTreeSet};

/// Points that are chosen at a time: as many whatever the number of threads, so that the points are the same.
const ROUND: usize = 8;
/// Numbers that begin the coarse sample.
const SEED: u32 = 1;

/// What an exploration came to.
#[derive(Debug)]
pub struct Explored {
    /// The plan with the points alone that were chosen.
    pub plan: Plan,
    /// How they came to be there.
    pub tally: Tally,
    /// The share of the hypervolume of the whole grid that they have; where all points of the grid are there, and there is any.
    pub share: Option<f64>,
}

/// Chooses at most `budget` points of a plan, a few at a time, and runs them: the front of these is close to that of all.
///
/// # Errors
/// A plan of several inputs, or with samples of its own; and those of [`execute()`].
pub fn explore(plan: Plan, budget: usize, work: &Work<'_>, (folder, host): (&Folder, &dyn Host)) -> Result<Explored, SweepError> {
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
    let mut known = Known::new();
    let (mut chosen, mut tally) = (BTreeSet::new(), Tally::default());
    loop {
        let next = explorer.next(&known, ROUND, &|_| vec![]);
        if next.is_empty() {
            break;
        }
        let numbers: Vec<usize> = next.iter().filter_map(|place| places.get(place.as_slice()).copied()).collect();
        let points: Vec<&Point> = numbers.iter().map(|&number| &plan.points[number]).collect();
        let costs = costs(&plan, &points, work, (folder, host), &mut tally)?;
        // What the plan leaves out is chosen once, and never again.
        known.extend(next.iter().map(|place| (place.clone(), None)));
        known.extend(points.iter().zip(costs).map(|(point, costs)| (point.places.clone(), costs)));
        chosen.extend(numbers);
    }
    let share = share(&plan, &chosen, folder)?;
    let mut number = 0..;
    let mut plan = plan;
    plan.points.retain(|_| number.next().is_some_and(|number| chosen.contains(&number)));
    Ok(Explored { plan, tally, share })
}

/// Runs points; the costs of each that is there and keeps the constraints.
fn costs(
    plan: &Plan,
    points: &[&Point],
    work: &Work<'_>,
    (folder, host): (&Folder, &dyn Host),
    tally: &mut Tally,
) -> Result<Vec<Option<Vec<f64>>>, SweepError> {
    let ran = execute(plan, &Work { points, ..*work }, folder, host)?;
    tally.add(&ran);
    let of_rows: BTreeMap<usize, Vec<f64>> = candidates(&table_of(plan, points, folder)?).into_iter().collect();
    Ok((0..points.len()).map(|row| of_rows.get(&row).cloned()).collect())
}

/// The share of the whole grid's hypervolume that the chosen points have.
fn share(plan: &Plan, chosen: &BTreeSet<usize>, folder: &Folder) -> Result<Option<f64>, SweepError> {
    if plan.points.iter().any(|point| folder.find(&point.id) == Found::Missing) {
        return Ok(None);
    }
    let all: Vec<&Point> = plan.points.iter().collect();
    let costs = candidates(&table_of(plan, &all, folder)?);
    let of_all: Vec<Vec<f64>> = costs.iter().map(|(_, costs)| costs.clone()).collect();
    let of_chosen: Vec<Vec<f64>> = costs.into_iter().filter(|(row, _)| chosen.contains(row)).map(|(_, costs)| costs).collect();
    let volumes = Space::of(&of_all).and_then(|space| Some((space.hypervolume(&of_chosen)?, space.hypervolume(&of_all)?)));
    Ok(volumes.filter(|(_, all)| *all > 0.0).map(|(chosen, all)| chosen / all))
}
