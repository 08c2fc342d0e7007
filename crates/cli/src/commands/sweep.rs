//! `basrelief sweep`: runs the missing points of a plan.

use super::plans::{OpenedPlan, SweepProgram, counts, sweep_error, work, write_tables};
use crate::args::{PlanArgs, SweepArgs};
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use basrelief_dse::{Plan, PlanPoint, PointStatus, SweepFolder, SweepProgress, execute, verify};
use std::fmt::Write as _;
use std::path::Path;

/// Runs a sweep.
pub fn sweep(args: &SweepArgs, global: &GlobalOptions) -> CommandResult {
    let OpenedPlan { host, plan, folder, threads, _held } = OpenedPlan::read(&args.plan, global)?;
    if args.list {
        return print_commands(&plan, &folder, args);
    }
    if args.slurm {
        return print_job_script(&plan, &folder, args);
    }
    let points = selected_points(&plan, args)?;
    let tally = execute(&plan, &work(&args.plan, &points, threads), &folder, &host).map_err(sweep_error)?;
    let said = finish_sweep(&plan, &points, &tally, (&folder, args), &host)?;
    drop(host);
    if global.quiet { Ok(()) } else { print(&said) }
}

/// Returns the points that the command line selects.
fn selected_points<'a>(plan: &'a Plan, args: &SweepArgs) -> CommandResult<Vec<&'a PlanPoint>> {
    if let Some(id) = &args.point {
        let point = plan.points.iter().find(|point| point.id == *id);
        let none = || CommandError::Usage(format!("--point: the plan has no point {id}; --list prints the missing points"));
        return Ok(vec![point.ok_or_else(none)?]);
    }
    Ok(match args.shard {
        Some(shard) => plan.shard(shard.number, shard.count),
        None => plan.points.iter().collect(),
    })
}

/// Verifies points, writes the tables, and returns a summary.
fn finish_sweep(
    plan: &Plan,
    points: &[&PlanPoint],
    tally: &SweepProgress,
    (folder, args): (&SweepFolder, &SweepArgs),
    host: &SweepProgram<'_>,
) -> CommandResult<String> {
    let failed = folder.find_all(points).into_iter().filter(|found| *found == PointStatus::Failed).count();
    let mut said = counts(tally, failed);
    if let Some(percent) = args.verify {
        let (count, others) = verify(plan, points, percent, folder, host).map_err(sweep_error)?;
        if !others.is_empty() {
            let others = others.join(", ");
            return Err(CommandError::BadInput(format!(
                "these points differ when run again; please report this as a bug: {others}"
            )));
        }
        let _ = writeln!(said, "{count} points repeated: reports are identical");
    }
    if args.point.is_some() {
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

fn missing_points<'a>(plan: &'a Plan, folder: &SweepFolder) -> Vec<&'a PlanPoint> {
    let points: Vec<&PlanPoint> = plan.points.iter().collect();
    let found = folder.find_all(&points);
    points.into_iter().zip(found).filter(|(_, found)| found.is_missing()).map(|(point, _)| point).collect()
}

/// Prints a command for each missing point.
fn print_commands(plan: &Plan, folder: &SweepFolder, args: &SweepArgs) -> CommandResult {
    let command = command(args)?;
    print(&missing_points(plan, folder).iter().map(|point| format!("{command} --point {}\n", point.id)).collect::<String>())
}

/// Maximum array size in the default configuration of Slurm.
const MOST_TASKS: usize = 1000;

/// Prints a job script.
fn print_job_script(plan: &Plan, folder: &SweepFolder, args: &SweepArgs) -> CommandResult {
    let missing = missing_points(plan, folder).len();
    let tasks = plan.min_runs().min(missing).clamp(1, MOST_TASKS);
    let command = command(args)?;
    print(&format!(
        "#!/bin/sh\n\
         # {missing} points are missing. Submit with sbatch. When all tasks are done, this command writes the tables:\n\
         # {command}\n\
         #SBATCH --job-name=basrelief\n\
         #SBATCH --array=1-{tasks}\n\
         #SBATCH --cpus-per-task=1\n\
         exec {command} --quiet --shard \"$SLURM_ARRAY_TASK_ID/{tasks}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n"
    ))
}

/// Returns this sweep as a shell command.
fn command(args: &SweepArgs) -> CommandResult<String> {
    let PlanArgs { plan, out, no_pictures, .. } = &args.plan;
    let pictures = if *no_pictures { " --no-pictures" } else { "" };
    Ok(format!("basrelief sweep {} --out {}{pictures}", quoted(plan)?, quoted(out)?))
}

/// Quotes a path as one word of a shell. A line end would end the comment of a job script, so control characters are refused.
fn quoted(path: &Path) -> CommandResult<String> {
    let text = path.to_str().filter(|text| !text.is_empty() && !text.contains(char::is_control));
    let wrong =
        || CommandError::Usage(format!("{}: a shell command needs a name in UTF-8 without control characters", path.display()));
    let text = text.ok_or_else(wrong)?;
    // A word that begins with a hyphen would be an option.
    let text = if text.starts_with('-') { format!("./{text}") } else { text.to_owned() };
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:=@%".contains(c);
    Ok(if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_is_one_word_of_a_shell() {
        let quoted = |path: &str| quoted(Path::new(path));
        assert_eq!(quoted("studies/a-1.toml").unwrap(), "studies/a-1.toml");
        assert_eq!(quoted("it's here; $(rm x) `y`").unwrap(), "'it'\\''s here; $(rm x) `y`'");
        assert_eq!(quoted("-rf").unwrap(), "./-rf");
        for refused in ["a\nrm x", "a\rb", "a\x1b]0;b", ""] {
            assert!(matches!(quoted(refused), Err(CommandError::Usage(_))), "{refused:?}");
        }
    }
}
