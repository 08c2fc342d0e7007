//! Runs missing points on all cores.
//!
//! Points that differ only in timing parameters are a group. The first missing point of a group is run and recorded. The others are
//! resimulated from its recording, which takes a fraction of the time. If the recording is too long, the run does not finish, or its
//! work differs, points are run by themselves. The results are equal to the byte.
//!
//! Points are taken in random order, and each is looked up again before it runs, so two processes on one folder reuse each other's
//! points. A different start in the same order does not suffice: the process behind catches up, and then both run the same points.

use crate::folder::PointStore;
use crate::one::{PointResult, run_point};
use crate::plan::{Plan, PlanPoint};
use crate::{PointStatus, SweepError, SweepHost, SweepProgress};
use basrelief_sim::Recording;
use basrelief_threads as threads;
use std::collections::hash_map::RandomState;
use std::collections::{BTreeMap, VecDeque};
use std::hash::BuildHasher;
use std::io::Cursor;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Points to run, and options.
#[derive(Clone, Copy, Debug)]
pub struct SweepJob<'a> {
    /// Points of the sweep.
    pub points: &'a [&'a PlanPoint],
    /// Runs failed points again.
    pub retry_failed: bool,
    /// Writes a picture of each point beside its report.
    pub pictures: bool,
    /// Parallel runs.
    pub threads: usize,
}

/// Runs the missing points.
///
/// # Errors
/// The first file that cannot be written, or an input that can no longer be opened. A failed point is no error: its failure is stored.
pub fn execute(
    plan: &Plan,
    work: &SweepJob<'_>,
    store: &dyn PointStore,
    host: &dyn SweepHost,
) -> Result<SweepProgress, SweepError> {
    let found = threads::par_map(work.points.to_vec(), |point| (point, store.find(&point.id)));
    let outdated = found.iter().filter(|(_, found)| *found == PointStatus::Outdated).count();
    let missing: Vec<&PlanPoint> =
        found.into_iter().filter(|(_, found)| must_run(*found, work)).map(|(point, _)| point).collect();
    let (points, there) = (work.points.len(), work.points.len() - missing.len());
    let tally = SweepProgress { points, existing: there, outdated, ..SweepProgress::default() };
    let tasks = missing.len();
    let queue = WorkQueue { groups: groups(missing), tally, ..WorkQueue::default() };
    let crew = SweepWorkers { plan, work, store, host, queue: Mutex::new(queue), changed: Condvar::new() };
    host.progress(&tally);
    threads::run_on_workers(work.threads.min(tasks), || crew.run_tasks());
    let queue = crew.queue.into_inner().unwrap_or_else(PoisonError::into_inner);
    queue.failed.map_or(Ok(queue.tally), Err)
}

fn is_missing(point: &PlanPoint, work: &SweepJob<'_>, store: &dyn PointStore) -> bool {
    must_run(store.find(&point.id), work)
}

fn must_run(found: PointStatus, work: &SweepJob<'_>) -> bool {
    found.is_missing() || found == PointStatus::Failed && work.retry_failed
}

/// Points by their work, groups and the points in them in an order drawn at random.
fn groups(points: Vec<&PlanPoint>) -> VecDeque<Vec<&PlanPoint>> {
    let chance = RandomState::new();
    let mut groups: BTreeMap<(u64, &str), Vec<&PlanPoint>> = BTreeMap::new();
    for point in points {
        groups.entry((chance.hash_one(&point.work), &point.work)).or_default().push(point);
    }
    let mut groups: VecDeque<Vec<&PlanPoint>> = groups.into_values().collect();
    groups.iter_mut().for_each(|group| group.sort_by_key(|point| chance.hash_one(&point.id)));
    groups
}

/// A recording, and the picture of all points that are timed from it.
struct RecordedGroup {
    recording: Recording,
    png: Option<Vec<u8>>,
}

#[derive(Default)]
struct WorkQueue<'a> {
    /// Groups to run, beginning with their first points.
    groups: VecDeque<Vec<&'a PlanPoint>>,
    /// Points to resimulate, with the recording of their group.
    again: VecDeque<(Arc<RecordedGroup>, &'a PlanPoint)>,
    /// Groups with a running first point, whose other points follow.
    begun: usize,
    tally: SweepProgress,
    failed: Option<SweepError>,
}

enum SweepTask<'a> {
    Run(Vec<&'a PlanPoint>),
    Retime(Arc<RecordedGroup>, &'a PlanPoint),
}

/// The way in which a result was obtained.
enum ResultSource {
    Existing,
    Run { failed: bool },
    Resimulated,
}

/// A point that was run and is in its place.
struct StoredPoint {
    way: ResultSource,
    png: Option<Vec<u8>>,
    recording: Option<Vec<u8>>,
}

struct SweepWorkers<'a> {
    plan: &'a Plan,
    work: &'a SweepJob<'a>,
    store: &'a dyn PointStore,
    host: &'a dyn SweepHost,
    queue: Mutex<WorkQueue<'a>>,
    changed: Condvar,
}

impl<'a> SweepWorkers<'a> {
    fn queue(&self) -> MutexGuard<'_, WorkQueue<'a>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Work loop of a thread, until no point is left.
    fn run_tasks(&self) {
        while let Some(task) = self.next() {
            let done = match task {
                SweepTask::Run(group) => self.run(group),
                SweepTask::Retime(recorded, point) => self.resimulate(&recorded, point).map(|way| self.count(way)),
            };
            if let Err(error) = done {
                self.queue().failed.get_or_insert(error);
            }
            self.changed.notify_all();
        }
    }

    fn next(&self) -> Option<SweepTask<'a>> {
        let mut queue = self.queue();
        loop {
            if queue.failed.is_some() {
                return None;
            }
            // Recorded points first, so that their recordings are released.
            if let Some((recorded, point)) = queue.again.pop_front() {
                return Some(SweepTask::Retime(recorded, point));
            }
            if let Some(group) = queue.groups.pop_front() {
                queue.begun += 1;
                return Some(SweepTask::Run(group));
            }
            if queue.begun == 0 {
                return None;
            }
            queue = self.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Runs the first point of a group that is still missing; the others are then timed again, or run after it.
    fn run(&self, group: Vec<&'a PlanPoint>) -> Result<(), SweepError> {
        let before = group.len();
        let mut missing = group.into_iter().filter(|point| is_missing(point, self.work, self.store)).collect::<VecDeque<_>>();
        (missing.len()..before).for_each(|_| self.count(ResultSource::Existing));
        let ran = missing.pop_front().map(|first| self.run_and_put(first, !missing.is_empty()));
        let recorded = match ran {
            Some(Ok(recorded)) => recorded,
            Some(Err(error)) => {
                self.queue().begun -= 1;
                return Err(error);
            }
            None => None,
        };
        let mut queue = self.queue();
        queue.begun -= 1;
        match recorded {
            Some(recorded) => {
                let recorded = Arc::new(recorded);
                queue.again.extend(missing.into_iter().map(|point| (Arc::clone(&recorded), point)));
            }
            None if missing.is_empty() => {}
            None => queue.groups.push_front(missing.into()),
        }
        Ok(())
    }

    /// Runs a point and stores its result. Returns its recording if other points are resimulated from it.
    fn run_and_put(&self, point: &PlanPoint, is_recorded: bool) -> Result<Option<RecordedGroup>, SweepError> {
        let StoredPoint { way, png, recording } = self.run_one(point, is_recorded)?;
        self.count(way);
        // If the recording does not fit into memory, the points run instead.
        let recording = recording.and_then(|recording| Recording::read(&mut Cursor::new(recording), self.host.budget()).ok());
        Ok(recording.map(|recording| RecordedGroup { recording, png }))
    }

    fn resimulate(&self, recorded: &RecordedGroup, point: &PlanPoint) -> Result<ResultSource, SweepError> {
        if !is_missing(point, self.work, self.store) {
            return Ok(ResultSource::Existing);
        }
        let report = self.plan.config(&point.places).ok().and_then(|config| recorded.recording.resimulate(&config).ok());
        let in_time = |total: u64| total <= self.plan.max_cycles;
        match report.filter(|report| report.cycles.as_ref().is_some_and(|cycles| in_time(cycles.total))) {
            Some(report) => {
                self.store.put(&point.id, &report, recorded.png.as_deref(), self.host).map(|()| ResultSource::Resimulated)
            }
            // Different work, or an incomplete run: only a run has its report.
            None => self.run_one(point, false).map(|placed| placed.way),
        }
    }

    /// Runs a point and puts it in its place.
    fn run_one(&self, point: &PlanPoint, is_recorded: bool) -> Result<StoredPoint, SweepError> {
        let PointResult { report, png, recording } = run_point(self.plan, point, self.work.pictures, is_recorded, self.host)?;
        let failed = report.is_err();
        match report {
            Ok(report) => self.store.put(&point.id, &report, png.as_deref(), self.host)?,
            Err(failure) => self.store.put_failure(&point.id, &failure, self.host)?,
        }
        Ok(StoredPoint { way: ResultSource::Run { failed }, png, recording })
    }

    fn count(&self, way: ResultSource) {
        let tally = {
            let tally = &mut self.queue().tally;
            match way {
                ResultSource::Existing => tally.existing += 1,
                ResultSource::Run { failed } => {
                    tally.run += 1;
                    tally.failed += usize::from(failed);
                }
                ResultSource::Resimulated => tally.resimulated += 1,
            }
            *tally
        };
        self.host.progress(&tally);
    }
}
