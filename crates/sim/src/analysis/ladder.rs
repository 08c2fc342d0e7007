//! Bottleneck ladder: relaxes the resource that holds most of the critical path, finds the new critical path, and continues with it.
//! Units that are busy equally long are relaxed together. The last rung relaxes everything else.
//!
//! A relaxation of one resource saves nothing if several resources are saturated together. The ladder finds such a group, because it
//! continues from each rung whether the rung saved cycles or not.

use super::analysis_task::PathsAhead;
use super::relaxations::{PART, Relaxation, ResourceKind, Settings, busiest_unit, joined_settings, with_equals};
use super::resimulations::Resimulations;
use basrelief_kernel::CriticalPath;
use basrelief_report::model::RelaxedSet;

/// Maximum number of rungs.
const RUNGS: usize = 16;
/// A resource whose relaxation alone saves this share of the ladder's saving is the bottleneck by itself \[1 / share\].
const ALONE: u64 = 3;
/// A choice saves little if it saves no more than this share of the cycles \[1 / share\]. The ladder ends with everything else if that
/// saves little of the ladder's saving.
const LITTLE: u64 = 20;

/// Relaxed resources, and the cycles with them.
struct Rung<'a> {
    relaxed: Vec<&'a Relaxation>,
    cycles: u64,
    /// True if these are all resources.
    relaxes_all: bool,
}

/// Search for the ladder of a run.
pub(crate) struct LadderSearch<'a> {
    /// Every resource that can be relaxed, in the order of the block diagram.
    pub(crate) relaxations: &'a [Relaxation],
    /// Those of them that are relaxed alone.
    pub(crate) candidates: &'a [Relaxation],
    pub(crate) resimulations: &'a Resimulations<'a>,
    pub(crate) ahead: PathsAhead<'a>,
}

/// Rungs from first to last, and the group of resources that are saturated together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ladder {
    pub(crate) rungs: Vec<RelaxedSet>,
    /// Rung of the ladder that saves half of what the last one saves, without resources that add nothing to it. `None` if one resource
    /// alone saves much of that.
    pub(crate) half: Option<RelaxedSet>,
}

impl Ladder {
    /// Returns the resources that limit the run together; `None` if one of them alone saves much of what the ladder saves.
    pub(crate) fn balanced(&self, total: u64, best_single: u64) -> Option<RelaxedSet> {
        let most = self.rungs.last().map_or(0, |rung| total.saturating_sub(rung.cycles));
        self.half.clone().filter(|half| half.relaxed.len() > 1 && is_far_below(best_single, most))
    }
}

/// True if a resource alone saves little of what the ladder saves.
fn is_far_below(single: u64, ladder: u64) -> bool {
    single < ladder / ALONE
}

impl LadderSearch<'_> {
    /// Climbs from the critical path of the run.
    pub(crate) fn climb(&self, first: &CriticalPath) -> Ladder {
        let total = first.cycles;
        let rungs = self.rungs(first);
        let saved = |rung: &Rung<'_>| total.saturating_sub(rung.cycles);
        let most = rungs.last().map_or(0, saved);
        let half = rungs.iter().find(|rung| 2 * saved(rung) >= most).filter(|_| is_far_below(self.best_single(total), most));
        let half = half.map(|rung| relaxed_set(&self.without_idle(rung, total), total));
        Ladder { rungs: rungs.iter().map(|rung| relaxed_set(rung, total)).collect(), half }
    }

    /// Returns the most cycles that one resource saves. Begins with the last candidate, because another thread begins with the first: in
    /// the same order, one of them waited for each result of the other.
    fn best_single(&self, total: u64) -> u64 {
        let saved = |one: &Relaxation| Some(total.saturating_sub(self.resimulations.cycles(&one.set)?));
        self.candidates.iter().rev().filter_map(saved).max().unwrap_or_default()
    }

    /// Returns the rungs up to the last one that saves cycles.
    fn rungs(&self, first: &CriticalPath) -> Vec<Rung<'_>> {
        let mut rungs: Vec<Rung<'_>> = vec![];
        let mut path = first.clone();
        let everything = settings(self.relaxations);
        let is_enough =
            |all: Option<u64>, cycles: u64| all.is_some_and(|all| cycles <= all + first.cycles.saturating_sub(all) / LITTLE);
        while rungs.len() < RUNGS && !is_enough(self.resimulations.known_cycles(&everything), path.cycles) {
            let relaxed = last_relaxed(&rungs);
            self.ahead.begin_rung(rungs.len());
            let Some((relaxed, next)) = self.next(&path, &relaxed) else { break };
            rungs.push(Rung { relaxed, cycles: next.cycles, relaxes_all: false });
            path = next;
        }
        let all = self.resimulations.cycles(&everything);
        // Until another thread knew the cycles with everything relaxed, the search may have gone too far.
        let enough =
            std::iter::once(first.cycles).chain(rungs.iter().map(|rung| rung.cycles)).position(|cycles| is_enough(all, cycles));
        rungs.truncate(enough.unwrap_or(RUNGS));
        if let Some(cycles) = all.filter(|_| !rungs.is_empty()) {
            let relaxed = last_relaxed(&rungs);
            let rest = self.not_in(&relaxed).collect();
            rungs.push(Rung { relaxed: [relaxed, rest].concat(), cycles, relaxes_all: true });
        }
        let least = rungs.iter().map(|rung| rung.cycles).min().filter(|least| *least < first.cycles);
        let last = rungs.iter().position(|rung| Some(rung.cycles) == least);
        rungs.truncate(last.map_or(0, |last| last + 1));
        rungs
    }

    /// Relaxes the resource with most of the path and its equals. If that saves little, it tries all FIFOs whose slots the path waits for
    /// instead, and takes the choice with fewer cycles. A wait for a slot is short on the path, but it may cause long latencies there.
    ///
    /// No run is shorter than the busy cycles of a unit that is not relaxed. So FIFOs are not tried if they could save little more.
    fn next<'a>(&'a self, path: &CriticalPath, relaxed: &[&'a Relaxation]) -> Option<(Vec<&'a Relaxation>, CriticalPath)> {
        let together = |more: Vec<&'a Relaxation>| (!more.is_empty()).then(|| [relaxed, &more].concat());
        let tried = |all: Vec<&'a Relaxation>| self.resimulations.path(&settings(all.iter().copied())).map(|path| (all, path));
        let largest = together(self.largest(path, relaxed));
        let busiest = busiest_unit(self.not_in(relaxed), path.cycles);
        if let Some(largest) = &largest {
            self.guess_next(path, largest);
        }
        let first = largest.and_then(tried);
        let bound = busiest.map_or(0, |unit| unit.busy + unit.busy / LITTLE);
        let enough = bound.max(path.cycles - path.cycles / LITTLE);
        if first.as_ref().is_some_and(|(_, path)| path.cycles <= enough) {
            return first;
        }
        let fifos = together(self.waited_fifos(path, relaxed)).and_then(tried);
        first.into_iter().chain(fifos).min_by_key(|(_, path)| path.cycles)
    }

    /// Returns the resource other than a FIFO that holds most of the path, with its equals; nothing if it holds next to nothing.
    fn largest<'a>(&'a self, path: &CriticalPath, relaxed: &[&Relaxation]) -> Vec<&'a Relaxation> {
        let mut largest: Option<(&Relaxation, u64)> = None;
        for other in self.not_in(relaxed).filter(|new| new.kind != ResourceKind::Fifo) {
            let cycles = other.path_cycles(path);
            if cycles > largest.map_or(path.cycles / PART, |(_, most)| most) {
                largest = Some((other, cycles));
            }
        }
        largest.map_or(vec![], |(largest, _)| with_equals(largest, self.not_in(relaxed)))
    }

    /// Returns the FIFOs whose slots the path waits for.
    fn waited_fifos<'a>(&'a self, path: &CriticalPath, relaxed: &[&Relaxation]) -> Vec<&'a Relaxation> {
        self.not_in(relaxed).filter(|new| new.kind == ResourceKind::Fifo && new.path_cycles(path) > 0).collect()
    }

    /// Returns the relaxations that are not among these.
    fn not_in<'a>(&'a self, relaxed: &[&Relaxation]) -> impl Iterator<Item = &'a Relaxation> {
        self.relaxations.iter().filter(|new| !relaxed.iter().any(|old| std::ptr::eq(*old, *new)))
    }

    /// Guesses what the rung after this one relaxes: the busiest unit, if it is saturated too. Of saturated units, one hides the others.
    fn guess_next(&self, path: &CriticalPath, relaxed: &[&Relaxation]) {
        let busiest = busiest_unit(self.not_in(relaxed), path.cycles);
        if let Some(busiest) = busiest.filter(|new| new.is_saturated(path.cycles)) {
            self.ahead.guess(settings(relaxed.iter().copied().chain(with_equals(busiest, self.not_in(relaxed)))));
        }
    }

    /// Returns the rung without the resources that add no more than 1/[`PART`] of the cycles to its saving.
    fn without_idle<'a>(&self, rung: &Rung<'a>, total: u64) -> Rung<'a> {
        let mut needed = Rung { relaxed: rung.relaxed.clone(), ..*rung };
        for resource in &rung.relaxed {
            let rest: Vec<&Relaxation> = needed.relaxed.iter().copied().filter(|of| !std::ptr::eq(*of, *resource)).collect();
            let cycles = if rest.is_empty() { Some(total) } else { self.resimulations.cycles(&settings(rest.iter().copied())) };
            if let Some(cycles) = cycles.filter(|cycles| *cycles <= rung.cycles + total / PART) {
                needed = Rung { relaxed: rest, cycles, relaxes_all: false };
            }
        }
        needed
    }
}

/// Returns what the last rung relaxes; nothing before the first.
fn last_relaxed<'a>(rungs: &[Rung<'a>]) -> Vec<&'a Relaxation> {
    rungs.last().map_or(vec![], |rung| rung.relaxed.clone())
}

/// Returns the settings that relax all of these.
pub(crate) fn settings<'a>(relaxed: impl IntoIterator<Item = &'a Relaxation>) -> Settings {
    joined_settings(relaxed.into_iter().map(|of| &of.set))
}

fn relaxed_set(rung: &Rung<'_>, total: u64) -> RelaxedSet {
    RelaxedSet {
        relaxed: rung.relaxed.iter().map(|of| of.id()).collect(),
        set: settings(rung.relaxed.iter().copied()).into_iter().map(|(key, value)| format!("{key}={value}")).collect(),
        cycles: rung.cycles,
        saved: basrelief_report::number::round6(1.0 - rung.cycles as f64 / total.max(1) as f64),
        relaxes_all: rung.relaxes_all,
    }
}
