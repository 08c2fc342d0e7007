//! What limits a run, measured: each thing that could is made ideal in turn, and the run timed again from its tape.

use crate::ideals::{Candidates, Ideal, PART, together};
use crate::machines::MachineSpec;
use crate::run::Way;
use crate::settings::When;
use crate::tape::{Given, bytes_of};
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{self as kernel, Netlist, PathSegment, Recording, RequestPhase, RunReport, StageGroups};
use basrelief_report::Report;
use basrelief_report::model::{CriticalPath, Limit, PathPart};
use basrelief_threads as threads;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Mutex, PoisonError};

/// How many single limits are tried in pairs.
const PAIRED: usize = 3;
/// How many are timed beside the critical path: together they take about as long.
const EARLY: usize = 2;
/// Most events that a critical path is looked for in, of 16 bytes each.
pub(crate) const EVENTS: usize = 8 << 20;
/// What two must save together, beyond what each saves alone, to be worth a line \[1/1000 of the cycles\].
const TOGETHER: u64 = 10;

/// The tape of a run that is timed again when it is over.
#[derive(Debug)]
pub(crate) struct Kept {
    reels: Vec<RecordingChunk>,
    /// Bytes that are left to keep; none once it was too long.
    left: Option<usize>,
    held: Held,
}

impl Kept {
    /// Bytes of a tape that is short: a step takes some five.
    pub(crate) const SHORT: usize = 4 << 20;

    pub(crate) fn new(limits: When, budget: &Budget) -> Option<Self> {
        let left = match limits {
            When::Never => return None,
            When::IfShort => Self::SHORT,
            When::Always => usize::MAX,
        };
        Some(Self { reels: vec![], left: Some(left), held: budget.nothing() })
    }

    /// Keeps a reel; none at all once there are too many.
    ///
    /// # Errors
    /// More than may be held, where all are wanted.
    pub(crate) fn keep(&mut self, reel: RecordingChunk) -> Result<(), OverBudget> {
        let bytes = bytes_of(&reel);
        self.left = self.left.and_then(|left| left.checked_sub(bytes));
        if self.left.is_some() {
            self.held.grow(bytes as u64, "the tape, to measure what limits the run")?;
            self.reels.push(reel);
        } else {
            self.reels = vec![];
            self.held.shrink_to(0);
        }
        Ok(())
    }

    /// All reels; none where there were too many.
    pub(crate) fn reels(&self) -> Option<&[RecordingChunk]> {
        self.left.map(|_| self.reels.as_slice())
    }
}

/// A part of the critical path in the report's words.
fn part(kernel::PathPart { stretch, cycles, by_mark: frames }: kernel::PathPart) -> PathPart {
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

/// The tape of a run that is complete, and the machine that made it.
pub(crate) struct Recorded<'a, S> {
    pub(crate) spec: &'a S,
    /// What the user gave of its parameters: `set` is over these.
    pub(crate) given: &'a Given,
    pub(crate) way: Way,
    pub(crate) reels: &'a [RecordingChunk],
    /// Most that timing it more than once may hold beside \[bytes\].
    pub(crate) room: u64,
    pub(crate) run: &'a RunReport,
    /// What the steps of each stage are for, where that was followed.
    pub(crate) groups: &'a [StageGroups],
}

/// What limits a run, as far as it could be measured.
#[derive(Debug)]
pub(crate) struct Measured {
    limits: Vec<Limit>,
    path: Option<kernel::CriticalPath>,
}

impl Measured {
    /// Puts it into a report; cycles of the critical path by group.
    pub(crate) fn put(self, report: &mut Report) -> Vec<(u32, u64)> {
        report.limits = Some(self.limits);
        let Some(kernel::CriticalPath { cycles, parts, by_group }) = self.path else { return vec![] };
        report.critical_path = Some(CriticalPath { cycles, parts: parts.into_iter().map(part).collect(), polygons: None });
        by_group
    }
}

/// A piece of the work.
enum Task {
    Path,
    Time(Ideal),
}

/// How far the measurement is.
#[derive(Default)]
struct Progress {
    path: Option<kernel::CriticalPath>,
    /// What is worth it, in the order of the block diagram, once that is known.
    singles: Vec<Ideal>,
    /// What is timed or being timed, by parameters: its cycles, where it has any.
    cycles: BTreeMap<Vec<(String, String)>, Option<u64>>,
}

impl Progress {
    /// Those of them that nobody times yet: whoever asks does.
    fn claim(&mut self, ideals: &[Ideal]) -> Vec<Task> {
        let mut claimed = vec![];
        for ideal in ideals {
            if let Entry::Vacant(place) = self.cycles.entry(ideal.set.clone()) {
                place.insert(None);
                claimed.push(Task::Time(ideal.clone()));
            }
        }
        claimed
    }

    /// The critical path; and all that was worth it with its cycles, where it has any: behind it the parts of what saves `much`, in
    /// this order whichever was timed first.
    fn timed(self, much: impl Fn(u64) -> bool) -> (Option<kernel::CriticalPath>, Vec<(Ideal, u64)>) {
        let known = |ideal: Ideal| self.cycles.get(&ideal.set).copied().flatten().map(|cycles| (ideal, cycles));
        let mut timed: Vec<_> = self.singles.into_iter().filter_map(known).collect();
        let parts = timed.iter().filter(|(_, cycles)| much(*cycles)).flat_map(|(ideal, _)| ideal.parts.clone());
        timed.extend(parts.filter_map(known).collect::<Vec<_>>());
        (self.path, timed)
    }
}

impl<S: MachineSpec> Recorded<'_, S> {
    /// What limits the run, and its critical path; none where the machine has no shape.
    pub(crate) fn measure(&self) -> Option<Measured> {
        let shape = self.way.shape(self.spec).ok()?;
        let tape = Recording::new(self.reels, &shape, self.room);
        let (path, mut timed) = self.singles((&tape, &shape)).timed(|cycles| self.saves_much(cycles));
        // Stable: of equals the first in the block diagram is first.
        timed.sort_by_key(|(_, cycles)| *cycles);
        let pairs = self.pairs((&tape, &shape), &timed);
        let mut limits: Vec<Limit> =
            timed.into_iter().chain(pairs).filter_map(|(ideal, cycles)| self.limit(ideal, cycles)).collect();
        limits.sort_by_key(|limit| limit.cycles);
        Some(Measured { limits, path })
    }

    /// The critical path, and what could be saved on it, each alone. The path takes as long as some timings do: meanwhile others time
    /// the busiest units, which are worth it whatever the path is, as a rule.
    fn singles(&self, of: (&Recording<'_>, &Netlist)) -> Progress {
        let early = if threads::workers() > 1 { EARLY } else { 0 };
        let busiest = Candidates { run: self.run, shape: of.1, path: None }.busiest_units(early);
        let mut progress = Progress::default();
        let first: Vec<Task> = [Task::Path].into_iter().chain(progress.claim(&busiest)).collect();
        let progress = Mutex::new(progress);
        threads::tasks(first, |task, tasks| match task {
            Task::Path => {
                let path = self.critical_path(of.0);
                let singles = Candidates { run: self.run, shape: of.1, path: path.as_ref() }.ideals(self.spec);
                let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
                tasks.add(progress.claim(&singles));
                (progress.path, progress.singles) = (path, singles);
            }
            Task::Time(ideal) => {
                let cycles = self.cycles(of, &ideal.set);
                let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
                if cycles.is_some_and(|cycles| self.saves_much(cycles)) {
                    tasks.add(progress.claim(&ideal.parts));
                }
                progress.cycles.insert(ideal.set, cycles);
            }
        });
        progress.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn critical_path(&self, tape: &Recording<'_>) -> Option<kernel::CriticalPath> {
        tape.critical_path(self.way.shape(self.spec).ok()?, EVENTS, self.groups).ok()?
    }

    /// Whether parts of it are worth a look: those of a memory that saves next to nothing as a whole were as many timings as all else.
    fn saves_much(&self, cycles: u64) -> bool {
        let total = self.run.marked_cycles();
        total.saturating_sub(cycles) > total / PART
    }

    fn limit(&self, ideal: Ideal, cycles: u64) -> Option<Limit> {
        let saved = self.run.marked_cycles().checked_sub(cycles).filter(|saved| *saved > 0)?;
        let Ideal { resource, what, set, .. } = ideal;
        let set = set.into_iter().map(|(key, value)| format!("{key}={value}")).collect();
        Some(Limit { resource, what: what.into(), set, cycles, saved })
    }

    /// Pairs of the first few that save more together.
    fn pairs(&self, of: (&Recording<'_>, &Netlist), timed: &[(Ideal, u64)]) -> Vec<(Ideal, u64)> {
        let first = &timed[..timed.len().min(PAIRED)];
        let all = first.iter().enumerate().flat_map(|(n, a)| first[n + 1..].iter().map(move |b| (a, b)));
        let apart: Vec<_> = all.filter(|((a, _), (b, _))| a.resource != b.resource).collect();
        let both = threads::map(apart.iter().collect(), |((a, _), (b, _)): &(&(Ideal, u64), &(Ideal, u64))| {
            let ideal = together(a, b);
            self.cycles(of, &ideal.set).map(|cycles| (ideal, cycles))
        });
        let total = self.run.marked_cycles();
        let is_more = |cycles: u64, of: [u64; 2]| {
            let alone: u64 = of.into_iter().map(|cycles| total.saturating_sub(cycles)).sum();
            total.saturating_sub(cycles) > alone + total * TOGETHER / 1000
        };
        let found = apart.iter().zip(both);
        found.filter_map(|(((_, a), (_, b)), both)| both.filter(|(_, cycles)| is_more(*cycles, [*a, *b]))).collect()
    }

    /// Cycles of the frames with these parameters; none where they change what the units do, or do not fit.
    fn cycles(&self, (tape, recorded): (&Recording<'_>, &Netlist), set: &[(String, String)]) -> Option<u64> {
        let shape = self.way.shape(&self.given.load::<S>(set).ok()?).ok()?;
        recorded.same_work(&shape).ok()?;
        tape.cycles(shape).ok()?
    }
}
