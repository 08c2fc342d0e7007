//! `basrelief explore`: finds the Pareto front of a plan with few runs.

use super::plans::{OpenedPlan, counts, failed_points, finish, work, write_tables};
use crate::args::ExploreArgs;
use crate::error::{CommandError, CommandResult};
use crate::global::GlobalOptions;
use basrelief_dse::{ExplorationResult, ExploreOptions, PlanPoint, explore as find};

/// Runs an exploration.
pub fn explore(args: &ExploreArgs, global: &GlobalOptions) -> CommandResult {
    let OpenedPlan { host, plan, folder, threads, _held } = OpenedPlan::read(&args.plan, global)?;
    let all = plan.points.len();
    let work = work(&args.plan, &[], threads);
    let name = args.plan.plan.display().to_string();
    let options = ExploreOptions { budget: args.budget, seed: args.seed };
    let found = find(plan, options, &work, &folder, &host).map_err(CommandError::in_input(&name))?;
    let ExplorationResult { plan, tally, share, unfit, grid_was_cheaper } = found;
    let points: Vec<&PlanPoint> = plan.points.iter().collect();
    let failed = failed_points(&folder, &points);
    let mut said = counts(&tally, failed);
    if grid_was_cheaper {
        said += "the grid is cheaper than this exploration, so all of its points were run\n";
    } else if unfit > 0 {
        said += &format!("{unfit} points are unfit by their configuration alone, and were not run\n");
    }
    said += &match share {
        Some(share) => {
            format!(
                "the grid has {all} points, which all exist; these reach {:.2} % of the hypervolume of its Pareto front\n",
                100.0 * share
            )
        }
        None => format!("the grid has {all} points\n"),
    };
    said += &write_tables(&plan, &folder, &args.plan, &host)?;
    drop(host);
    finish(&said, (failed, plan.points.len()), &plan, &args.plan, global)
}
