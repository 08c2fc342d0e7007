//! Relaxations that bottleneck analysis tries: a resource of the machine made ideal.

use basrelief_kernel::{CriticalPath, Netlist, PathSegment, RequestPhase, RunReport, UnitReport};
use basrelief_machines::MachineSpec;
use basrelief_parameters::to_json;
use basrelief_report::model::{ALWAYS_HITS, FULLY_PIPELINED, IDEAL_MEMORY, NO_DISPLAY, UNBOUNDED_FIFO};
use serde_json::{Map, Value};

/// Depth of a FIFO that is practically unbounded \[slots\].
const SLOTS: u32 = 65_536;
/// Threshold: relaxations that could save less than 1/PART of the critical path are not tried.
pub(crate) const PART: u64 = 1000;
/// Units are busy equally long if they differ by this share at most \[1 / share\].
const EQUAL: u64 = 10;
/// Parameter that lists the fully pipelined units.
const IDEAL_UNITS: &str = "ideal.units";

/// Name of the display, as in its group of parameters.
pub(crate) const DISPLAY: &str = "display";

/// Settings, as in `--set`.
pub(crate) type Settings = Vec<(String, String)>;

/// Kind of a resource. Memories and caches have clients.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ResourceKind {
    Unit,
    Fifo,
    Memory(Vec<String>),
    Cache(Vec<String>),
    Display,
}

/// A resource made ideal.
#[derive(Clone, Debug)]
pub(crate) struct Relaxation {
    pub(crate) resource: String,
    pub(crate) kind: ResourceKind,
    pub(crate) what: &'static str,
    pub(crate) set: Settings,
    /// Busy cycles of a unit; 0 for other resources.
    pub(crate) busy: u64,
    /// Relaxations of single aspects. They are tried only if the whole relaxation saves much.
    pub(crate) parts: Vec<Self>,
}

impl Relaxation {
    fn new(resource: &str, kind: ResourceKind, what: &'static str, set: impl IntoIterator<Item = (String, String)>) -> Self {
        Self { resource: resource.to_owned(), kind, what, set: set.into_iter().collect(), busy: 0, parts: vec![] }
    }

    /// Name of the resource among all kinds: a unit by its name, others by their group of parameters.
    pub(crate) fn id(&self) -> String {
        let group = match self.kind {
            ResourceKind::Unit | ResourceKind::Display => "",
            ResourceKind::Fifo => "fifo.",
            ResourceKind::Memory(_) => "memory.",
            ResourceKind::Cache(_) => "cache.",
        };
        format!("{group}{}", self.resource)
    }

    /// True for a unit that is busy for most of these cycles. If a path is so long, this unit is likely to hold it.
    pub(crate) fn is_saturated(&self, cycles: u64) -> bool {
        self.busy > cycles / 4 * 3
    }

    /// Returns the cycles of the critical path that this resource holds.
    pub(crate) fn path_cycles(&self, path: &CriticalPath) -> u64 {
        path.parts.iter().filter(|part| self.holds(&part.stretch)).map(|part| part.cycles).sum()
    }

    /// True if a segment of a critical path belongs to this resource. A wait in a cache belongs to the cache and to its memory. A wait
    /// for the display belongs to no memory.
    fn holds(&self, segment: &PathSegment) -> bool {
        match (&self.kind, segment) {
            (ResourceKind::Unit, PathSegment::Occupancy(unit) | PathSegment::Latency(unit)) => *unit == self.resource,
            (ResourceKind::Fifo, PathSegment::Slot(fifo)) => *fifo == self.resource,
            (kind, PathSegment::Memory(_, RequestPhase::Periodic)) => *kind == ResourceKind::Display,
            (ResourceKind::Memory(clients) | ResourceKind::Cache(clients), PathSegment::Memory(client, _)) => {
                clients.contains(client)
            }
            _ => false,
        }
    }
}

/// Loads the parameters of a run with more settings; `None` if they do not fit together.
type Load<'a, S> = dyn Fn(&[(String, String)]) -> Option<S> + Sync + 'a;

/// Relaxations of the resources of a machine that a run used.
pub(crate) struct RelaxationCandidates<'a, S> {
    pub(crate) run: &'a RunReport,
    pub(crate) netlist: &'a Netlist,
    pub(crate) spec: &'a S,
    /// Loads the parameters of the run with more settings.
    pub(crate) load: &'a Load<'a, S>,
}

impl<S: MachineSpec> RelaxationCandidates<'_, S> {
    /// Returns the relaxation of every resource that the run used, in the order of the block diagram.
    pub(crate) fn all(&self) -> Vec<Relaxation> {
        let config = to_json(self.spec).unwrap_or_default();
        let group = |name: &str| config.get(name).and_then(Value::as_object).cloned().unwrap_or_default();
        let mut all: Vec<Relaxation> = self.slow_units().map(|unit| self.of_unit(unit)).collect();
        all.extend(group("fifo").keys().map(|name| {
            Relaxation::new(name, ResourceKind::Fifo, UNBOUNDED_FIFO, [(format!("fifo.{name}.depth"), SLOTS.to_string())])
        }));
        all.extend(self.memories(&group("memory")));
        all.extend(self.caches(&group("cache")));
        all.extend(self.netlist.waits_for_periodic().then(|| {
            let set = [("display.enabled".to_owned(), "false".to_owned())];
            Relaxation::new(DISPLAY, ResourceKind::Display, NO_DISPLAY, set)
        }));
        all
    }

    /// Returns those of all relaxations that could save more than a little.
    ///
    /// The critical path is a lower bound of the time. A relaxation shortens only the segments of its resource, except that a memory
    /// may serve other requests sooner. Therefore a resource that is not on the path saves nothing, or little. Without a path every
    /// relaxation counts. FIFOs have no threshold, because other waits may hide behind a short one.
    pub(crate) fn on_path(&self, all: &[Relaxation], path: Option<&CriticalPath>) -> Vec<Relaxation> {
        let full = |name: &str| self.run.fifos.iter().any(|fifo| fifo.name == name && fifo.high_water() == fifo.depth);
        let could_save = |relaxation: &&Relaxation| {
            let cycles = path.map_or(u64::MAX, |path| relaxation.path_cycles(path));
            match relaxation.kind {
                ResourceKind::Fifo => cycles > 0 && full(&relaxation.resource),
                _ => cycles > path.map_or(0, |path| path.cycles / PART),
            }
        };
        all.iter().filter(could_save).cloned().collect()
    }

    /// Units with an initiation interval above 1.
    fn slow_units(&self) -> impl Iterator<Item = &UnitReport> {
        self.run.units.iter().filter(|unit| unit.account.busy > unit.steps)
    }

    /// Units that the user made ideal remain so.
    fn of_unit(&self, UnitReport { name, account, .. }: &UnitReport) -> Relaxation {
        let config = to_json(self.spec).unwrap_or_default();
        let ideal = config["ideal"]["units"].as_str().unwrap_or_default().to_owned();
        let set = joined_settings([&vec![(IDEAL_UNITS.to_owned(), ideal)], &vec![(IDEAL_UNITS.to_owned(), name.clone())]]);
        Relaxation { busy: account.busy, ..Relaxation::new(name, ResourceKind::Unit, FULLY_PIPELINED, set) }
    }

    /// Memories with at least one request.
    fn memories(&self, group: &Map<String, Value>) -> Vec<Relaxation> {
        let used = |memory: &str| {
            let ports = self.run.memories.iter().filter(|of| of.name == memory).flat_map(|memory| &memory.ports);
            ports.filter(|port| port.counts.requests() > 0).map(|port| port.client.clone()).collect::<Vec<_>>()
        };
        let all = self.run.memories.iter().filter_map(|memory| Some((&memory.name, group.get(&memory.name)?)));
        let used = all.map(|(name, config)| (name, config, used(name))).filter(|(.., clients)| !clients.is_empty());
        used.filter_map(|(name, config, clients)| self.of_memory(name, config, clients)).collect()
    }

    /// Relaxes a memory to the part `ideal`, as the presets of ideal machines do, and tries three groups of its timings alone.
    fn of_memory(&self, name: &str, config: &Value, clients: Vec<String>) -> Option<Relaxation> {
        let latency: &[(&str, u64)] = &[("cl", 0), ("cwl", 0)];
        let rows: &[(&str, u64)] =
            &[("rcd", 0), ("rp", 0), ("ras", 0), ("rtp", 0), ("wr", 0), ("rrd", 0), ("faw", 0), ("refi", 0), ("rfc", 0)];
        // The burst size is set explicitly, because otherwise it would follow from the cycles of a burst.
        let burst_bytes = config["burst_bytes"].as_u64().unwrap_or_default();
        let bus: &[(&str, u64)] = &[("burst_bytes", burst_bytes), ("burst_cycles", 1), ("wtr", 0)];
        let kind = ResourceKind::Memory(clients);
        let relaxed = |what, part: &[(&str, u64)]| {
            let set = part.iter().map(|(key, value)| (format!("memory.{name}.{key}"), value.to_string()));
            Relaxation::new(name, kind.clone(), what, set)
        };
        let parts = vec![relaxed("zero latency", latency), relaxed("no row commands", rows), relaxed("one cycle per burst", bus)];
        Some(Relaxation { parts, ..Relaxation::new(name, kind.clone(), IDEAL_MEMORY, self.ideal_memory(name)?) })
    }

    /// Returns the settings that make a memory ideal: its part, and every value that the user's settings would keep.
    fn ideal_memory(&self, name: &str) -> Option<Settings> {
        let part = (format!("memory.{name}.part"), "ideal".to_owned());
        let memory = |spec: &S| to_json(spec).ok().map(|config| config["memory"][name].clone());
        let ideal: S = basrelief_parameters::load("", &[(part.0.as_str(), part.1.as_str())]).ok()?;
        let (ideal, here) = (memory(&ideal)?, memory(&(self.load)(std::slice::from_ref(&part))?)?);
        let kept = ideal.as_object()?.iter().filter(|(key, value)| here.get(key.as_str()) != Some(value));
        let kept = kept.map(|(key, value)| (format!("memory.{name}.{key}"), value.to_string()));
        Some(std::iter::once(part.clone()).chain(kept).collect())
    }

    /// Caches with at least one miss.
    fn caches(&self, group: &Map<String, Value>) -> Vec<Relaxation> {
        let clients = |cache: &str| {
            let ports = self.run.memories.iter().flat_map(|memory| &memory.ports).map(|port| &port.client);
            ports.filter(|client| self.netlist.cache_of(client).is_some_and(|of| of == cache)).cloned().collect()
        };
        let missed = self.run.caches.iter().filter(|cache| cache.counts.misses + cache.counts.merged > 0);
        let relaxed = |name: &String| {
            let set = [(format!("cache.{name}.always_hits"), "true".to_owned())];
            Relaxation::new(name, ResourceKind::Cache(clients(name)), ALWAYS_HITS, set)
        };
        missed.map(|cache| &cache.name).filter(|name| group.contains_key(name.as_str())).map(relaxed).collect()
    }
}

/// Returns the busiest unit among these. Excludes units that are busy for longer than `cycles`, such as the display, because they
/// continue after the frames.
pub(crate) fn busiest_unit<'a>(among: impl IntoIterator<Item = &'a Relaxation>, cycles: u64) -> Option<&'a Relaxation> {
    among.into_iter().filter(|unit| unit.busy > 0 && unit.busy <= cycles).max_by_key(|unit| unit.busy)
}

/// Returns a resource, and the units among these that are busy about as long as it, in their order. Such units hide each other: the
/// relaxation of one alone saves nothing.
pub(crate) fn with_equals<'a>(resource: &'a Relaxation, among: impl Iterator<Item = &'a Relaxation>) -> Vec<&'a Relaxation> {
    let is_equal = |other: &Relaxation| other.busy > 0 && other.busy.abs_diff(resource.busy) <= resource.busy / EQUAL;
    among.filter(|other| std::ptr::eq(*other, resource) || is_equal(other)).collect()
}

/// Returns the settings of several relaxations together. Lists of ideal units are joined.
pub(crate) fn joined_settings<'a>(sets: impl IntoIterator<Item = &'a Settings>) -> Settings {
    let mut joined: Settings = vec![];
    for (key, value) in sets.into_iter().flatten() {
        match joined.iter_mut().find(|(other, _)| other == key) {
            Some((key, names)) if key == IDEAL_UNITS => {
                let new = value.split(',').filter(|name| !names.split(',').any(|known| known == *name)).collect::<Vec<_>>();
                *names = names.split(',').chain(new).filter(|name| !name.is_empty()).collect::<Vec<_>>().join(",");
            }
            Some((_, old)) => old.clone_from(value),
            None => joined.push((key.clone(), value.clone())),
        }
    }
    joined
}
