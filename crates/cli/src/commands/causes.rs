//! Causes of the differences that `compare` prints: the input of the runs, and the progress of the measurement.

use crate::args::{CompareArgs, Explain, ViewArgs};
use crate::error::{CommandError, CommandResult};
use crate::global::GlobalOptions;
use crate::input::{self, Input, TraceFile};
use crate::progress::Progress;
use basrelief_report::{MeasuredCauses, Report};
use basrelief_scene::SceneSubject;
use basrelief_sim::{ExplainOptions, PreparedScene, RecordedRun, RunInput, explain, input_sha256};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

/// An input that threads open again.
enum RerunInput {
    Scene(PreparedScene),
    Trace(PathBuf),
}

impl RerunInput {
    fn open(&self) -> Option<RunInput> {
        match self {
            Self::Scene(scene) => Some(RunInput::Scene(scene.clone())),
            Self::Trace(path) => TraceFile::open(path).ok().map(TraceFile::into_source),
        }
    }
}

/// Returns the input of the runs; `None` if it cannot be opened again.
type InputOpener<'a> = Box<dyn Fn() -> Option<RunInput> + Sync + 'a>;

/// Measures causes with the options of the command line.
pub struct CauseMeasurement<'a> {
    policy: Explain,
    /// Opens the input for more runs; `None` if the machine must not run.
    open: Option<InputOpener<'a>>,
    global: &'a GlobalOptions,
}

impl<'a> CauseMeasurement<'a> {
    /// Opens the input of the runs, if the machine may run again.
    ///
    /// # Errors
    /// An input that is not the one of the report, or that cannot be read.
    pub fn new(
        args: &CompareArgs,
        first: (&'a Report, Option<&'a RecordedRun>),
        global: &'a GlobalOptions,
    ) -> CommandResult<Self> {
        if args.input.is_none() && args.view != ViewArgs::default() {
            return Err(CommandError::Usage("options of the view apply to --input only".into()));
        }
        let open: Option<InputOpener<'a>> = match (&args.input, first) {
            (Some(path), (report, Some(run))) if args.explain == Explain::All => {
                let input = given(path, &args.view, report, run, global)?;
                Some(Box::new(move || input.open()))
            }
            (None, (report, Some(run))) if args.explain == Explain::All => {
                // Most comparisons need no further run, and some demos take a second to make.
                let input = OnceLock::new();
                Some(Box::new(move || input.get_or_init(|| demo(report, run, global)).as_ref()?.open()))
            }
            _ => None,
        };
        Ok(Self { policy: args.explain, open, global })
    }

    /// Explains the difference of two runs; `None` if it is not to be explained.
    pub fn explain(&self, a: &RecordedRun, b: &RecordedRun) -> Option<MeasuredCauses> {
        if self.policy == Explain::None {
            return None;
        }
        let bar: Mutex<Option<Progress>> = Mutex::default();
        let progress = |done: usize, of: usize| {
            let mut bar = bar.lock().unwrap_or_else(PoisonError::into_inner);
            let bar = bar.get_or_insert_with(|| Progress::new(Some(of as u64), "runs and resimulations", self.global.quiet));
            bar.set_position(done as u64);
        };
        explain(a, b, &ExplainOptions { input: self.open.as_deref(), progress: &progress, budget: &self.global.budget })
    }
}

/// Opens the input that the user named.
fn given(path: &Path, view: &ViewArgs, report: &Report, run: &RecordedRun, global: &GlobalOptions) -> CommandResult<RerunInput> {
    let other = "is not the input of the first report: the hashes of its commands differ; give the view options of that run, too";
    rerun_input(path, view, report, run, global)?.ok_or_else(|| CommandError::in_input(&path.display().to_string())(other))
}

/// Returns the demo that a report names, if its default view gives the input of the report.
fn demo(report: &Report, run: &RecordedRun, global: &GlobalOptions) -> Option<RerunInput> {
    SceneSubject::demo(&report.input.name).ok()?;
    let frames = report.cycles.as_ref().map(|cycles| cycles.frames.len() as u32);
    let view = ViewArgs { size: Some([report.size.width, report.size.height]), frames, ..ViewArgs::default() };
    let path = format!("demo:{}", report.input.name);
    rerun_input(Path::new(&path), &view, report, run, global).ok()?
}

/// Opens an input; `None` if it is not the input of the report.
fn rerun_input(
    path: &Path,
    view: &ViewArgs,
    report: &Report,
    run: &RecordedRun,
    global: &GlobalOptions,
) -> CommandResult<Option<RerunInput>> {
    let input = match input::open(path, view, global)?.for_several_runs(&global.budget) {
        Input::Scene(scene) => RerunInput::Scene(scene),
        Input::Trace(_) => RerunInput::Trace(path.to_path_buf()),
    };
    let Some(source) = input.open() else { return Ok(None) };
    let sha256 = input_sha256(source, run.config(), &global.budget).map_err(CommandError::bad_input)?;
    Ok((sha256 == report.input.sha256).then_some(input))
}
