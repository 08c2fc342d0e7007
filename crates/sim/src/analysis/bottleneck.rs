//! Bottleneck analysis: each candidate is relaxed in turn, then groups of them, and the recorded steps are resimulated.

use super::analysis_task::{AnalysisTask, PathsAhead};
use super::ladder::{Ladder, LadderSearch, settings};
use super::relaxations::{DISPLAY, Relaxation, RelaxationCandidates, Settings, busiest_unit, with_equals};
use super::resimulations::Resimulations;
use crate::options::{Overrides, OverridesLoader};
use crate::recording::SharedRecording;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{self as kernel, Netlist, PathSegment, RequestPhase, RunReport, StageGroups};
use basrelief_machines::{InputKind, MachineSpec};
use basrelief_report::Report;
use basrelief_report::model::{Bottlenecks, CriticalPath, PathPart, RelaxedCycles};
use basrelief_threads as threads;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The parts of a relaxation are tried if the whole saves more than this share of the cycles \[1 / share\].
const MUCH: u64 = 20;

/// Converts a part of the critical path for the report.
fn path_part(kernel::PathPart { stretch, cycles, by_mark: frames }: kernel::PathPart) -> PathPart {
    let (resource, what) = match stretch {
        PathSegment::Occupancy(unit) => (unit, "occupancy"),
        PathSegment::Latency(unit) => (unit, "latency"),
        PathSegment::Fifo(fifo) => (fifo, "FIFO"),
        PathSegment::Slot(fifo) => (fifo, "slot"),
        // All waits for the display are one resource, whatever its clients are called.
        PathSegment::Memory(_, phase @ RequestPhase::Periodic) => (DISPLAY.to_owned(), phase_name(phase)),
        PathSegment::Memory(client, phase) => (client, phase_name(phase)),
        PathSegment::Rest => (String::new(), "rest"),
    };
    PathPart { resource, what: what.into(), cycles, frames }
}

fn phase_name(phase: RequestPhase) -> &'static str {
    match phase {
        RequestPhase::Arrival => "arrival",
        RequestPhase::Bus => "bus",
        RequestPhase::Bank => "bank",
        RequestPhase::Data => "data",
        RequestPhase::Order => "order",
        RequestPhase::Cache => "cache",
        RequestPhase::Periodic => "refresh",
    }
}

/// Converts the parts of the critical path, longest first.
fn path_parts(parts: Vec<kernel::PathPart>) -> Vec<PathPart> {
    let mut merged: Vec<PathPart> = vec![];
    for part in parts.into_iter().map(path_part) {
        match merged.iter_mut().find(|known| (&known.resource, &known.what) == (&part.resource, &part.what)) {
            Some(known) => {
                known.cycles += part.cycles;
                known.frames.iter_mut().zip(part.frames).for_each(|(sum, cycles)| *sum += cycles);
            }
            None => merged.push(part),
        }
    }
    merged.sort_by_key(|part| std::cmp::Reverse(part.cycles));
    merged
}

/// A completed run with its recorded steps.
pub(crate) struct CompletedRun<'a, S> {
    pub(crate) spec: &'a S,
    /// Parameters that the user gave. A relaxation is applied after them.
    pub(crate) overrides: &'a Overrides,
    pub(crate) input: InputKind,
    pub(crate) chunks: &'a [RecordingChunk],
    /// Memory that repeated resimulation may use \[bytes\].
    pub(crate) room: u64,
    pub(crate) run: &'a RunReport,
    /// Polygons of the steps of each stage; empty if they were not attributed.
    pub(crate) groups: &'a [StageGroups],
}

/// Bottlenecks and critical path of a run.
#[derive(Debug)]
pub(crate) struct BottleneckList {
    list: Bottlenecks,
    path: Option<kernel::CriticalPath>,
}

impl BottleneckList {
    /// Adds the bottlenecks to a report, and returns the cycles of the critical path by group.
    pub(crate) fn add_to(self, report: &mut Report) -> Vec<(u32, u64)> {
        report.bottlenecks = Some(self.list);
        let Some(kernel::CriticalPath { cycles, parts, by_group }) = self.path else { return vec![] };
        report.critical_path = Some(CriticalPath { cycles, parts: path_parts(parts), polygons: None });
        by_group
    }
}

/// Results of the tasks so far.
#[derive(Default)]
struct AnalysisProgress {
    path: Option<kernel::CriticalPath>,
    /// Candidates in the order of the block diagram; empty until the critical path is known.
    candidates: Vec<Relaxation>,
    ladder: Ladder,
}

impl AnalysisProgress {
    /// Returns all relaxations with their cycles: the candidates, then the parts of candidates for which `saves_much` is true.
    /// The order does not depend on the order of execution.
    fn single_relaxations(&self, resimulations: &Resimulations<'_>, saves_much: impl Fn(u64) -> bool) -> Vec<(Relaxation, u64)> {
        let timed = |relaxation: Relaxation| resimulations.cycles(&relaxation.set).map(|cycles| (relaxation, cycles));
        let mut all: Vec<_> = self.candidates.iter().cloned().filter_map(timed).collect();
        let parts = all.iter().filter(|(_, cycles)| saves_much(*cycles)).flat_map(|(whole, _)| whole.parts.clone());
        all.extend(parts.filter_map(timed).collect::<Vec<_>>());
        all
    }
}

impl<S: MachineSpec> CompletedRun<'_, S> {
    /// Returns the bottlenecks and the critical path; `None` if the machine has no netlist.
    pub(crate) fn bottlenecks(&self) -> Option<BottleneckList> {
        let netlist = self.input.shape(self.spec).ok()?;
        let loader = self.overrides.loader::<S>().ok()?;
        let relaxed = |set: &Settings| {
            let relaxed = self.input.shape(&loader.load(set).ok()?).ok()?;
            netlist.same_work(&relaxed).ok()?;
            Some(relaxed)
        };
        let resimulations = Resimulations::new(SharedRecording::new(self.chunks, &netlist, self.room), &relaxed);
        let progress = self.resimulate_all(&netlist, &resimulations, &loader);
        let mut timed = progress.single_relaxations(&resimulations, |cycles| self.saves_much(cycles));
        // The sort is stable: ties keep the order of the block diagram.
        timed.sort_by_key(|(_, cycles)| *cycles);
        let single: Vec<RelaxedCycles> =
            timed.into_iter().filter_map(|(relaxation, cycles)| self.bottleneck(relaxation, cycles)).collect();
        let best = single.first().map_or(0, |best| best.saved);
        let balanced = progress.ladder.balanced(self.run.marked_cycles(), best);
        Some(BottleneckList { list: Bottlenecks { balanced, ladder: progress.ladder.rungs, single }, path: progress.path })
    }

    /// Finds the critical path, resimulates each candidate on it, and climbs the ladder, which takes longest. Other threads find
    /// paths that the ladder will need.
    fn resimulate_all(
        &self,
        netlist: &Netlist,
        resimulations: &Resimulations<'_>,
        loader: &OverridesLoader<'_, S>,
    ) -> AnalysisProgress {
        let load = |set: &[(String, String)]| loader.load(set).ok();
        let resources = RelaxationCandidates { run: self.run, netlist, spec: self.spec, load: &load };
        let is_parallel = threads::workers() > 1;
        let all = resources.all();
        let busiest = busiest_unit(&all, self.run.marked_cycles()).filter(|_| is_parallel);
        let early = busiest.map(|unit| self.early_task(unit, &all));
        let first = [AnalysisTask::Path].into_iter().chain(early).chain([AnalysisTask::Cycles(settings(&all))]);
        let (progress, climbed) = (Mutex::<AnalysisProgress>::default(), AtomicUsize::new(0));
        threads::run_tasks(first, |task, tasks| match task {
            AnalysisTask::Path => {
                let path = resimulations.grouped_path(netlist.clone(), self.groups);
                let candidates = resources.on_path(&all, path.as_ref());
                tasks.add(path.clone().map(|path| AnalysisTask::Climb(path, candidates.clone())));
                tasks.add(candidates.iter().cloned().map(AnalysisTask::Resimulate));
                let mut progress = threads::lock(&progress);
                (progress.path, progress.candidates) = (path, candidates);
            }
            AnalysisTask::Resimulate(relaxation) => {
                let cycles = resimulations.cycles(&relaxation.set);
                if cycles.is_some_and(|cycles| self.saves_much(cycles)) {
                    tasks.add(relaxation.parts.into_iter().map(AnalysisTask::Resimulate));
                }
            }
            AnalysisTask::Cycles(set) => _ = resimulations.cycles(&set),
            AnalysisTask::Climb(path, candidates) => {
                let ahead = PathsAhead::new(is_parallel.then_some(tasks), &climbed);
                let ladder = LadderSearch { relaxations: &all, candidates: &candidates, resimulations, ahead }.climb(&path);
                threads::lock(&progress).ladder = ladder;
            }
            AnalysisTask::LikelyPath(set, rung) => {
                if rung == climbed.load(Ordering::Relaxed) {
                    resimulations.path(&set);
                }
            }
        });
        progress.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns a task for the time before the first path is known. If the busiest unit is saturated, the ladder is likely to begin with
    /// it. Otherwise it is at least a candidate, as a rule.
    fn early_task(&self, busiest: &Relaxation, all: &[Relaxation]) -> AnalysisTask {
        match busiest.is_saturated(self.run.marked_cycles()) {
            true => AnalysisTask::LikelyPath(settings(with_equals(busiest, all.iter())), 0),
            false => AnalysisTask::Resimulate(busiest.clone()),
        }
    }

    /// True if the parts of a relaxation are worth a resimulation each. The parts of memories that save little were as many
    /// resimulations as all others.
    fn saves_much(&self, cycles: u64) -> bool {
        let total = self.run.marked_cycles();
        total.saturating_sub(cycles) > total / MUCH
    }

    fn bottleneck(&self, relaxation: Relaxation, cycles: u64) -> Option<RelaxedCycles> {
        let saved = self.run.marked_cycles().checked_sub(cycles).filter(|saved| *saved > 0)?;
        let (resource, what) = (relaxation.id(), relaxation.what);
        let set = relaxation.set.into_iter().map(|(key, value)| format!("{key}={value}")).collect();
        Some(RelaxedCycles { resource, what: what.into(), set, cycles, saved })
    }
}
