//! Tasks of bottleneck analysis, for the threads of the host.

use super::relaxations::{Relaxation, Settings};
use basrelief_kernel::CriticalPath;
use basrelief_threads::TaskList;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A task for a worker thread.
pub(super) enum AnalysisTask {
    Path,
    /// Finds the cycles with these settings, which the ladder needs.
    Cycles(Settings),
    Resimulate(Relaxation),
    /// Climbs the ladder from the critical path. The relaxations are made alone, too.
    Climb(CriticalPath, Vec<Relaxation>),
    /// Finds a critical path that the ladder may need, unless it has left the rung of this number, counted from 0.
    LikelyPath(Settings, usize),
}

/// Paths that other threads find for the ladder.
pub(super) struct PathsAhead<'a> {
    tasks: Option<&'a TaskList<AnalysisTask>>,
    /// Number of rungs so far.
    climbed: &'a AtomicUsize,
}

impl<'a> PathsAhead<'a> {
    /// Without `tasks`, no other thread finds paths.
    pub(super) fn new(tasks: Option<&'a TaskList<AnalysisTask>>, climbed: &'a AtomicUsize) -> Self {
        Self { tasks, climbed }
    }

    /// Begins the search for the rung of this number.
    pub(super) fn begin_rung(&self, number: usize) {
        self.climbed.store(number, Ordering::Relaxed);
    }

    /// Lets another thread, if it has nothing else to do, find a path that the next rung is likely to need.
    pub(super) fn guess(&self, set: Settings) {
        if let Some(tasks) = self.tasks {
            tasks.add([AnalysisTask::LikelyPath(set, self.climbed.load(Ordering::Relaxed))]);
        }
    }
}
