//! Sweeps: the points of a plan.

use crate::error::{CommandError, PythonResult, budget};
use crate::host::{PlanFiles, PythonHost};
use basrelief_dse::{
    Budget, ExplorationResult, ExploreOptions, Plan as SweepPlan, PlanPoint, PointStatus, SweepFolder, SweepJob, SweepProgress,
    execute, explore as explore_plan, tables,
};
use basrelief_input::MemoryPool;
use basrelief_sim::TOML_GROWTH;
use basrelief_threads as threads;
use pyo3::{Python, pyclass, pyfunction, pymethods};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
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
            let growth = files.budget.try_reserve(TOML_GROWTH * text.len() as u64, "the values of a plan");
            let _growth = growth.map_err(CommandError::in_input(&shown))?;
            let host = PythonHost::new(&files);
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
            CommandError::check_folder(&folder)?;
            let host = PythonHost::new(&self.files);
            let done = execute(&self.plan, &work, &SweepFolder::new(&folder), &host);
            if let Some(stopped) = host.stopped() {
                return Err(stopped.into());
            }
            let SweepProgress { existing: there, run, resimulated: retimed, failed, .. } =
                done.map_err(CommandError::bad_input)?;
            Ok((there, run, retimed, failed))
        })
    }

    /// Writes the tables of all points, and returns the Pareto front as text.
    fn tables(&self, py: Python<'_>, folder: PathBuf) -> PythonResult<String> {
        let host = PythonHost::new(&self.files);
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

    /// Warnings about figures that the plan names.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.plan.warnings()
    }
}

/// Counts of an exploration: points of the plan, chosen points, reused, run, resimulated and failed points.
type ExplorationCounts = (usize, usize, usize, usize, usize, usize);

/// Explores the plan `text`, as if it were the file `name`: chooses up to `budget` points, or points for so many seconds, and writes their
/// tables. Returns the counts, the Pareto front as text, the share of the hypervolume of the whole grid if all its points exist, and the
/// warnings of the plan.
#[pyfunction]
pub fn explore(
    py: Python<'_>,
    plan: (PathBuf, String, Option<u64>),
    limit: (Option<usize>, Option<f64>, u32),
    folder: PathBuf,
    at_once: Option<usize>,
    options: (bool, bool),
) -> PythonResult<(ExplorationCounts, String, Option<f64>, Vec<String>)> {
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
        CommandError::check_folder(&folder)?;
        let (host, folder) = (PythonHost::new(&files), SweepFolder::new(&folder));
        let threads = at_once.unwrap_or_else(threads::workers);
        let (all, work) = (plan.points.len(), SweepJob { points: &[], retry_failed, pictures, threads });
        let found = explore_plan(plan, ExploreOptions { budget: limit, seed }, &work, &folder, &host);
        if let Some(stopped) = host.stopped() {
            return Err(stopped.into());
        }
        let ExplorationResult { plan, tally, share, .. } = found.map_err(CommandError::bad_input)?;
        let front = tables(&plan, &folder, &host).map_err(CommandError::bad_input)?;
        let SweepProgress { existing, run, resimulated, failed, .. } = tally;
        let counts = (all, plan.points.len(), existing, run, resimulated, failed);
        Ok((counts, front, share, plan.warnings()))
    })
}

/// Limits every later run of this process to one core, because the other cores belong to other tasks.
#[pyfunction]
pub fn work_alone() {
    threads::disable_threads();
}
