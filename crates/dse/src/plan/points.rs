//! The points of a plan.

use super::axes::Axis;
use super::definition::{Plan, PlanPoint};
use super::exclusion::Exclusion;
use super::identity::PlanIdentity;
use super::written::{SampleMethod, SampleOptions};
use crate::sample::{full_grid, latin_hypercube, sobol};
use basrelief_parameters::TomlFault;
use basrelief_threads as threads;
use std::collections::BTreeSet;

/// Maximum number of points of a plan, over all inputs.
pub(super) const MOST_POINTS: usize = 1 << 15;

/// Places on all axes: the grid or a sample of it, without excluded points.
pub(super) fn axis_values(
    axes: &[Axis],
    exclusions: &[Exclusion],
    samples: Option<&SampleOptions>,
    inputs: usize,
) -> Result<Vec<Vec<usize>>, TomlFault> {
    let lengths: Vec<usize> = axes.iter().map(|axis| axis.values.len()).collect();
    let of_axes = |message| TomlFault::new(&["axes"], message);
    let places = match samples {
        Some(SampleOptions { method: method @ (SampleMethod::LatinHypercube | SampleMethod::Sobol), points, seed }) => {
            let fault = |message| TomlFault::new(&["samples", "points"], message);
            let missing = "samples: `points` says how many; expected a number such as points = 64";
            let points = points.ok_or_else(|| TomlFault::new(&["samples"], missing))?;
            bounded(Some(points), inputs).map_err(fault)?;
            let sample = if *method == SampleMethod::Sobol { sobol } else { latin_hypercube };
            sample(points, &lengths, *seed).map_err(|error| fault(format!("samples: {error}")))?
        }
        Some(SampleOptions { points: Some(_), .. }) => {
            let message = "samples: a grid, or one value at a time, has all its points; leave `points` out";
            return Err(TomlFault::new(&["samples", "points"], message));
        }
        Some(SampleOptions { method: SampleMethod::OneAtATime, .. }) => {
            bounded(Some(lengths.iter().map(|length| length - 1).sum::<usize>() + 1), inputs).map_err(of_axes)?;
            one_at_a_time(&lengths)
        }
        _ => {
            let product = lengths.iter().try_fold(1_usize, |product, length| product.checked_mul(*length));
            bounded(product, inputs).map_err(of_axes)?;
            full_grid(&lengths)
        }
    };
    let left: Vec<Vec<usize>> =
        places.into_iter().filter(|places| !exclusions.iter().any(|exclusion| exclusion.leaves_out(places, axes))).collect();
    if left.is_empty() {
        Err(TomlFault::new(&["exclude"], "exclude: leaves no point; expected one at least: leave out fewer"))
    } else {
        Ok(left)
    }
}

fn bounded(points: Option<usize>, inputs: usize) -> Result<(), String> {
    let all = points.and_then(|points| points.checked_mul(inputs));
    match all {
        Some(0) => Err("samples: no points; expected one at least".into()),
        Some(all) if all <= MOST_POINTS => Ok(()),
        all => {
            let all = all.map_or("far more".to_owned(), |all| all.to_string());
            Err(format!(
                "{all} points; expected at most {MOST_POINTS}: shorten axes, take samples, or write several plans for one folder"
            ))
        }
    }
}

/// Returns the base, which is the first place of each axis, then each other place of each axis alone.
fn one_at_a_time(lengths: &[usize]) -> Vec<Vec<usize>> {
    let base = vec![0; lengths.len()];
    let alone = |(axis, &length): (usize, &usize)| {
        let base = base.clone();
        (1..length).map(move |place| {
            let mut places = base.clone();
            places[axis] = place;
            places
        })
    };
    let others = lengths.iter().enumerate().flat_map(alone);
    std::iter::once(vec![0; lengths.len()]).chain(others).collect()
}

/// Returns the points of a plan, input by input, without repetitions.
pub(super) fn points(plan: &Plan, places: &[Vec<usize>]) -> Vec<PlanPoint> {
    let identity = PlanIdentity::of(plan);
    let all: Vec<(usize, &Vec<usize>)> =
        (0..plan.inputs.len()).flat_map(|input| places.iter().map(move |p| (input, p))).collect();
    let pieces = all.chunks(64).collect();
    let point = |&(input, places): &(usize, &Vec<usize>)| {
        let (id, work) = identity.hashes(plan, input, places);
        PlanPoint { id, work, input, places: places.clone() }
    };
    let points = threads::par_map(pieces, |piece: &[(usize, &Vec<usize>)]| piece.iter().map(point).collect::<Vec<_>>());
    let mut seen = BTreeSet::new();
    points.into_iter().flatten().filter(|point| seen.insert(point.id.clone())).collect()
}
