//! Bottleneck analysis: each candidate is relaxed in turn, then groups of them, and the recorded steps are resimulated.

use super::ladder::{Ladder, LadderSearch};
use super::relaxations::{PART, Relaxation, RelaxationCandidates, Settings};
use crate::options::Overrides;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{self as kernel, Netlist, PathMemory, PathSegment, Recording, RequestPhase, RunReport, StageGroups};
use basrelief_machines::{InputKind, MachineSpec};
use basrelief_report::Report;
use basrelief_report::model::{Bottlenecks, CriticalPath, PathPart, RelaxedCycles};
use basrelief_threads as threads;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Mutex, PoisonError};

/// Relaxations that are resimulated concurrently with the critical path. Together they take about as long as the path.
const EARLY: usize = 2;
/// Maximum number of events in the search for a critical path, of 16 bytes each.
pub(crate) const EVENTS: usize = 8 << 20;
/// Converts a part of the critical path for the report.
fn path_part(kernel::PathPart { stretch, cycles, by_mark: frames }: kernel::PathPart) -> PathPart {
    let (resource, what) = match stretch {
        PathSegment::Occupancy(unit) => (unit, "occupancy"),
        PathSegment::Latency(unit) => (unit, "latency"),
        PathSegment::Fifo(fifo) => (fifo, "FIFO"),
        PathSegment::Slot(fifo) => (fifo, "slot"),
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
    }
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
        let parts = parts.into_iter().map(path_part).collect();
        report.critical_path = Some(CriticalPath { cycles, parts, polygons: None });
        by_group
    }
}

/// A task for a worker thread.
enum AnalysisTask {
    Path,
    Resimulate(Relaxation),
    /// Climbs the ladder from the critical path.
    Climb(kernel::CriticalPath),
}

/// Results of the tasks so far.
#[derive(Default)]
struct AnalysisProgress {
    path: Option<kernel::CriticalPath>,
    /// Candidates in the order of the block diagram; empty until the critical path is known.
    candidates: Vec<Relaxation>,
    /// Cycles by settings; `None` while the resimulation runs, and if it does not finish.
    cycles: BTreeMap<Settings, Option<u64>>,
    ladder: Ladder,
}

impl AnalysisProgress {
    /// Returns tasks for the relaxations that no thread resimulates yet.
    fn claim_tasks(&mut self, relaxations: &[Relaxation]) -> Vec<AnalysisTask> {
        let mut claimed = vec![];
        for relaxation in relaxations {
            if let Entry::Vacant(place) = self.cycles.entry(relaxation.set.clone()) {
                place.insert(None);
                claimed.push(AnalysisTask::Resimulate(relaxation.clone()));
            }
        }
        claimed
    }

    /// Returns all relaxations with their cycles: the candidates, then the parts of candidates for which `saves_much` is true.
    /// The order does not depend on the order of execution.
    fn single_relaxations(&self, saves_much: impl Fn(u64) -> bool) -> Vec<(Relaxation, u64)> {
        let known =
            |relaxation: Relaxation| self.cycles.get(&relaxation.set).copied().flatten().map(|cycles| (relaxation, cycles));
        let mut timed: Vec<_> = self.candidates.iter().cloned().filter_map(known).collect();
        let parts = timed.iter().filter(|(_, cycles)| saves_much(*cycles)).flat_map(|(whole, _)| whole.parts.clone());
        timed.extend(parts.filter_map(known).collect::<Vec<_>>());
        timed
    }
}

/// The recorded steps, ready for repeated resimulation, and the netlist that they were recorded on.
struct RecordedSteps<'a> {
    recording: Recording<'a>,
    netlist: Netlist,
    /// Memory of earlier critical paths.
    spare: Mutex<Vec<PathMemory>>,
}

impl RecordedSteps<'_> {
    /// Returns the critical path on a machine with this netlist.
    fn critical_path(&self, netlist: Netlist, groups: &[StageGroups]) -> Option<kernel::CriticalPath> {
        let spare = || self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let mut memory = spare().pop().unwrap_or_default();
        let path = self.recording.critical_path(netlist, EVENTS, groups, &mut memory);
        spare().push(memory);
        path.ok()?
    }
}

impl<S: MachineSpec> CompletedRun<'_, S> {
    /// Returns the bottlenecks and the critical path; `None` if the machine has no netlist.
    pub(crate) fn bottlenecks(&self) -> Option<BottleneckList> {
        let netlist = self.input.shape(self.spec).ok()?;
        let recording = Recording::new(self.chunks, &netlist, self.room);
        let recorded = RecordedSteps { recording, netlist, spare: Mutex::default() };
        let progress = self.resimulate_all(&recorded);
        let mut timed = progress.single_relaxations(|cycles| self.saves_much(cycles));
        // The sort is stable: ties keep the order of the block diagram.
        timed.sort_by_key(|(_, cycles)| *cycles);
        let single: Vec<RelaxedCycles> =
            timed.into_iter().filter_map(|(relaxation, cycles)| self.bottleneck(relaxation, cycles)).collect();
        let best = single.first().map_or(0, |best| best.saved);
        let balanced = progress.ladder.balanced(self.run.marked_cycles(), best);
        Some(BottleneckList { list: Bottlenecks { balanced, ladder: progress.ladder.rungs, single }, path: progress.path })
    }

    /// Finds the critical path, and resimulates each candidate on it. Meanwhile, other threads resimulate the busiest units, which are
    /// usually candidates, because the path takes as long as some resimulations.
    fn resimulate_all(&self, recorded: &RecordedSteps<'_>) -> AnalysisProgress {
        let early = if threads::workers() > 1 { EARLY } else { 0 };
        let load = |set: &[(String, String)]| self.overrides.load::<S>(set).ok();
        let resources = RelaxationCandidates { run: self.run, netlist: &recorded.netlist, spec: self.spec, load: &load };
        let (all, busiest) = (resources.all(), resources.busiest_units(early));
        let mut progress = AnalysisProgress::default();
        let first: Vec<AnalysisTask> = [AnalysisTask::Path].into_iter().chain(progress.claim_tasks(&busiest)).collect();
        let progress = Mutex::new(progress);
        threads::run_tasks(first, |task, tasks| match task {
            AnalysisTask::Path => {
                let path = self.critical_path(recorded);
                let candidates = resources.on_path(path.as_ref());
                let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
                tasks.add(path.clone().map(AnalysisTask::Climb));
                tasks.add(progress.claim_tasks(&candidates));
                (progress.path, progress.candidates) = (path, candidates);
            }
            AnalysisTask::Resimulate(relaxation) => {
                let cycles = self.cycles(recorded, &relaxation.set);
                let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
                if cycles.is_some_and(|cycles| self.saves_much(cycles)) {
                    tasks.add(progress.claim_tasks(&relaxation.parts));
                }
                progress.cycles.insert(relaxation.set, cycles);
            }
            AnalysisTask::Climb(path) => {
                let critical_path = |set: &Settings| self.relaxed_path(recorded, set);
                let cycles = |set: &Settings| self.cycles(recorded, set);
                let search = LadderSearch { relaxations: &all, critical_path: &critical_path, cycles: &cycles };
                let ladder = search.climb(&path);
                progress.lock().unwrap_or_else(PoisonError::into_inner).ladder = ladder;
            }
        });
        progress.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn critical_path(&self, recorded: &RecordedSteps<'_>) -> Option<kernel::CriticalPath> {
        recorded.critical_path(self.input.shape(self.spec).ok()?, self.groups)
    }

    /// True if the parts of a relaxation are worth a resimulation each. The parts of memories that save next to nothing were as many
    /// resimulations as all others.
    fn saves_much(&self, cycles: u64) -> bool {
        let total = self.run.marked_cycles();
        total.saturating_sub(cycles) > total / PART
    }

    fn bottleneck(&self, relaxation: Relaxation, cycles: u64) -> Option<RelaxedCycles> {
        let saved = self.run.marked_cycles().checked_sub(cycles).filter(|saved| *saved > 0)?;
        let (resource, what) = (relaxation.id(), relaxation.what);
        let set = relaxation.set.into_iter().map(|(key, value)| format!("{key}={value}")).collect();
        Some(RelaxedCycles { resource, what: what.into(), set, cycles, saved })
    }

    /// Returns the render cycles with these settings; `None` if they change the work of the units or do not fit together.
    fn cycles(&self, recorded: &RecordedSteps<'_>, set: &[(String, String)]) -> Option<u64> {
        recorded.recording.cycles(self.relaxed_netlist(recorded, set)?).ok()?
    }

    /// Returns the critical path with these settings.
    fn relaxed_path(&self, recorded: &RecordedSteps<'_>, set: &[(String, String)]) -> Option<kernel::CriticalPath> {
        recorded.critical_path(self.relaxed_netlist(recorded, set)?, &[])
    }

    fn relaxed_netlist(&self, recorded: &RecordedSteps<'_>, set: &[(String, String)]) -> Option<Netlist> {
        let netlist = self.input.shape(&self.overrides.load::<S>(set).ok()?).ok()?;
        recorded.netlist.same_work(&netlist).ok()?;
        Some(netlist)
    }
}
