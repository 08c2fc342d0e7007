//! Sweeps: the points of a plan.

use crate::error::{CommandError, CommandResult, PythonResult, budget};
use crate::scene::{DisplayList, RunSource, ViewArguments, text_of};
use basrelief_dse::{
    Budget, ExplorationResult, ExploreOptions, OpenedInput, Plan as SweepPlan, PlanPoint, PointStatus, SweepFolder, SweepHost,
    SweepJob, SweepProgress, execute, explore as explore_plan, tables,
};
use basrelief_input::MemoryPool;
use basrelief_reference::RgbPicture;
use basrelief_scene::{ImportOptions, demo, load_path_with};
use basrelief_sim::{PreparedScene, RunInput, TOML_GROWTH, to_png};
use basrelief_threads as threads;
use pyo3::{PyErr, Python, pyclass, pyfunction, pymethods};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A checked plan with its inputs open.
#[pyclass(frozen, module = "basrelief._basrelief")]
pub struct Plan {
    plan: SweepPlan,
    files: PlanFiles,
}

#[pymethods]
impl Plan {
    /// Reads a plan from `text`, as if it were the file `name`. Paths in the plan are relative to the folder of that file.
    #[new]
    fn new(py: Python<'_>, name: PathBuf, text: &str, memory_limit: Option<u64>) -> PythonResult<Self> {
        py.detach(|| {
            let shown = name.display().to_string();
            let files = PlanFiles { plan: name, budget: budget(memory_limit.unwrap_or(MemoryPool::DEFAULT)) };
            let growth = files.budget.try_reserve(TOML_GROWTH * text.len() as u64, "what a plan says");
            let _growth = growth.map_err(CommandError::in_input(&shown))?;
            let host = PythonHost { files: &files, stopped: Mutex::default() };
            let plan = SweepPlan::read(text, &host).map_err(CommandError::in_input(&shown))?;
            Ok(Self { plan, files })
        })
    }

    /// Returns the hashes of the points without a result in this folder, each with the hash of its work. The order is that of the
    /// plan, in which neighbours are most similar, except that points with the same work are adjacent. `retry_failed` includes
    /// failed points.
    fn missing(&self, py: Python<'_>, folder: PathBuf, retry_failed: bool) -> Vec<(String, String)> {
        py.detach(|| {
            let folder = SweepFolder::new(&folder);
            let is_missing = |point: &&PlanPoint| match folder.find(&point.id) {
                PointStatus::Outdated | PointStatus::Missing => true,
                PointStatus::Failed => retry_failed,
                PointStatus::Report => false,
            };
            let mut missing: Vec<&PlanPoint> = self.plan.points.iter().filter(is_missing).collect();
            let mut first = BTreeMap::new();
            for (number, &point) in missing.iter().enumerate() {
                first.entry(&point.work).or_insert(number);
            }
            missing.sort_by_key(|point| first[&point.work]);
            missing.into_iter().map(|point| (point.id.clone(), point.work.clone())).collect()
        })
    }

    /// Runs those of these points that are missing, `at_once` in parallel. Returns the counts of reused, run, resimulated and
    /// failed points.
    fn execute(
        &self,
        py: Python<'_>,
        points: Vec<String>,
        folder: PathBuf,
        at_once: Option<usize>,
        options: (bool, bool),
    ) -> PythonResult<(usize, usize, usize, usize)> {
        let (retry_failed, pictures) = options;
        py.detach(|| {
            let wanted: BTreeSet<String> = points.into_iter().collect();
            let points: Vec<&PlanPoint> = self.plan.points.iter().filter(|point| wanted.contains(&point.id)).collect();
            let threads = at_once.unwrap_or_else(threads::workers);
            let work = SweepJob { points: &points, retry_failed, pictures, threads };
            let host = PythonHost { files: &self.files, stopped: Mutex::default() };
            let done = execute(&self.plan, &work, &SweepFolder::new(&folder), &host);
            if let Some(stopped) = host.stopped.into_inner().unwrap_or_else(PoisonError::into_inner) {
                return Err(stopped.into());
            }
            let SweepProgress { existing: there, run, resimulated: retimed, failed, .. } =
                done.map_err(CommandError::bad_input)?;
            Ok((there, run, retimed, failed))
        })
    }

    /// Writes the tables of all points, and returns the Pareto front as text.
    fn tables(&self, py: Python<'_>, folder: PathBuf) -> PythonResult<String> {
        let host = PythonHost { files: &self.files, stopped: Mutex::default() };
        Ok(py.detach(|| tables(&self.plan, &SweepFolder::new(&folder), &host)).map_err(CommandError::bad_input)?)
    }

    /// Number of points.
    fn __len__(&self) -> usize {
        self.plan.points.len()
    }

    /// The title of the plan.
    #[getter]
    fn title(&self) -> &str {
        &self.plan.title
    }
}

/// Counts of an exploration: points of the plan, chosen points, reused, run, resimulated and failed points.
type ExplorationCounts = (usize, usize, usize, usize, usize, usize);

/// Explores the plan `text`, as if it were the file `name`: chooses up to `budget` points, or points for so many seconds, and writes their
/// tables. Returns the counts, the Pareto front as text, and the share of the hypervolume of the whole grid if all its points exist.
#[pyfunction]
pub fn explore(
    py: Python<'_>,
    plan: (PathBuf, String, Option<u64>),
    limit: (Option<usize>, Option<f64>, u32),
    folder: PathBuf,
    at_once: Option<usize>,
    options: (bool, bool),
) -> PythonResult<(ExplorationCounts, String, Option<f64>)> {
    let ((points, seconds, seed), (retry_failed, pictures)) = (limit, options);
    let limit = match (points, seconds.map(Duration::try_from_secs_f64)) {
        (Some(points), None) if points > 0 => Budget::Points(points),
        (None, Some(Ok(time))) if !time.is_zero() => Budget::Time(time),
        _ => {
            return Err(CommandError::Usage(
                "expected `budget`, a number of points, or `seconds`, which are more than 0, and not both".into(),
            )
            .into());
        }
    };
    let (name, text, memory_limit) = plan;
    let Plan { plan, files } = Plan::new(py, name, &text, memory_limit)?;
    py.detach(|| {
        let (host, folder) = (PythonHost { files: &files, stopped: Mutex::default() }, SweepFolder::new(&folder));
        let threads = at_once.unwrap_or_else(threads::workers);
        let (all, work) = (plan.points.len(), SweepJob { points: &[], retry_failed, pictures, threads });
        let found = explore_plan(plan, ExploreOptions { budget: limit, seed }, &work, (&folder, &host));
        if let Some(stopped) = host.stopped.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(stopped.into());
        }
        let ExplorationResult { plan, tally, share, .. } = found.map_err(CommandError::bad_input)?;
        let front = tables(&plan, &folder, &host).map_err(CommandError::bad_input)?;
        let SweepProgress { existing, run, resimulated, failed, .. } = tally;
        Ok(((all, plan.points.len(), existing, run, resimulated, failed), front, share))
    })
}

/// Limits every later run of this process to one core, because the other cores belong to other tasks.
#[pyfunction]
pub fn work_alone() {
    threads::disable_threads();
}

/// Access to the files that a plan names.
struct PlanFiles {
    plan: PathBuf,
    budget: MemoryPool,
}

impl PlanFiles {
    fn path_of(&self, name: &str) -> PathBuf {
        self.plan.parent().map_or_else(|| name.into(), |folder| folder.join(name))
    }

    fn opened(&self, name: &str, view: &ViewArguments) -> CommandResult<OpenedInput> {
        let budget = &self.budget;
        let kept = |scene| OpenedInput::Scene(PreparedScene::cached(Arc::new(scene), budget));
        if let Some(name) = name.strip_prefix("demo:") {
            return demo(name, &view.options(budget)?).map(kept).map_err(CommandError::bad_input);
        }
        let path = self.path_of(name);
        if DisplayList::of_plan(&path).is_one()? {
            return if view.is_default() { Ok(OpenedInput::Trace) } else { Err(CommandError::bad_input(VIEW_OF_A_DISPLAY_LIST)) };
        }
        let shown = path.display().to_string();
        let options = ImportOptions { budget: budget.clone(), ..ImportOptions::default() };
        let loaded = load_path_with(&path, &view.options(budget)?, &options);
        let (scene, held) = loaded.map_err(|error| {
            if error.file == shown { CommandError::bad_input(error) } else { CommandError::in_input(&shown)(error) }
        })?;
        // Released with the memory limit of the plan.
        held.keep_forever();
        Ok(kept(scene))
    }
}

const VIEW_OF_A_DISPLAY_LIST: &str = "a display list carries its own view: a plan's view is for scenes";

/// Services that Python provides to a sweep.
struct PythonHost<'a> {
    files: &'a PlanFiles,
    /// Exception raised by Ctrl-C.
    stopped: Mutex<Option<PyErr>>,
}

impl SweepHost for PythonHost<'_> {
    fn open(&self, name: &str, view: &[(String, String)]) -> Result<OpenedInput, String> {
        let camera = |name: &str| {
            let path = self.files.path_of(name);
            Ok((path.display().to_string(), text_of(&path, &self.files.budget)?))
        };
        let view = ViewArguments::of_plan(view, camera)?;
        self.files.opened(name, &view).map_err(|failure| format!("input: {failure}"))
    }

    fn trace(&self, name: &str) -> Result<RunInput, String> {
        RunSource::DisplayList(DisplayList::of_plan(&self.files.path_of(name)))
            .into_input()
            .map_err(|failure| failure.to_string())
    }

    fn text(&self, name: &str) -> Result<String, String> {
        text_of(&self.files.path_of(name), &self.files.budget).map_err(|failure| failure.to_string())
    }

    fn png(&self, picture: &RgbPicture) -> Result<Vec<u8>, String> {
        to_png(picture)
    }

    fn publish(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.check_interrupt()?;
        publish(path, bytes)
    }

    fn progress(&self, _: &SweepProgress) {}

    fn budget(&self) -> &MemoryPool {
        &self.files.budget
    }
}

impl PythonHost<'_> {
    /// Returns an error once the user has pressed Ctrl-C, so that nothing more is written.
    fn check_interrupt(&self) -> io::Result<()> {
        let mut stopped = self.stopped.lock().unwrap_or_else(PoisonError::into_inner);
        if stopped.is_none() {
            *stopped = Python::attach(|py| py.check_signals()).err();
        }
        if stopped.is_some() { Err(ErrorKind::Interrupted.into()) } else { Ok(()) }
    }
}

/// Writes a temporary file in the same folder and renames it to `path`.
fn publish(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".partial-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map(drop).map_err(|error| error.error)
}
