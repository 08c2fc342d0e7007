//! Commands and job scripts that spread a sweep over processes and computers.

use crate::args::{PlanArgs, SweepArgs};
use crate::error::{CommandError, CommandResult};
use crate::global::GlobalOptions;
use basrelief_dse::{Plan, PlanPoint, SweepFolder};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Maximum array size in the default configuration of Slurm.
const MOST_TASKS: usize = 1000;

/// Maximum number of points in a command: 64 digits each, below the 128 KiB that Linux allows a word.
const MOST_POINTS: usize = 1000;

/// Memory of a task beside the limit of its inputs \[MiB\].
const OWN_MEMORY: u64 = 512;

/// Returns the points without a result.
pub fn missing_points<'a>(plan: &'a Plan, folder: &SweepFolder) -> Vec<&'a PlanPoint> {
    let points: Vec<&PlanPoint> = plan.points.iter().collect();
    let found = folder.find_all(&points);
    points.into_iter().zip(found).filter(|(_, found)| found.is_missing()).map(|(point, _)| point).collect()
}

/// Returns one command per line. Missing points that share their work are in one command, because one recording serves all of them.
pub fn commands(plan: &Plan, folder: &SweepFolder, args: &SweepArgs, global: &GlobalOptions) -> CommandResult<String> {
    let command = command(args, global)?;
    let mut groups: Vec<Vec<&PlanPoint>> = Vec::new();
    // The last group of each work, because a plan may have thousands of works.
    let mut last: BTreeMap<&str, usize> = BTreeMap::new();
    for point in missing_points(plan, folder) {
        match last.get(point.work.as_str()) {
            Some(&group) if groups[group].len() < MOST_POINTS => groups[group].push(point),
            _ => {
                last.insert(&point.work, groups.len());
                groups.push(vec![point]);
            }
        }
    }
    let line = |group: Vec<&PlanPoint>| {
        let points: String = group.iter().map(|point| format!(" --point {}", point.id)).collect();
        format!("{command}{points}\n")
    };
    Ok(groups.into_iter().map(line).collect())
}

/// Returns a job script for Slurm. Run by a shell, it submits an array of shards, and a second job that writes the tables.
pub fn job_script(plan: &Plan, folder: &SweepFolder, args: &SweepArgs, global: &GlobalOptions) -> CommandResult<String> {
    let missing = missing_points(plan, folder).len();
    let tasks = plan.min_runs().min(missing).min(MOST_TASKS);
    let command = command(args, global)?;
    let log = quoted(&absolute(&args.plan.out)?.join("slurm-%A_%a.log"))?;
    let memory = (global.memory_limit >> 20) + OWN_MEMORY;
    let points = if missing == 1 { "point is" } else { "points are" };
    let (purpose, submit) = submission(tasks);
    let last = tasks.max(1);
    Ok(format!(
        "#!/bin/sh\n\
         # {missing} {points} missing. Run this with sh: it submits {purpose}.\n\
         # Options of sbatch, such as --time, may be given, too: sh JOB --time=10:00\n\
         #SBATCH --job-name=basrelief\n\
         #SBATCH --array=1-{last}\n\
         #SBATCH --cpus-per-task=1\n\
         #SBATCH --mem={memory}M\n\
         #SBATCH --time=01:00:00\n\
         #SBATCH --requeue\n\
         #SBATCH --open-mode=append\n\
         #SBATCH --output={log}\n\
         if [ -z \"$SLURM_ARRAY_TASK_ID\" ]; then\n    \
             {submit}\n\
         fi\n\
         if [ \"$1\" = tables ]; then\n    \
             exec {command} --quiet\n\
         fi\n\
         exec {command} --quiet --shard \"$SLURM_ARRAY_TASK_ID/{tasks}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n"
    ))
}

/// Returns what a job script submits, and the shell commands that submit it.
fn submission(tasks: usize) -> (String, String) {
    let tables = |after: &str| format!("exec sbatch {after}--array=1 --job-name=basrelief-tables \"$@\" \"$0\" tables");
    if tasks == 0 {
        return ("a job that writes the tables".into(), tables(""));
    }
    let noun = if tasks == 1 { "task" } else { "tasks" };
    let array = "array=$(sbatch --parsable \"$@\" \"$0\") || exit 1";
    let submit = format!("{array}\n    {}", tables("--dependency=\"afterok:$array\" "));
    (format!("an array of {tasks} {noun}, and a job that then writes the tables"), submit)
}

/// Returns this sweep as a shell command that every folder and computer understands, with all options that change its results.
fn command(args: &SweepArgs, global: &GlobalOptions) -> CommandResult<String> {
    let PlanArgs { plan, out, no_pictures, retry_failed, .. } = &args.plan;
    let program = std::env::current_exe().map_err(|error| CommandError::BadInput(format!("the program's own path: {error}")))?;
    let mut command = format!("{} sweep {} --out {}", quoted(&program)?, quoted(&absolute(plan)?)?, quoted(&absolute(out)?)?);
    for (is_set, option) in
        [(*no_pictures, " --no-pictures"), (*retry_failed, " --retry-failed"), (global.allow_outside, " --allow-outside")]
    {
        command.push_str(if is_set { option } else { "" });
    }
    command.push_str(&format!(" --memory-limit {}", global.memory_limit));
    Ok(command)
}

fn absolute(path: &Path) -> CommandResult<PathBuf> {
    std::path::absolute(path).map_err(CommandError::at_file(path, "be resolved"))
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
