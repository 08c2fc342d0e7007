//! Relaxations that bottleneck analysis tries: a resource of the machine made ideal.

use basrelief_kernel::{CriticalPath, Netlist, PathSegment, RunReport, UnitReport};
use basrelief_report::model::{FULLY_PIPELINED, UNBOUNDED_FIFO};
use serde::Serialize;
use serde_json::{Map, Value};
use std::cmp::Reverse;

/// Depth of a FIFO that is practically unbounded \[slots\].
const SLOTS: u32 = 65_536;
/// Threshold: relaxations that could save less than 1/PART of the critical path are not tried.
pub(crate) const PART: u64 = 1000;

/// A resource made ideal.
#[derive(Clone, Debug)]
pub(crate) struct Relaxation {
    pub(crate) resource: String,
    pub(crate) what: &'static str,
    /// Settings, as in `--set`.
    pub(crate) set: Vec<(String, String)>,
    /// Relaxations of single aspects. They are tried only if the whole relaxation saves much.
    pub(crate) parts: Vec<Self>,
}

impl Relaxation {
    fn new(resource: &str, what: &'static str, set: impl IntoIterator<Item = (String, String)>) -> Self {
        Self { resource: resource.to_owned(), what, set: set.into_iter().collect(), parts: vec![] }
    }

    fn of_unit(UnitReport { name, .. }: &UnitReport) -> Self {
        Self::new(name, FULLY_PIPELINED, [("ideal.units".to_owned(), name.clone())])
    }
}

/// Candidates for relaxation in a run.
///
/// The critical path is a lower bound of the time. A relaxation shortens only the segments of its resource, except that a memory may
/// serve other requests sooner. Therefore a resource that is not on the path saves nothing, or little.
/// `path` is `None` while the path is not known.
pub(crate) struct RelaxationCandidates<'a> {
    pub(crate) run: &'a RunReport,
    pub(crate) netlist: &'a Netlist,
    pub(crate) path: Option<&'a CriticalPath>,
}

impl RelaxationCandidates<'_> {
    /// Returns all relaxations that could save more than a little, in the order of the block diagram.
    pub(crate) fn relaxations(&self, spec: &impl Serialize) -> Vec<Relaxation> {
        let config = serde_json::to_value(spec).unwrap_or_default();
        let group = |name: &str| config.get(name).and_then(Value::as_object).cloned().unwrap_or_default();
        let mut all = self.units();
        all.extend(self.fifos(&group("fifo")));
        all.extend(self.memories(&group("memory")));
        all.extend(self.caches(&group("cache")));
        all
    }

    /// Returns the cycles of matching segments of the critical path; the maximum if the path is not known.
    fn path_cycles(&self, is_so: impl Fn(&PathSegment) -> bool) -> u64 {
        let parts = |path: &CriticalPath| path.parts.iter().filter(|part| is_so(&part.stretch)).map(|part| part.cycles).sum();
        self.path.map_or(u64::MAX, parts)
    }

    fn is_much(&self, cycles: u64) -> bool {
        cycles > self.path.map_or(0, |path| path.cycles / PART)
    }

    /// Units with an initiation interval above 1.
    fn slow_units(&self) -> impl Iterator<Item = &UnitReport> {
        self.run.units.iter().filter(|unit| unit.account.busy > unit.steps)
    }

    fn units(&self) -> Vec<Relaxation> {
        let is_on = |name: &str| {
            self.is_much(
                self.path_cycles(|s| matches!(s, PathSegment::Occupancy(unit) | PathSegment::Latency(unit) if unit == name)),
            )
        };
        self.slow_units().filter(|unit| is_on(&unit.name)).map(Relaxation::of_unit).collect()
    }

    /// Returns the `most` busiest units, the busiest first, before the path is known. Excludes units that are busy for longer than all
    /// frames take, such as the display, because they continue after the frames.
    pub(crate) fn busiest_units(&self, most: usize) -> Vec<Relaxation> {
        let total = self.run.marked_cycles();
        let mut units: Vec<&UnitReport> = self.slow_units().filter(|unit| unit.account.busy <= total).collect();
        units.sort_by_key(|unit| Reverse(unit.account.busy));
        units.into_iter().take(most).map(Relaxation::of_unit).collect()
    }

    /// FIFOs that blocked their producer on the critical path. There is no threshold, because other waits may hide behind a short one.
    fn fifos(&self, group: &Map<String, Value>) -> Vec<Relaxation> {
        let full = |name: &String| self.run.fifos.iter().any(|fifo| fifo.name == *name && fifo.high_water() == fifo.depth);
        let is_on = |name: &String| self.path_cycles(|s| matches!(s, PathSegment::Slot(fifo) if fifo == name)) > 0;
        let relaxed = |name: &String| Relaxation::new(name, UNBOUNDED_FIFO, [(format!("fifo.{name}.depth"), SLOTS.to_string())]);
        group.keys().filter(|name| full(name) && is_on(name)).map(relaxed).collect()
    }

    /// True if requests of these clients take much of the path.
    fn is_on_path(&self, is_client: impl Fn(&str) -> bool) -> bool {
        self.is_much(self.path_cycles(|s| matches!(s, PathSegment::Memory(client, _) if is_client(client))))
    }

    /// Memories with at least one request.
    fn memories(&self, group: &Map<String, Value>) -> Vec<Relaxation> {
        let mut all = Vec::new();
        for memory in &self.run.memories {
            let is_client = |name: &str| memory.ports.iter().any(|port| port.client == name && port.counts.requests() > 0);
            if let Some(config) = group.get(&memory.name).filter(|_| self.is_on_path(is_client)) {
                all.push(of_memory(&memory.name, config["burst_bytes"].as_u64().unwrap_or_default()));
            }
        }
        all
    }

    /// Caches with at least one miss.
    fn caches(&self, group: &Map<String, Value>) -> Vec<Relaxation> {
        let mut all = Vec::new();
        for cache in self.run.caches.iter().filter(|cache| cache.counts.misses + cache.counts.merged > 0) {
            let is_client = |name: &str| self.netlist.cache_of(name) == Some(&cache.name);
            if group.contains_key(&cache.name) && self.is_on_path(is_client) {
                let set = [(format!("cache.{}.always_hits", cache.name), "true".into())];
                all.push(Relaxation::new(&cache.name, "a hit on every lookup", set));
            }
        }
        all
    }
}

/// Relaxations of a memory. The burst size is set explicitly, because otherwise it would follow from the cycles of a burst.
fn of_memory(name: &str, burst_bytes: u64) -> Relaxation {
    let latency: &[(&str, u64)] = &[("cl", 0), ("cwl", 0)];
    let rows: &[(&str, u64)] =
        &[("rcd", 0), ("rp", 0), ("ras", 0), ("rtp", 0), ("wr", 0), ("rrd", 0), ("faw", 0), ("refi", 0), ("rfc", 0)];
    let bus: &[(&str, u64)] = &[("burst_bytes", burst_bytes), ("burst_cycles", 1), ("wtr", 0)];
    let relaxed = |what, parts: &[&[(&str, u64)]]| {
        let set = parts.iter().copied().flatten().map(|(key, value)| (format!("memory.{name}.{key}"), value.to_string()));
        Relaxation::new(name, what, set)
    };
    Relaxation {
        parts: vec![
            relaxed("zero latency", &[latency]),
            relaxed("no row commands", &[rows]),
            relaxed("one cycle per burst", &[bus]),
        ],
        ..relaxed("zero latency, no row commands, one cycle per burst", &[latency, rows, bus])
    }
}

/// Combines two relaxations.
pub(crate) fn combined(a: &Relaxation, b: &Relaxation) -> Relaxation {
    let mut set = a.set.clone();
    for (key, value) in &b.set {
        match set.iter_mut().find(|(other, _)| other == key) {
            // Names of units are joined. For a memory, both relaxations have the same value.
            Some((key, names)) if key == "ideal.units" => *names = format!("{names},{value}"),
            Some(_) => {}
            None => set.push((key.clone(), value.clone())),
        }
    }
    let what = if a.what == b.what { a.what } else { "both relaxed" };
    Relaxation::new(&format!("{} and {}", a.resource, b.resource), what, set)
}
