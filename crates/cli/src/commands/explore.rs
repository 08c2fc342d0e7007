//! `basrelief explore`: finds the Pareto front of a plan with few runs.

use super::plans::{OpenedPlan, counts, work, write_tables};
use crate::args::ExploreArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use basrelief_dse::{ExplorationResult, PlanPoint, PointStatus, explore as find};

/// Runs an exploration.
pub fn explore(args: &ExploreArgs, global: &GlobalOptions) -> CommandResult {
    let OpenedPlan { host, plan, folder, threads, _held } = OpenedPlan::read(&args.plan, global)?;
    let all = plan.points.len();
    let work = work(&args.plan, &[], threads);
    let name = args.plan.plan.display().to_string();
    let found = find(plan, args.budget.into(), &work, (&folder, &host)).map_err(CommandError::in_input(&name))?;
    let ExplorationResult { plan, tally, share } = found;
    let points: Vec<&PlanPoint> = plan.points.iter().collect();
    let failed = folder.find_all(&points).into_iter().filter(|found| *found == PointStatus::Failed).count();
    let mut said = counts(&tally, failed);
    said += &match share {
        Some(share) => {
            format!("of {all} in the grid, which all exist: {:.2} % of the hypervolume of their Pareto front\n", 100.0 * share)
        }
        None => format!("of {all} in the grid\n"),
    };
    said += &write_tables(&plan, &folder, &args.plan, &host)?;
    drop(host);
    if global.quiet { Ok(()) } else { print(&said) }
}
