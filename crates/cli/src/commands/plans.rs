//! Code shared by `sweep` and `explore`.

use crate::args::{PlanArgs, ViewArgs};
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::input::{ResolvedView, TraceFile, open_trace, read_text, resolve_view};
use crate::interrupt;
use crate::outputs::{PartialFile, check_outputs_keep_inputs};
use crate::progress::PointProgress;
use crate::scene_input::{demo_of, input_error, open_scene};
use crate::terminal::print_note;
use basrelief_dse::{
    OpenError, OpenedInput, Plan, PlanPoint, PointStatus, SweepError, SweepFolder, SweepHost, SweepJob, SweepProgress, tables,
};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_parameters::nearest;
use basrelief_reference::RgbPicture;
use basrelief_scene::ViewOptions;
use basrelief_sim::{PreparedScene, RunInput, TOML_GROWTH, existing_in_plan, reason_and_cure, to_png};
use basrelief_threads as threads;
use clap::{CommandFactory, Parser};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A plan and the folder of its points.
pub struct OpenedPlan<'a> {
    pub host: SweepProgram<'a>,
    pub plan: Plan,
    pub folder: SweepFolder,
    /// Parallel runs.
    pub threads: usize,
    /// Memory of the plan.
    pub _held: [MemoryReservation; 2],
}

impl<'a> OpenedPlan<'a> {
    /// Reads a plan.
    ///
    /// # Errors
    /// An unreadable file or an invalid plan.
    pub fn read(args: &PlanArgs, global: &'a GlobalOptions) -> CommandResult<Self> {
        interrupt::set_message("interrupted; points that are finished are kept; run the command again to continue");
        if args.threads == Some(1) {
            threads::disable_threads();
        }
        let host = SweepProgram {
            plan: args.plan.clone(),
            read: Mutex::new([args.plan.clone()].into()),
            global,
            progress: PointProgress::new(global.quiet),
        };
        let name = args.plan.display().to_string();
        let (text, held) = read_text(&args.plan, "a plan (TOML)", &global.budget)?;
        let growth = global
            .budget
            .try_reserve(TOML_GROWTH * text.len() as u64, "the values of a plan")
            .map_err(CommandError::in_input(&name))?;
        let plan = Plan::read(&text, &host).map_err(CommandError::in_input(&name))?;
        CommandError::check_folder(&args.out)?;
        let tables = basrelief_dse::tables::FILES.iter().map(|(file, _)| args.out.join(file));
        let tables: Vec<PathBuf> = tables.collect();
        let tables: Vec<(&str, &Path)> = tables.iter().map(|table| ("--out", &**table)).collect();
        host.check_outputs(&tables).map_err(CommandError::Usage)?;
        let threads = args.threads.map_or_else(threads::workers, usize::from);
        Ok(Self { host, plan, folder: SweepFolder::new(&args.out), threads, _held: [held, growth] })
    }
}

/// Describes the work of these points.
pub fn work<'a>(args: &PlanArgs, points: &'a [&'a PlanPoint], threads: usize) -> SweepJob<'a> {
    SweepJob { points, retry_failed: args.retry_failed, pictures: !args.no_pictures, threads }
}

/// Returns the counts of points as text.
pub fn counts(
    SweepProgress { points, existing: there, run, resimulated: retimed, outdated, .. }: &SweepProgress,
    failed: usize,
) -> String {
    let again = if *outdated > 0 { format!("{outdated} of another build of basrelief are run again\n") } else { String::new() };
    let noun = if *points == 1 { "point" } else { "points" };
    format!("{points} {noun}: {there} reused, {run} run, {retimed} resimulated; {failed} failed\n{again}")
}

/// Returns the number of these points that failed.
pub fn failed_points(folder: &SweepFolder, points: &[&PlanPoint]) -> usize {
    folder.find_all(points).into_iter().filter(|found| *found == PointStatus::Failed).count()
}

/// Prints the message of a finished command. `failed`: number of points that failed, of so many.
///
/// # Errors
/// All of these points failed.
pub fn finish(said: &str, failed: (usize, usize), plan: &Plan, args: &PlanArgs, global: &GlobalOptions) -> CommandResult {
    if !global.quiet {
        print(said)?;
        let name = args.plan.display();
        plan.warnings().iter().for_each(|warning| print_note(&format!("warning: {name}: {warning}")));
    }
    let (failed, points) = failed;
    if failed < points || points == 0 {
        return Ok(());
    }
    let which = if points == 1 { "the only point".to_owned() } else { format!("all {points} points") };
    Err(CommandError::BadInput(format!(
        "{which} failed; {}/points/ID/failed.json states why; correct the plan, or run them again with --retry-failed",
        args.out.display()
    )))
}

/// Writes the tables and returns a message.
///
/// # Errors
/// A file that cannot be read or written.
pub fn write_tables(plan: &Plan, folder: &SweepFolder, args: &PlanArgs, host: &SweepProgram<'_>) -> CommandResult<String> {
    let front = tables(plan, folder, host).map_err(sweep_error)?;
    let files: Vec<&str> = basrelief_dse::tables::FILES.iter().map(|(file, _)| *file).collect();
    Ok(format!("\n{front}\nWritten to {}/: {}\n", args.out.display(), files.join(", ")))
}

pub fn sweep_error(error: SweepError) -> CommandError {
    CommandError::BadInput(error.to_string())
}

/// Services of this program for a sweep.
pub struct SweepProgram<'a> {
    plan: PathBuf,
    /// Files read so far.
    read: Mutex<BTreeSet<PathBuf>>,
    global: &'a GlobalOptions,
    progress: PointProgress,
}

impl<'a> SweepProgram<'a> {
    /// Makes the services for a sensitivity analysis, whose paths are those of the command line.
    pub fn around_run(global: &'a GlobalOptions, quiet: bool) -> Self {
        Self { plan: PathBuf::new(), read: Mutex::default(), global, progress: PointProgress::new(quiet) }
    }
}

/// The view options alone.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct ViewCommand {
    #[command(flatten)]
    view: ViewArgs,
}

/// Returns the JSON schema of the view options in a plan.
pub fn view_schema() -> Value {
    let command = ViewCommand::command();
    let options = command.get_arguments().filter(|option| !option.is_hide_set()).map(|option| {
        let about = option.get_help().map(ToString::to_string).unwrap_or_default();
        (option.get_id().to_string(), json!({ "type": ["string", "number", "array"], "description": about }))
    });
    json!({ "type": "object", "properties": options.collect::<Map<_, _>>(), "additionalProperties": false })
}

impl SweepProgram<'_> {
    /// Returns the path of a file that the plan names.
    fn path_of(&self, name: &str) -> PathBuf {
        let path = self.plan.parent().map_or_else(|| name.into(), |folder| folder.join(name));
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(path.clone());
        path
    }

    /// Returns the path of a file that the plan names and that exists.
    fn existing_path_of(&self, name: &str) -> Result<PathBuf, String> {
        existing_in_plan(&self.plan, self.path_of(name))
    }

    /// Refuses outputs that are among the files that the plan names, or the plan itself.
    fn check_outputs(&self, outputs: &[(&str, &Path)]) -> Result<(), String> {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let read: Vec<(&str, &Path)> = read.iter().map(|path| ("of the plan", &**path)).collect();
        check_outputs_keep_inputs(None, outputs, &read)
    }

    /// Converts the view of a plan into options.
    fn view(&self, view: &[(String, String)]) -> Result<ViewOptions, String> {
        let command = ViewCommand::command();
        let known: Vec<&str> = command.get_arguments().map(|argument| argument.get_id().as_str()).collect();
        if let Some((name, _)) = view.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            let hint = nearest(name, known.iter().copied()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            return Err(format!("no option is called `{name}`{hint} (`basrelief run --help` lists all under View)"));
        }
        let option = |(name, value): &(String, String)| {
            let is_file = ["camera", "views"].contains(&name.as_str());
            let value = if is_file { self.existing_path_of(value)?.display().to_string() } else { value.clone() };
            Ok(format!("--{}={value}", name.replace('_', "-")))
        };
        let options = view.iter().map(option).collect::<Result<Vec<_>, String>>()?;
        let parsed = ViewCommand::try_parse_from(options).map_err(|error| {
            let text = error.to_string();
            text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
        })?;
        let resolved = resolve_view(&parsed.view, &self.global.budget).and_then(ResolvedView::without_times);
        resolved.map_err(|error| error.to_string())
    }
}

impl SweepHost for SweepProgram<'_> {
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<OpenedInput, OpenError> {
        let options = OpenError::in_view(view, |view| self.view(view))?;
        let is_demo = demo_of(Path::new(name)).is_some();
        let path = if is_demo || name == "-" { Ok(name.into()) } else { self.existing_path_of(name) };
        let path: PathBuf = path.map_err(OpenError::Input)?;
        let once =
            || OpenError::Input(format!("{name}: can be read only once, but every run of a sweep reads it; expected a file"));
        if path == Path::new("-") {
            return Err(once());
        }
        let Some(trace) = open_trace(&path).map_err(|error| OpenError::Input(error.to_string()))? else {
            let scene = open_scene(&path, &options, self.global).map_err(|error| {
                let (place, of_option) = (error.place.clone(), error.in_option().to_string());
                OpenError::at_place(&place, view, of_option, input_error(&path)(error).to_string())
            })?;
            return Ok(OpenedInput::Scene(PreparedScene::cached(scene, &self.global.budget)));
        };
        match (trace.bytes, view.first()) {
            (None, _) => Err(once()),
            (_, Some((option, _))) if options != ViewOptions::default() => Err(OpenError::view_of_trace(name, option)),
            _ => Ok(OpenedInput::Trace),
        }
    }

    fn trace(&self, name: &str) -> Result<RunInput, String> {
        TraceFile::open(&self.path_of(name)).map(TraceFile::into_source).map_err(|failure| failure.to_string())
    }

    fn text(&self, name: &str) -> Result<String, String> {
        let read = read_text(&self.existing_path_of(name)?, "parameters of a machine (TOML or JSON)", &self.global.budget);
        read.map(|(text, _)| text).map_err(|failure| failure.to_string())
    }

    fn png(&self, picture: &RgbPicture) -> Result<Vec<u8>, String> {
        to_png(picture)
    }

    fn publish(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.check_outputs(&[("--out", path)]).map_err(io::Error::other)?;
        let created = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        let written = created.and_then(|()| PartialFile::write_whole(path, bytes));
        written.map_err(|error| io::Error::new(error.kind(), reason_and_cure(path, "be written", &error)))
    }

    fn progress(&self, tally: &SweepProgress) {
        let before = tally.existing as u64;
        self.progress.set_position(tally.done() as u64 - before, tally.points as u64 - before, tally.failed);
    }

    fn budget(&self) -> &MemoryPool {
        &self.global.budget
    }
}
