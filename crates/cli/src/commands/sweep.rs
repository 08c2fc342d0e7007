//! `basrelief sweep`: all points of a plan, or what is missing of them.

use crate::args::{SweepArgs, ViewArgs};
use crate::error::{Done, Failure, print};
use crate::input::{self, Input, TraceFile, demo_of, read_text};
use crate::interrupt;
use crate::outputs::PartialFile;
use crate::progress::PointProgress;
use basrelief_input::Budget;
use basrelief_parameters::nearest;
use basrelief_reference::Picture;
use basrelief_session::{RunInput, TOML_GROWTH};
use basrelief_sweep::{Folder, Found, Host, Opened, Plan, Point, SweepError, Tally, Work, execute, tables, verify};
use basrelief_threads as threads;
use clap::{CommandFactory, Parser};
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

/// Runs a sweep.
pub fn sweep(args: &SweepArgs, budget: &Budget, quiet: bool) -> Done {
    interrupt::say("interrupted; points that are finished stay: run it again to go on");
    if args.threads == Some(1) {
        threads::work_alone();
    }
    let host = Program { plan: args.plan.clone(), budget, progress: PointProgress::new(quiet) };
    let name = args.plan.display().to_string();
    let (text, _held) = read_text(&args.plan, budget)?;
    let _growth = budget.take(TOML_GROWTH * text.len() as u64, "what a plan says").map_err(Failure::within(&name))?;
    let plan = Plan::read(&text, &host).map_err(Failure::within(&name))?;
    let folder = Folder::new(&args.out);
    if args.list {
        return list(&plan, &folder, args);
    }
    if args.slurm {
        return slurm(&plan, &folder, args);
    }
    let points = chosen(&plan, args)?;
    let threads = args.threads.map_or_else(threads::workers, usize::from);
    let work = Work { points: &points, retry_failed: args.retry_failed, pictures: !args.no_pictures, threads };
    let tally = execute(&plan, &work, &folder, &host).map_err(bad)?;
    let said = results(&plan, &points, &tally, (&folder, args), &host)?;
    drop(host.progress);
    if quiet { Ok(()) } else { print(&said) }
}

fn bad(error: SweepError) -> Failure {
    Failure::Bad(error.to_string())
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
    let Tally { points: all, there, run, retimed, .. } = tally;
    let mut said = format!("{all} points: {there} there before, {run} run, {retimed} timed again; {failed} failed\n");
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
    let front = tables(plan, folder, host).map_err(bad)?;
    let files: Vec<&str> = basrelief_sweep::tables::FILES.iter().map(|(file, _)| *file).collect();
    let _ = write!(said, "\n{front}\nWritten to {}/: {}\n", args.out.display(), files.join(", "));
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
    let pictures = if args.no_pictures { " --no-pictures" } else { "" };
    format!("basrelief sweep {} --out {}{pictures}", quoted(&args.plan), quoted(&args.out))
}

/// A path as a word of a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:=@%".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// What a sweep asks of this program.
struct Program<'a> {
    plan: PathBuf,
    budget: &'a Budget,
    progress: PointProgress,
}

/// Options of a view by themselves.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct View {
    #[command(flatten)]
    view: ViewArgs,
}

impl Program<'_> {
    /// A file that the plan names.
    fn place(&self, name: &str) -> PathBuf {
        self.plan.parent().map_or_else(|| name.into(), |folder| folder.join(name))
    }

    /// What the plan says of the view, as on the command line.
    fn view(&self, view: &[(String, String)]) -> Result<ViewArgs, String> {
        let command = View::command();
        let known: Vec<&str> = command.get_arguments().map(|argument| argument.get_id().as_str()).collect();
        if let Some((name, _)) = view.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            let hint = nearest(name, known.iter().copied()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            return Err(format!("view: no option is called `{name}`{hint} (`basrelief run --help` lists all under View)"));
        }
        let option = |(name, value): &(String, String)| {
            let value = if name == "camera" { self.place(value).display().to_string() } else { value.clone() };
            format!("--{}={value}", name.replace('_', "-"))
        };
        let parsed = View::try_parse_from(view.iter().map(option)).map_err(|error| {
            let text = error.to_string();
            format!("view: {}", text.lines().next().unwrap_or_default().trim_start_matches("error: "))
        });
        parsed.map(|View { view }| view)
    }
}

/// The sentence of a failure, without what is said of usage.
fn sentence(failure: Failure) -> String {
    match failure {
        Failure::Usage(text) | Failure::Bad(text) => text,
    }
}

impl Host for Program<'_> {
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<Opened, String> {
        let view = self.view(view)?;
        let path = if demo_of(Path::new(name)).is_some() { name.into() } else { self.place(name) };
        let once = || format!("input: {name}: can be read only once, and a sweep reads it for each run: give a file");
        if path == Path::new("-") {
            return Err(once());
        }
        let opened = input::open(&path, &view, self.budget).map_err(|failure| format!("input: {}", sentence(failure)))?;
        Ok(match opened.for_several_runs(self.budget) {
            Input::Scene(prepared) => Opened::Scene(prepared),
            Input::Trace(TraceFile { bytes: None, .. }) => return Err(once()),
            Input::Trace(_) => Opened::Trace,
        })
    }

    fn trace(&self, name: &str) -> Result<RunInput, String> {
        TraceFile::open(&self.place(name)).map(TraceFile::into_source).map_err(sentence)
    }

    fn text(&self, name: &str) -> Result<String, String> {
        read_text(&self.place(name), self.budget).map(|(text, _)| text).map_err(sentence)
    }

    fn png(&self, picture: &Picture) -> Result<Vec<u8>, String> {
        picture.to_png().map_err(|error| error.to_string())
    }

    fn publish(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        path.parent().map_or(Ok(()), std::fs::create_dir_all)?;
        PartialFile::write_whole(path, bytes)
    }

    fn progress(&self, tally: &Tally) {
        let before = tally.there as u64;
        self.progress.at((tally.done() as u64 - before, tally.points as u64 - before), tally.failed);
    }

    fn budget(&self) -> &Budget {
        self.budget
    }
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
