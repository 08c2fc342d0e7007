//! `basrelief sweep`: runs the missing points of a plan.

use super::cluster::{commands, job_script, missing_points};
use super::plans::{OpenedPlan, SweepProgram, counts, failed_points, finish, sweep_error, work, write_tables};
use crate::args::SweepArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use basrelief_dse::{Plan, PlanPoint, SweepFolder, execute, verify};
use std::fmt::Write as _;

/// Runs a sweep.
pub fn sweep(args: &SweepArgs, global: &GlobalOptions) -> CommandResult {
    let OpenedPlan { host, plan, folder, threads, _held } = OpenedPlan::read(&args.plan, global)?;
    if args.list {
        return print(&commands(&plan, &folder, args, global)?);
    }
    if args.slurm {
        return print(&job_script(&plan, &folder, args, global)?);
    }
    let points = selected_points(&plan, args)?;
    let tally = execute(&plan, &work(&args.plan, &points, threads), &folder, &host).map_err(sweep_error)?;
    let failed = failed_points(&folder, &points);
    let said = counts(&tally, failed) + &finish_sweep(&plan, &points, &folder, args, &host)?;
    drop(host);
    // A shard alone may consist of points that fail.
    let judged = if args.point.is_empty() { plan.points.len() } else { points.len() };
    finish(&said, (failed, judged), &plan, &args.plan, global)
}

/// Returns the points that the command line selects.
fn selected_points<'a>(plan: &'a Plan, args: &SweepArgs) -> CommandResult<Vec<&'a PlanPoint>> {
    let point = |id: &String| {
        let none = || CommandError::Usage(format!("--point: the plan has no point {id}; --list prints the missing points"));
        plan.points.iter().find(|point| point.id == *id).ok_or_else(none)
    };
    if !args.point.is_empty() {
        return args.point.iter().map(point).collect();
    }
    Ok(match args.shard {
        Some(shard) => plan.shard(shard.number, shard.count),
        None => plan.points.iter().collect(),
    })
}

/// Verifies points, writes the tables, and returns a message.
fn finish_sweep(
    plan: &Plan,
    points: &[&PlanPoint],
    folder: &SweepFolder,
    args: &SweepArgs,
    host: &SweepProgram<'_>,
) -> CommandResult<String> {
    let mut said = String::new();
    if let Some(percent) = args.verify {
        let (count, others) = verify(plan, points, percent, folder, host).map_err(sweep_error)?;
        if !others.is_empty() {
            let others = others.join(", ");
            return Err(CommandError::BadInput(format!(
                "the reports of these points differ when the points run again: {others}; if the reports were edited, delete their folders \
                 and sweep again, else please report this as a bug"
            )));
        }
        let points = if count == 1 { "point" } else { "points" };
        let _ = writeln!(said, "{count} {points} repeated: reports are identical");
    }
    if !args.point.is_empty() {
        return Ok(said);
    }
    let missing = missing_points(plan, folder).len();
    if missing > 0 {
        let _ = writeln!(said, "{missing} points of other shards are missing; the tables are written once they exist");
        return Ok(said);
    }
    said += &write_tables(plan, folder, &args.plan, host)?;
    Ok(said)
}
