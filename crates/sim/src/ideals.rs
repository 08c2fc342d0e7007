//! What of a machine can be made ideal, and is worth it for a run.

use basrelief_kernel::{CriticalPath, Netlist, PathSegment, RunReport, UnitReport};
use basrelief_report::model::{FULLY_PIPELINED, UNBOUNDED_FIFO};
use serde::Serialize;
use serde_json::{Map, Value};
use std::cmp::Reverse;

/// Slots that are as good as without bound.
const SLOTS: u32 = 65_536;
/// What is a smaller part of the critical path is not asked for, nor parts of what saves less \[1/PART\].
pub(crate) const PART: u64 = 1000;

/// Something made ideal.
#[derive(Clone, Debug)]
pub(crate) struct Ideal {
    pub(crate) resource: String,
    pub(crate) what: &'static str,
    /// Parameters, as `--set` takes them.
    pub(crate) set: Vec<(String, String)>,
    /// The same, one part of it at a time: worth a look only where the whole saves much.
    pub(crate) parts: Vec<Self>,
}

impl Ideal {
    fn new(resource: &str, what: &'static str, set: impl IntoIterator<Item = (String, String)>) -> Self {
        Self { resource: resource.to_owned(), what, set: set.into_iter().collect(), parts: vec![] }
    }

    fn of_unit(UnitReport { name, .. }: &UnitReport) -> Self {
        Self::new(name, FULLY_PIPELINED, [("ideal.units".to_owned(), name.clone())])
    }
}

/// Where to look: a run, and its critical path if it is known.
///
/// A path binds from below. With something ideal, the stretches that are not spent on it stay as they are, but for those of memories,
/// which may answer others sooner: so what is no part of the path saves nothing, or what little other requests win by it.
pub(crate) struct Candidates<'a> {
    pub(crate) run: &'a RunReport,
    pub(crate) shape: &'a Netlist,
    pub(crate) path: Option<&'a CriticalPath>,
}

impl Candidates<'_> {
    /// All that could limit the run by more than a little, in the order of the block diagram.
    pub(crate) fn ideals(&self, spec: &impl Serialize) -> Vec<Ideal> {
        let config = serde_json::to_value(spec).unwrap_or_default();
        let group = |name: &str| config.get(name).and_then(Value::as_object).cloned().unwrap_or_default();
        let mut all = self.units();
        all.extend(self.fifos(&group("fifo")));
        all.extend(self.memories(&group("memory")));
        all.extend(self.caches(&group("cache")));
        all
    }

    /// Cycles of the critical path that are spent so; all there could be, where it is not known.
    fn spent(&self, is_so: impl Fn(&PathSegment) -> bool) -> u64 {
        let parts = |path: &CriticalPath| path.parts.iter().filter(|part| is_so(&part.stretch)).map(|part| part.cycles).sum();
        self.path.map_or(u64::MAX, parts)
    }

    fn is_much(&self, cycles: u64) -> bool {
        cycles > self.path.map_or(0, |path| path.cycles / PART)
    }

    /// Units whose steps take more than a cycle.
    fn slow_units(&self) -> impl Iterator<Item = &UnitReport> {
        self.run.units.iter().filter(|unit| unit.account.busy > unit.steps)
    }

    fn units(&self) -> Vec<Ideal> {
        let is_on = |name: &str| {
            self.is_much(self.spent(|s| matches!(s, PathSegment::Occupancy(unit) | PathSegment::Latency(unit) if unit == name)))
        };
        self.slow_units().filter(|unit| is_on(&unit.name)).map(Ideal::of_unit).collect()
    }

    /// So many of them, the busiest first, for who does not know the path yet. One that is busy for longer than all frames take goes on
    /// behind them, such as what shows them.
    pub(crate) fn busiest_units(&self, most: usize) -> Vec<Ideal> {
        let total = self.run.marked_cycles();
        let mut units: Vec<&UnitReport> = self.slow_units().filter(|unit| unit.account.busy <= total).collect();
        units.sort_by_key(|unit| Reverse(unit.account.busy));
        units.into_iter().take(most).map(Ideal::of_unit).collect()
    }

    /// FIFOs whose slots somebody waited for. (However short: what was waited for in turn before the slot was free counts, too.)
    fn fifos(&self, group: &Map<String, Value>) -> Vec<Ideal> {
        let full = |name: &String| self.run.fifos.iter().any(|fifo| fifo.name == *name && fifo.high_water() == fifo.depth);
        let is_on = |name: &String| self.spent(|s| matches!(s, PathSegment::Slot(fifo) if fifo == name)) > 0;
        let ideal = |name: &String| Ideal::new(name, UNBOUNDED_FIFO, [(format!("fifo.{name}.depth"), SLOTS.to_string())]);
        group.keys().filter(|name| full(name) && is_on(name)).map(ideal).collect()
    }

    /// Whether much of the path is spent on requests of these clients.
    fn asks(&self, is_client: impl Fn(&str) -> bool) -> bool {
        self.is_much(self.spent(|s| matches!(s, PathSegment::Memory(client, _) if is_client(client))))
    }

    /// Memories that were asked for anything.
    fn memories(&self, group: &Map<String, Value>) -> Vec<Ideal> {
        let mut all = Vec::new();
        for memory in &self.run.memories {
            let is_client = |name: &str| memory.ports.iter().any(|port| port.client == name && port.counts.requests() > 0);
            if let Some(config) = group.get(&memory.name).filter(|_| self.asks(is_client)) {
                all.push(of_memory(&memory.name, config["burst_bytes"].as_u64().unwrap_or_default()));
            }
        }
        all
    }

    /// Caches that did not always hit.
    fn caches(&self, group: &Map<String, Value>) -> Vec<Ideal> {
        let mut all = Vec::new();
        for cache in self.run.caches.iter().filter(|cache| cache.counts.misses + cache.counts.merged > 0) {
            let is_client = |name: &str| self.shape.cache_of(name) == Some(&cache.name);
            if group.contains_key(&cache.name) && self.asks(is_client) {
                let set = [(format!("cache.{}.always_hits", cache.name), "true".into())];
                all.push(Ideal::new(&cache.name, "a hit on every lookup", set));
            }
        }
        all
    }
}

/// What a memory may be without. (Bursts keep their size: by itself a part's would follow from their cycles.)
fn of_memory(name: &str, burst_bytes: u64) -> Ideal {
    let latency: &[(&str, u64)] = &[("cl", 0), ("cwl", 0)];
    let rows: &[(&str, u64)] =
        &[("rcd", 0), ("rp", 0), ("ras", 0), ("rtp", 0), ("wr", 0), ("rrd", 0), ("faw", 0), ("refi", 0), ("rfc", 0)];
    let bus: &[(&str, u64)] = &[("burst_bytes", burst_bytes), ("burst_cycles", 1), ("wtr", 0)];
    let ideal = |what, parts: &[&[(&str, u64)]]| {
        let set = parts.iter().copied().flatten().map(|(key, value)| (format!("memory.{name}.{key}"), value.to_string()));
        Ideal::new(name, what, set)
    };
    Ideal {
        parts: vec![ideal("zero latency", &[latency]), ideal("no row commands", &[rows]), ideal("one cycle per burst", &[bus])],
        ..ideal("zero latency, no row commands, one cycle per burst", &[latency, rows, bus])
    }
}

/// Both.
pub(crate) fn together(a: &Ideal, b: &Ideal) -> Ideal {
    let mut set = a.set.clone();
    for (key, value) in &b.set {
        match set.iter_mut().find(|(other, _)| other == key) {
            // Names of units stand side by side; of a memory's numbers both say the same.
            Some((key, names)) if key == "ideal.units" => *names = format!("{names},{value}"),
            Some(_) => {}
            None => set.push((key.clone(), value.clone())),
        }
    }
    let what = if a.what == b.what { a.what } else { "both relaxed" };
    Ideal::new(&format!("{} and {}", a.resource, b.resource), what, set)
}
