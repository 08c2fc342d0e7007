//! Builds the report of a run.

use crate::derived::derive;
use crate::json::SCHEMA;
use crate::model::{
    Bus, Cache, Channel, Client, Cycles, Display, Fifo, Figure, Hardware, Input, Legend, Memory, MemoryBytes, Outcome,
    OutcomeKind, Picture, PictureQuality, Report, Size, Unit,
};
use crate::work::work;
use basrelief_kernel as kernel;
use basrelief_signals::Camera;
use indexmap::IndexMap;

/// Parts of a report that the kernel does not know.
#[derive(Clone, Debug)]
pub struct ReportContext {
    /// Identity of the build of the simulator.
    pub build: String,
    /// The machine, as `--machine` names it.
    pub machine: String,
    /// Input of the run.
    pub input: Input,
    /// Configuration of the machine with all defaults. `clock.hz` converts cycles into seconds;
    /// `memory.<name>.burst_cycles` converts bursts into bus cycles.
    pub config: serde_json::Value,
    /// View of the last frame.
    pub camera: Camera,
    /// Size of the pictures.
    pub size: Size,
    /// Reference numerals of the patent, by unit.
    pub numerals: IndexMap<String, u32>,
    /// Hardware of the machine.
    pub hardware: Vec<Hardware>,
    /// Counts of the machine. Cycles and bytes are divided by its [`work`].
    pub figures: IndexMap<String, Figure>,
    /// Unit of measure and meaning of the figures.
    pub legend: IndexMap<String, Legend>,
    /// Quality against the reference images.
    pub quality: Option<PictureQuality>,
    /// Images in order of time, the final image last.
    pub image: Vec<Picture>,
    /// Warnings, one sentence each.
    pub warnings: Vec<String>,
}

impl Report {
    /// Returns the report of a timed run.
    pub fn timed(context: ReportContext, run: &kernel::RunReport) -> Self {
        let numerals = context.numerals.clone();
        let mut report = Self::functional(context, &run.outcome);
        report.cycles = Some(cycles(run));
        report.units = Some(run.units.iter().map(|u| (u.name.clone(), unit(u, &run.fifos, &numerals))).collect());
        report.fifos = Some(run.fifos.iter().map(|f| (f.name.clone(), fifo(f))).collect());
        report.memories = Some(run.memories.iter().map(|m| (m.name.clone(), memory(m))).collect());
        report.display = display(&report, run);
        report.caches = Some(run.caches.iter().map(|c| (c.name.clone(), cache(&c.counts))).collect());
        report.count_bytes();
        report.derived = derive(&report);
        report
    }

    /// Returns the report of a functional run: the same steps, without cycles and traffic.
    pub fn functional(context: ReportContext, outcome: &kernel::Outcome) -> Self {
        Self {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            build: context.build,
            machine: context.machine,
            input: context.input,
            outcome: outcome.into(),
            config: context.config,
            camera: context.camera,
            size: context.size,
            cycles: None,
            units: None,
            fifos: None,
            memories: None,
            display: None,
            bytes: None,
            caches: None,
            bottlenecks: None,
            critical_path: None,
            costs: None,
            sensitivity: None,
            hardware: context.hardware,
            figures: context.figures,
            legend: context.legend,
            quality: context.quality,
            image: context.image,
            derived: IndexMap::new(),
            warnings: context.warnings,
            host: None,
        }
    }

    /// Adds the host's figures: seconds from start to end, and from the first to the last simulated step.
    #[must_use]
    pub fn with_host(mut self, wall_s: f64, simulate_s: f64) -> Self {
        let rate = |n: f64| if simulate_s > 0.0 { n / simulate_s } else { 0.0 };
        self.host = Some(crate::model::Host {
            path: None,
            wall_s,
            simulate_s,
            cycles_per_s: self.cycles.as_ref().map(|c| rate(c.total as f64)),
            fragments_per_s: rate(work(&self).count as f64),
        });
        self
    }
}

impl From<&kernel::Outcome> for Outcome {
    fn from(outcome: &kernel::Outcome) -> Self {
        let (kind, message) = match outcome {
            kernel::Outcome::Complete => (OutcomeKind::Complete, None),
            kernel::Outcome::Deadlock(deadlock) => (OutcomeKind::Deadlock, Some(deadlock.to_string())),
            kernel::Outcome::Limit => (OutcomeKind::Limit, None),
            kernel::Outcome::Stopped => (OutcomeKind::Stopped, None),
            kernel::Outcome::Fault(text) => (OutcomeKind::Fault, Some(text.clone())),
        };
        Self { kind, message }
    }
}

fn cycles(run: &kernel::RunReport) -> Cycles {
    let drain = run.total.saturating_sub(run.marks.iter().sum());
    Cycles { total: run.total, frames: run.marks.clone(), drain }
}

fn unit(unit: &kernel::UnitReport, fifos: &[kernel::FifoReport], numerals: &IndexMap<String, u32>) -> Unit {
    let named = |names: &[String], counts: &[u64]| names.iter().cloned().zip(counts.iter().copied()).collect();
    let ends = if unit.outputs.is_empty() { &unit.inputs } else { &unit.outputs };
    Unit {
        numeral: numerals.get(&unit.name).copied(),
        steps: unit.steps,
        tokens: fifos.iter().filter(|f| ends.contains(&f.name)).map(|f| f.tokens).sum(),
        busy: unit.account.busy,
        starved: named(&unit.inputs, &unit.account.starved),
        blocked: named(&unit.outputs, &unit.account.blocked),
        memory: named(&unit.clients, &unit.account.memory),
        done: unit.account.done,
    }
}

fn fifo(fifo: &kernel::FifoReport) -> Fifo {
    Fifo {
        depth: fifo.depth as u64,
        tokens: fifo.tokens,
        high_water: fifo.high_water() as u64,
        histogram: fifo.histogram.clone(),
    }
}

fn memory(memory: &kernel::MemoryReport) -> Memory {
    Memory {
        clients: memory.ports.iter().map(|p| (p.client.clone(), client(&p.counts))).collect(),
        channels: memory.channels.iter().map(channel).collect(),
        bus: Bus { interval: memory.bus.interval(), busy: memory.bus.busy().to_vec() },
        bytes: MemoryBytes::default(),
    }
}

/// Name of the client that flips.
const FLIP: &str = "flip";

/// Returns the figures of the display: of the periodic client of a memory, and of the flips.
fn display(report: &Report, run: &kernel::RunReport) -> Option<Display> {
    let find = |memory: &'_ kernel::MemoryReport| memory.ports.iter().position(|port| port.periodic.is_some());
    let (memory, place) = run.memories.iter().find_map(|memory| Some((memory, find(memory)?)))?;
    let scan_out = memory.ports.get(place)?;
    let kernel::PeriodicCounts { late, flips } = scan_out.periodic?;
    let flip = memory.ports.iter().find(|port| port.client == FLIP);
    let burst_cycles =
        report.config.pointer(&format!("/memory/{}/burst_cycles", memory.name)).and_then(serde_json::Value::as_u64);
    Some(Display {
        memory: memory.name.clone(),
        flips: flip.map_or(0, |port| port.counts.without_data),
        pictures_shown: flips.shown,
        flip_wait: flips.wait,
        longest_flip_wait: flips.longest_wait,
        reads: scan_out.counts.reads,
        underruns: late,
        bus_cycles: scan_out.counts.rows.bursts() * burst_cycles.unwrap_or(0),
    })
}

fn channel(counts: &kernel::ChannelCounts) -> Channel {
    Channel {
        row_hits: counts.rows.hits,
        row_closed: counts.rows.closed,
        row_conflicts: counts.rows.conflicts,
        turn_arounds: counts.turn_arounds,
        refreshes: counts.refreshes,
        bus_busy: counts.bus_busy,
        queued: counts.queued,
    }
}

fn client(counts: &kernel::PortCounts) -> Client {
    Client {
        reads: counts.reads,
        writes: counts.writes,
        read_bytes: counts.read_bytes,
        write_bytes: counts.write_bytes,
        bursts: counts.rows.bursts(),
        moved_bytes: 0,
        row_hits: counts.rows.hits,
        row_closed: counts.rows.closed,
        row_conflicts: counts.rows.conflicts,
        queue_wait: counts.queue_wait,
        latency_sum: counts.latencies.total,
        latency_95: counts.latencies.bound(95),
        latency: counts.latencies.used_classes().to_vec(),
    }
}

fn cache(counts: &kernel::CacheCounts) -> Cache {
    Cache {
        look_ups: counts.hits + counts.misses + counts.merged,
        hits: counts.hits,
        misses: counts.misses,
        merged: counts.merged,
    }
}

#[cfg(test)]
mod tests {
    use crate::model::OutcomeKind;
    use crate::samples;

    #[test]
    fn every_cycle_of_every_unit_is_accounted_for() {
        let report = samples::simulated();
        let total = report.cycles.as_ref().unwrap().total;
        assert_eq!(report.outcome.kind, OutcomeKind::Complete);
        for (name, u) in report.units.as_ref().unwrap() {
            let waits = u.starved.values().chain(u.blocked.values()).chain(u.memory.values()).sum::<u64>();
            assert_eq!(u.busy + u.done + waits, total, "{name}");
        }
        for (name, f) in report.fifos.as_ref().unwrap() {
            assert_eq!(f.histogram.iter().sum::<u64>(), total, "{name}");
        }
    }

    #[test]
    fn tokens_of_a_unit_are_those_it_emitted_or_took() {
        let units = samples::simulated().units.unwrap();
        assert_eq!(units["source"].tokens, samples::TOKENS);
        assert_eq!(units["sink"].tokens, samples::TOKENS);
    }

    #[test]
    fn frames_and_drain_sum_to_the_total() {
        let cycles = samples::balanced().cycles.unwrap();
        assert_eq!(cycles.frames.iter().sum::<u64>() + cycles.drain, cycles.total);
    }

    #[test]
    fn host_rates_are_per_second_of_simulation() {
        let host = samples::balanced().with_host(4.0, 2.0).host.unwrap();
        let total = samples::balanced().cycles.unwrap().total as f64;
        assert_eq!(host.cycles_per_s, Some(total / 2.0));
        assert_eq!(samples::functional().with_host(1.0, 0.0).host.unwrap().fragments_per_s, 0.0);
    }
}
