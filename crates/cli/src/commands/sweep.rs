//! `basrelief sweep`: all points of a plan, or what is missing of them.

use super::plans::{Planned, Program, bad, counts, work, written};
use crate::args::{PlanArgs, SweepArgs};
use crate::error::{Done, Failure, print};
use basrelief_dse::{Folder, Found, Plan, Point, Tally, execute, verify};
use basrelief_input::Budget;
use std::fmt::Write as _;
use std::path::Path;

/// Runs a sweep.
pub fn sweep(args: &SweepArgs, budget: &Budget, quiet: bool) -> Done {
    let Planned { host, plan, folder, threads, _held } = Planned::read(&args.plan, budget, quiet)?;
    if args.list {
        return list(&plan, &folder, args);
    }
    if args.slurm {
        return slurm(&plan, &folder, args);
    }
    let points = chosen(&plan, args)?;
    let tally = execute(&plan, &work(&args.plan, &points, threads), &folder, &host).map_err(bad)?;
    let said = results(&plan, &points, &tally, (&folder, args), &host)?;
    drop(host);
    if quiet { Ok(()) } else { print(&said) }
}

/// The points that the command line asks for.
fn chosen<'a>(plan: &'a Plan, args: &SweepArgs) -> Done<Vec<&'a Point>> {
    if let Some(id) = &args.point {
        let point = plan.points.iter().find(|point| point.id == *id);
        let none = || Failure::Usage(format!("--point: the plan has no point {id}; --list says which are missing"));
        return Ok(vec![point.ok_or_else(none)?]);
    }
    Ok(match args.shard {
        Some(shard) => plan.shard(shard.number, shard.count),
        None => plan.points.iter().collect(),
    })
}

/// Compares, writes the tables, and says what has come of it.
fn results(
    plan: &Plan,
    points: &[&Point],
    tally: &Tally,
    (folder, args): (&Folder, &SweepArgs),
    host: &Program<'_>,
) -> Done<String> {
    let failed = points.iter().filter(|point| folder.find(&point.id) == Found::Failed).count();
    let mut said = counts(tally, failed);
    if let Some(percent) = args.verify {
        let (count, others) = verify(plan, points, percent, folder, host).map_err(bad)?;
        if !others.is_empty() {
            let others = others.join(", ");
            return Err(Failure::Bad(format!(
                "run again, these points come out otherwise, please report this as a mistake: {others}"
            )));
        }
        let _ = writeln!(said, "{count} points run again: the same to the byte");
    }
    if args.point.is_some() {
        return Ok(said);
    }
    let missing = missing(plan, folder).count();
    if missing > 0 {
        let _ = writeln!(said, "{missing} points of other shards are missing: the tables are written when they are there");
        return Ok(said);
    }
    said += &written(plan, folder, &args.plan, host)?;
    Ok(said)
}

fn missing<'a>(plan: &'a Plan, folder: &Folder) -> impl Iterator<Item = &'a Point> {
    plan.points.iter().filter(|point| folder.find(&point.id) == Found::Missing)
}

/// A command for each missing point.
fn list(plan: &Plan, folder: &Folder, args: &SweepArgs) -> Done {
    let command = command(args);
    print(&missing(plan, folder).map(|point| format!("{command} --point {}\n", point.id)).collect::<String>())
}

/// Most tasks of an array: what Slurm allows where nobody has changed it.
const MOST_TASKS: usize = 1000;

/// A job script.
fn slurm(plan: &Plan, folder: &Folder, args: &SweepArgs) -> Done {
    let missing = missing(plan, folder).count();
    let tasks = plan.works().min(missing).clamp(1, MOST_TASKS);
    let command = command(args);
    print(&format!(
        "#!/bin/sh\n\
         # {missing} points are missing. Submit with sbatch; when all tasks are done, this writes the tables:\n\
         # {command}\n\
         #SBATCH --job-name=basrelief\n\
         #SBATCH --array=1-{tasks}\n\
         #SBATCH --cpus-per-task=1\n\
         exec {command} --quiet --shard \"$SLURM_ARRAY_TASK_ID/{tasks}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n"
    ))
}

/// This sweep as a command.
fn command(args: &SweepArgs) -> String {
    let PlanArgs { plan, out, no_pictures, .. } = &args.plan;
    let pictures = if *no_pictures { " --no-pictures" } else { "" };
    format!("basrelief sweep {} --out {}{pictures}", quoted(plan), quoted(out))
}

/// A path as a word of a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:=@%".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_one_word_of_a_shell() {
        assert_eq!(quoted(Path::new("studies/a-1.toml")), "studies/a-1.toml");
        assert_eq!(quoted(Path::new("it's here")), "'it'\\''s here'");
    }
}
