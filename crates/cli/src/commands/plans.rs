//! What is common to the commands that run the points of a plan.

use crate::args::{PlanArgs, ViewArgs};
use crate::error::{Done, Failure};
use crate::input::{self, Input, TraceFile, demo_of, read_text};
use crate::interrupt;
use crate::outputs::PartialFile;
use crate::progress::PointProgress;
use basrelief_dse::{Folder, Host, Opened, Plan, Point, SweepError, Tally, Work, tables};
use basrelief_input::{Budget, Held};
use basrelief_parameters::nearest;
use basrelief_reference::Picture;
use basrelief_sim::{RunInput, TOML_GROWTH, to_png};
use basrelief_threads as threads;
use clap::{CommandFactory, Parser};
use std::io;
use std::path::{Path, PathBuf};

/// A plan that is read, and where its points lie.
pub struct Planned<'a> {
    pub host: Program<'a>,
    pub plan: Plan,
    pub folder: Folder,
    /// Points under way at a time.
    pub threads: usize,
    /// For the plan's text, and what it says.
    pub _held: [Held; 2],
}

impl<'a> Planned<'a> {
    /// Reads it.
    ///
    /// # Errors
    /// A file that cannot be read, or says what is no plan.
    pub fn read(args: &PlanArgs, budget: &'a Budget, quiet: bool) -> Done<Self> {
        interrupt::say("interrupted; points that are finished stay: run it again to go on");
        if args.threads == Some(1) {
            threads::work_alone();
        }
        let host = Program { plan: args.plan.clone(), budget, progress: PointProgress::new(quiet) };
        let name = args.plan.display().to_string();
        let (text, held) = read_text(&args.plan, budget)?;
        let growth = budget.take(TOML_GROWTH * text.len() as u64, "what a plan says").map_err(Failure::within(&name))?;
        let plan = Plan::read(&text, &host).map_err(Failure::within(&name))?;
        let threads = args.threads.map_or_else(threads::workers, usize::from);
        Ok(Self { host, plan, folder: Folder::new(&args.out), threads, _held: [held, growth] })
    }
}

/// What is to be done of these points.
pub fn work<'a>(args: &PlanArgs, points: &'a [&'a Point], threads: usize) -> Work<'a> {
    Work { points, retry_failed: args.retry_failed, pictures: !args.no_pictures, threads }
}

/// How points came to be there, in words.
pub fn counts(Tally { points, there, run, retimed, .. }: &Tally, failed: usize) -> String {
    format!("{points} points: {there} there before, {run} run, {retimed} timed again; {failed} failed\n")
}

/// Writes the tables, and says so.
///
/// # Errors
/// A file that cannot be read or written.
pub fn written(plan: &Plan, folder: &Folder, args: &PlanArgs, host: &Program<'_>) -> Done<String> {
    let front = tables(plan, folder, host).map_err(bad)?;
    let files: Vec<&str> = basrelief_dse::tables::FILES.iter().map(|(file, _)| *file).collect();
    Ok(format!("\n{front}\nWritten to {}/: {}\n", args.out.display(), files.join(", ")))
}

pub fn bad(error: SweepError) -> Failure {
    Failure::Bad(error.to_string())
}

/// What a sweep asks of this program.
pub struct Program<'a> {
    plan: PathBuf,
    budget: &'a Budget,
    progress: PointProgress,
}

impl<'a> Program<'a> {
    /// Around a run: files lie where its command line says.
    pub fn around_run(budget: &'a Budget, quiet: bool) -> Self {
        Self { plan: PathBuf::new(), budget, progress: PointProgress::new(quiet) }
    }
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
        to_png(picture)
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
