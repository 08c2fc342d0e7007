//! Explorations against the work of their grid.

use crate::support::{Program, plan};
use basrelief_dse::{Budget, ExplorationResult, ExploreOptions, SweepFolder, SweepJob, explore};
use tempfile::tempdir;

/// Two works, each under six times.
const PLAN: &str = "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"cycles min\", \"bytes.moved min\"]\n\
                    [axes]\nshade.mode = [\"normal\", \"brightness\"]\nfifo.interpolated.depth = [1, 2, 64]\n\
                    memory.frame.part = [\"fpm-80\", \"sram\"]\n";
/// Time of a resimulation, as a share of the time of a run.
const RESIMULATION: f64 = 0.35;

/// Two works, each under 25 depths without effect, so that points tie.
const TIES: &str = "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"cycles min\", \"bytes.moved min\"]\n\
                    [axes]\nshade.mode = [\"normal\", \"brightness\"]\nfifo.interpolated.depth = [8, 9, 10, 11, 12]\n\
                    fifo.draws.depth = [16, 17, 18, 19, 20]\n";

fn explored(text: &str, budget: usize, seed: u32) -> ExplorationResult {
    let (folder, host) = (tempdir().unwrap(), Program::new());
    let work = SweepJob { points: &[], retry_failed: false, pictures: false, threads: 2 };
    let options = ExploreOptions { budget: Budget::Points(budget), seed };
    explore(plan(text, &host), options, &work, &SweepFolder::new(folder.path()), &host).unwrap()
}

// Claim: analysis: `explore` runs the whole grid if that is no more work than the exploration, and never does more work than the grid.
#[test]
fn explore_takes_no_more_work_than_the_grid() {
    let work = |found: &ExplorationResult| found.tally.run as f64 + RESIMULATION * found.tally.resimulated as f64;
    let whole = explored(PLAN, 12, 0);
    assert_eq!((whole.grid_was_cheaper, whole.tally.points, whole.tally.run, whole.tally.resimulated), (true, 12, 2, 10));
    let mut cheaper = vec![];
    for budget in [3, 5, 7, 9] {
        let found = explored(PLAN, budget, 0);
        assert!(work(&found) <= work(&whole), "{budget} points: {:?}", found.tally);
        assert_eq!(found.tally.points, if found.grid_was_cheaper { 12 } else { budget }, "{budget} points");
        assert_eq!(found.plan.points.len(), found.tally.points);
        cheaper.push(found.grid_was_cheaper);
    }
    assert_eq!(cheaper, [false, false, true, true]);
}

#[test]
fn seed_decides_between_points_that_tie() {
    let chosen = |seed: u32| explored(TIES, 4, seed).plan.points.into_iter().map(|point| point.id).collect::<Vec<_>>();
    assert_eq!(chosen(1), chosen(1), "the same seed chooses the same points");
    assert_ne!(chosen(0), chosen(1));
}
