//! What limits a run, measured: each thing that could is made ideal in turn, and the run timed again from its tape.

use crate::machines::MachineSpec;
use crate::run::Way;
use crate::settings::When;
use crate::tape::{Given, bytes_of, timed};
use basrelief_kernel::tape::Reel;
use basrelief_kernel::{RunReport, Shape};
use basrelief_machines::ConfigProblem;
use basrelief_report::model::Limit;
use basrelief_threads as threads;
use serde_json::{Map, Value};

/// Slots that are as good as without bound.
const SLOTS: u32 = 65_536;
/// How many single limits are tried in pairs.
const PAIRED: usize = 3;
/// What two must save together, beyond what each saves alone, to be worth a line \[1/1000 of the cycles\].
const TOGETHER: u64 = 10;

/// The tape of a run that is timed again when it is over.
#[derive(Debug)]
pub(crate) struct Kept {
    reels: Vec<Reel>,
    /// Bytes that are left to keep; none once it was too long.
    left: Option<usize>,
}

impl Kept {
    /// Bytes of a tape that is short: a step takes some five.
    pub(crate) const SHORT: usize = 4 << 20;

    pub(crate) fn new(limits: When) -> Option<Self> {
        let left = match limits {
            When::Never => return None,
            When::IfShort => Self::SHORT,
            When::Always => usize::MAX,
        };
        Some(Self { reels: vec![], left: Some(left) })
    }

    /// Keeps a reel; none at all once there are too many.
    pub(crate) fn keep(&mut self, reel: Reel) {
        self.left = self.left.and_then(|left| left.checked_sub(bytes_of(&reel)));
        if self.left.is_some() {
            self.reels.push(reel);
        } else {
            self.reels = vec![];
        }
    }

    /// All reels; none where there were too many.
    pub(crate) fn reels(&self) -> Option<&[Reel]> {
        self.left.map(|_| self.reels.as_slice())
    }
}

/// Something made ideal.
#[derive(Clone, Debug)]
struct Ideal {
    resource: String,
    what: &'static str,
    /// Parameters, as `--set` takes them.
    set: Vec<(String, String)>,
}

/// The tape of a run that is complete, and the machine that made it.
pub(crate) struct Recorded<'a, S> {
    pub(crate) spec: &'a S,
    /// What the user gave of its parameters: `set` is over these.
    pub(crate) given: &'a Given,
    pub(crate) way: Way,
    pub(crate) reels: &'a [Reel],
    pub(crate) run: &'a RunReport,
}

impl<S: MachineSpec> Recorded<'_, S> {
    /// What could be saved, most first: each alone, and pairs that save more together than each for itself. What saves nothing is left
    /// out.
    ///
    /// # Errors
    /// Parameters that do not fit together; those of a run do.
    pub(crate) fn limits(&self) -> Result<Vec<Limit>, ConfigProblem> {
        let shape = self.way.shape(self.spec)?;
        let singles = self.ideals(&shape);
        let cycles = threads::map(singles.iter().collect(), |ideal: &Ideal| self.cycles(&shape, &ideal.set));
        let mut timed: Vec<(Ideal, u64)> = singles.into_iter().zip(cycles).filter_map(|(i, c)| Some((i, c?))).collect();
        // Stable: of equals the first in the block diagram is first.
        timed.sort_by_key(|(_, cycles)| *cycles);
        let pairs = self.pairs(&shape, &timed);
        let mut limits: Vec<Limit> =
            timed.into_iter().chain(pairs).filter_map(|(ideal, cycles)| self.limit(ideal, cycles)).collect();
        limits.sort_by_key(|limit| limit.cycles);
        Ok(limits)
    }

    fn limit(&self, ideal: Ideal, cycles: u64) -> Option<Limit> {
        let saved = frame_cycles(self.run).checked_sub(cycles).filter(|saved| *saved > 0)?;
        let Ideal { resource, what, set } = ideal;
        let set = set.into_iter().map(|(key, value)| format!("{key}={value}")).collect();
        Some(Limit { resource, what: what.into(), set, cycles, saved })
    }

    /// Pairs of the first few that save more together.
    fn pairs(&self, shape: &Shape, timed: &[(Ideal, u64)]) -> Vec<(Ideal, u64)> {
        let first = &timed[..timed.len().min(PAIRED)];
        let all = first.iter().enumerate().flat_map(|(n, a)| first[n + 1..].iter().map(move |b| (a, b)));
        let apart: Vec<_> = all.filter(|((a, _), (b, _))| a.resource != b.resource).collect();
        let both = threads::map(apart.iter().collect(), |((a, _), (b, _)): &(&(Ideal, u64), &(Ideal, u64))| {
            let ideal = together(a, b);
            self.cycles(shape, &ideal.set).map(|cycles| (ideal, cycles))
        });
        let total = frame_cycles(self.run);
        let is_more = |cycles: u64, of: [u64; 2]| {
            let alone: u64 = of.into_iter().map(|cycles| total.saturating_sub(cycles)).sum();
            total.saturating_sub(cycles) > alone + total * TOGETHER / 1000
        };
        let found = apart.iter().zip(both);
        found.filter_map(|(((_, a), (_, b)), both)| both.filter(|(_, cycles)| is_more(*cycles, [*a, *b]))).collect()
    }

    /// Cycles of the frames with these parameters; none where they change what the units do, or do not fit.
    fn cycles(&self, recorded: &Shape, set: &[(String, String)]) -> Option<u64> {
        let shape = self.way.shape(&self.given.load::<S>(set).ok()?).ok()?;
        recorded.same_work(&shape).ok()?;
        timed(self.reels, shape).ok().map(|report| frame_cycles(&report))
    }

    /// All that could limit the run, in the order of the block diagram. Of FIFOs, memories and caches those are asked for one by one
    /// whose kind saves something when all of it is ideal: mostly two kinds of three do not.
    fn ideals(&self, shape: &Shape) -> Vec<Ideal> {
        let mut all = self.ideal_units();
        let total = frame_cycles(self.run);
        for kind in [self.ideal_fifos(), self.ideal_memories(), self.ideal_caches()] {
            let whole = kind.iter().cloned().reduce(|a, b| together(&a, &b));
            let saves = |whole: &Ideal| self.cycles(shape, &whole.set).map_or(total, |cycles| total.saturating_sub(cycles));
            if whole.is_some_and(|whole| saves(&whole) > total * TOGETHER / 1000) {
                all.extend(kind);
            }
        }
        all
    }

    /// Units whose steps take more than a cycle.
    fn ideal_units(&self) -> Vec<Ideal> {
        let mut all = Vec::new();
        for unit in self.run.units.iter().filter(|unit| unit.account.busy > unit.steps) {
            let set = vec![("ideal.units".to_owned(), unit.name.clone())];
            all.push(Ideal { resource: unit.name.clone(), what: "a cycle per step", set });
        }
        all
    }

    /// A group of parameters.
    fn group(&self, name: &str) -> Map<String, Value> {
        let config = serde_json::to_value(self.spec).unwrap_or_default();
        config.get(name).and_then(Value::as_object).cloned().unwrap_or_default()
    }

    /// FIFOs that were full at some time.
    fn ideal_fifos(&self) -> Vec<Ideal> {
        let mut all = Vec::new();
        for name in self.group("fifo").keys() {
            if self.run.fifos.iter().any(|fifo| fifo.name == *name && fifo.high_water() == fifo.depth) {
                let set = vec![(format!("fifo.{name}.depth"), SLOTS.to_string())];
                all.push(Ideal { resource: name.clone(), what: "slots without bound", set });
            }
        }
        all
    }

    /// Memories that were asked for anything.
    fn ideal_memories(&self) -> Vec<Ideal> {
        let mut all = Vec::new();
        for (name, memory) in &self.group("memory") {
            if self.run.memories.iter().any(|m| m.name == *name && m.ports.iter().any(|port| port.counts.requests() > 0)) {
                all.extend(of_memory(name, memory["burst_bytes"].as_u64().unwrap_or_default()));
            }
        }
        all
    }

    /// Caches that did not always hit.
    fn ideal_caches(&self) -> Vec<Ideal> {
        let mut all = Vec::new();
        for name in self.group("cache").keys() {
            if self.run.caches.iter().any(|c| c.name == *name && c.counts.misses + c.counts.merged > 0) {
                let set = vec![(format!("cache.{name}.always_hits"), "true".into())];
                all.push(Ideal { resource: name.clone(), what: "every look-up hits", set });
            }
        }
        all
    }
}

/// Cycles up to the end of the last frame: what is behind it, the display of what was drawn, limits nothing.
pub(crate) fn frame_cycles(run: &RunReport) -> u64 {
    if run.marks.is_empty() { run.total } else { run.marks.iter().sum() }
}

/// What a memory may be without. (Bursts keep their size: by itself a part's would follow from their cycles.)
fn of_memory(name: &str, burst_bytes: u64) -> [Ideal; 4] {
    let latency: &[(&str, u64)] = &[("cl", 0), ("cwl", 0)];
    let rows: &[(&str, u64)] =
        &[("rcd", 0), ("rp", 0), ("ras", 0), ("rtp", 0), ("wr", 0), ("rrd", 0), ("faw", 0), ("refi", 0), ("rfc", 0)];
    let bus: &[(&str, u64)] = &[("burst_bytes", burst_bytes), ("burst_cycles", 1), ("wtr", 0)];
    let ideal = |what, parts: &[&[(&str, u64)]]| {
        let set =
            parts.iter().copied().flatten().map(|(key, value)| (format!("memory.{name}.{key}"), value.to_string())).collect();
        Ideal { resource: name.to_owned(), what, set }
    };
    [
        ideal("no latency", &[latency]),
        ideal("no row commands", &[rows]),
        ideal("a cycle per burst", &[bus]),
        ideal("no latency, no row commands, a cycle per burst", &[latency, rows, bus]),
    ]
}

/// Both.
fn together(a: &Ideal, b: &Ideal) -> Ideal {
    let mut set = a.set.clone();
    for (key, value) in &b.set {
        match set.iter_mut().find(|(other, _)| other == key) {
            // Names of units stand side by side; of a memory's numbers both say the same.
            Some((key, names)) if key == "ideal.units" => *names = format!("{names},{value}"),
            Some(_) => {}
            None => set.push((key.clone(), value.clone())),
        }
    }
    let what = if a.what == b.what { a.what } else { "both ideal" };
    Ideal { resource: format!("{} and {}", a.resource, b.resource), what, set }
}
