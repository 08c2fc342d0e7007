//! Random plans, generated from recipes that shrink well.

use super::PlanBuilder;
use basrelief_kernel::MemoryConfig;
use basrelief_kernel_conformance::plan::{
    Plan, PlanCache, PlanFlips, PlanLookUp, PlanMemory, PlanPeriodic, PlanPort, PlanRequest, UnitKind,
};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

/// A section of the graph between source and sink.
#[derive(Clone, Debug)]
pub enum GraphPart {
    Work,
    Expand {
        factor: u64,
    },
    Gather {
        size: u64,
    },
    /// Reads and writes on ports of one or two memories. `spare` is the number of extra credits.
    Access {
        requests: Vec<(usize, bool, u32, u64)>,
        spare: u32,
    },
    /// Look-ups through a cache of its own.
    Cached {
        memory: usize,
        strides: Vec<u64>,
        sets: u32,
        ways: u32,
        hit_latency: u32,
        per_cycle: u32,
        at_once: bool,
        spare: u32,
    },
    /// Fork, work on each branch, join. The first branch may gather and expand. The graph then deadlocks if the other branches
    /// have too few slots.
    ForkJoin {
        width: usize,
        batch: Option<u64>,
    },
    /// Router, work on each branch, in-order merge.
    RouteMerge {
        width: usize,
    },
    /// A merge, a router, and a FIFO back. Every token passes the loop once.
    Feedback,
}

/// How a unit uses its memory ports.
#[derive(Clone, Debug)]
pub struct DataUse {
    pub after: Vec<u32>,
    pub blocking: bool,
    pub issue: u32,
}

fn data_use() -> impl Strategy<Value = DataUse> {
    let after = prop_oneof![Just(vec![]), vec(0..=5_u32, 1..=3)];
    (after, any::<bool>(), 0..=2_u32).prop_map(|(after, blocking, issue)| DataUse { after, blocking, issue })
}

/// Generates periodic clients of a memory; mostly none. Their periods get longer by [`served_in`].
fn periodic() -> impl Strategy<Value = Vec<PlanPeriodic>> {
    let one = (0..=40_u64, 1..=96_u32, select(vec![0_u64, 32, 96])).prop_map(|(period, bytes, stride)| PlanPeriodic {
        name: String::new(),
        period,
        bytes,
        stride,
        span: 1024,
    });
    prop_oneof![3 => Just(vec![]), 2 => vec(one, 1..=2)]
}

/// Returns cycles in which a memory surely serves a request of so many periodic clients. With shorter periods, units could wait
/// longer and longer.
fn served_in(config: &MemoryConfig, bytes: u32, clients: usize) -> u64 {
    let MemoryConfig { burst_cycles, cl, rp, rcd, ras, wtr, wr, .. } = config;
    clients as u64 * u64::from((bytes / config.burst_bytes + 2) * (burst_cycles + cl + rp + rcd + ras + wtr + wr))
}

/// A plan without names. Times and FIFOs are used in turn, repeating.
#[derive(Clone, Debug)]
pub struct Recipe {
    pub tokens: u64,
    pub parts: Vec<GraphPart>,
    pub fifos: Vec<(usize, u64)>,
    pub times: Vec<(Vec<u64>, Vec<u64>)>,
    /// Periods of the FIFOs; used in turn, repeating.
    pub periods: Vec<u64>,
    /// Work after data, blocking and issue rate of units with memory ports; used in turn, repeating.
    pub data_uses: Vec<DataUse>,
    /// Period and hold of flips, if a port of a memory with periodic clients makes flips, or true if it waits for the end of a hold; used in
    /// turn, repeating.
    pub flips: Vec<Option<(u64, u64, bool)>>,
    pub memories: [PlanMemory; 2],
    /// Sort keys for the order of the units.
    pub order: Vec<u32>,
}

fn memory() -> impl Strategy<Value = PlanMemory> {
    let bus = select(vec![0_u32, 0, 1, 2]);
    let shape =
        (select(vec![1_u32, 2, 3]), select(vec![32_u32, 64, 256]), select(vec![1_u32, 2, 3, 4]), select(vec![64_u32, 256]));
    let choice = (1..=16_u32, 0..=16_u32, bus);
    let times = (vec(0..=4_u32, 8), 1..=4_u32, 0..=9_u32, 0..=12_u32);
    let refresh = prop_oneof![Just((0, 0)), (40..=100_u32, 0..=20_u32)];
    let rest = (times, refresh, periodic());
    (shape, choice, rest).prop_map(
        |(shape, (window, cap, commands_per_cycle), ((times, burst_cycles, ras, faw), (refi, rfc), mut periodic))| {
            let (channels, channel_bytes, banks, row_bytes) = shape;
            let [cl, cwl, rcd, rp, rtp, wr, wtr, rrd] = std::array::from_fn(|i| times[i]);
            let (burst_bytes, issue, outstanding) = (32, 0, 1);
            let config = MemoryConfig {
                part: basrelief_kernel::MemoryPart::Custom,
                channels,
                channel_bytes,
                window,
                cap,
                cl,
                cwl,
                rcd,
                rp,
                ras,
                rtp,
                wr,
                wtr,
                rrd,
                faw,
                refi,
                rfc,
                burst_bytes,
                burst_cycles,
                banks,
                row_bytes,
                commands_per_cycle,
                issue,
                outstanding,
            };
            let clients = periodic.len();
            periodic.iter_mut().for_each(|p| p.period += served_in(&config, p.bytes, clients));
            PlanMemory { name: String::new(), config, ports: vec![], periodic }
        },
    )
}

fn part() -> impl Strategy<Value = GraphPart> {
    let request = (0..2_usize, any::<bool>(), select(vec![1_u32, 4, 32, 70]), select(vec![4_u64, 32, 96, 260]));
    let cache = (0..2_usize, vec(select(vec![0_u64, 4, 16, 40]), 1..=3), select(vec![1_u32, 2, 3]), 1..=2_u32);
    prop_oneof![
        2 => Just(GraphPart::Work),
        1 => (2..=3_u64).prop_map(|factor| GraphPart::Expand { factor }),
        1 => (2..=4_u64).prop_map(|size| GraphPart::Gather { size }),
        2 => (vec(request, 1..=3), 0..=4_u32).prop_map(|(requests, spare)| GraphPart::Access { requests, spare }),
        2 => (cache, 0..=3_u32, (1..=2_u32, any::<bool>()), 0..=3_u32).prop_map(
            |((memory, strides, sets, ways), hit_latency, (per_cycle, at_once), spare)| GraphPart::Cached {
                memory, strides, sets, ways, hit_latency, per_cycle, at_once, spare
            }
        ),
        2 => (2..=3_usize, proptest::option::of(2..=4_u64)).prop_map(|(width, batch)| GraphPart::ForkJoin { width, batch }),
        1 => (2..=3_usize).prop_map(|width| GraphPart::RouteMerge { width }),
        1 => Just(GraphPart::Feedback),
    ]
}

/// Generates any recipe.
pub fn recipe() -> impl Strategy<Value = Recipe> {
    let fifo = (select(vec![1_usize, 1, 2, 3, 4, 8]), select(vec![1_u64, 1, 1, 2, 3]));
    let time = (vec(1..=4_u64, 1..=3), vec(0..=6_u64, 1..=3));
    let order = vec(any::<u32>(), 64);
    let period = prop_oneof![9 => Just(1), 1 => 2..=20_u64];
    let flip = proptest::option::of((1..=60_u64, select(vec![0_u64, 0, 7, 40]), proptest::bool::weighted(0.25)));
    let times = (vec(time, 1..=12), vec(period, 1..=12), vec(data_use(), 1..=4), vec(flip, 1..=3));
    (1..=24_u64, vec(part(), 0..=5), vec(fifo, 1..=12), times, [memory(), memory()], order).prop_map(
        |(tokens, parts, fifos, (times, periods, data_uses, flips), memories, order)| Recipe {
            tokens,
            parts,
            fifos,
            times,
            periods,
            data_uses,
            flips,
            memories,
            order,
        },
    )
}

/// Maximum number of tokens on one wire, so that a case is quick.
const MOST: u64 = 120;

/// Builds a plan section by section.
struct Builder<'r> {
    recipe: &'r Recipe,
    draw: PlanBuilder,
    /// Number of tokens at the open end.
    tokens: u64,
    end: String,
}

impl Builder<'_> {
    fn fifo(&mut self) -> String {
        let n = self.draw.0.fifos.len();
        let (depth, latency) = self.recipe.fifos[n % self.recipe.fifos.len()];
        let name = format!("f{n}");
        self.draw.fifo(&name, depth, latency);
        self.draw.0.fifos[n].period = self.recipe.periods[n % self.recipe.periods.len()];
        name
    }

    fn unit(&mut self, kind: UnitKind, inputs: &str, outputs: &str) {
        let n = self.draw.0.units.len();
        let (occupancy, latency) = &self.recipe.times[n % self.recipe.times.len()];
        let uses_memory = matches!(kind, UnitKind::Access { .. } | UnitKind::Cached { .. });
        let is_cached = matches!(kind, UnitKind::Cached { .. });
        self.draw.unit(&format!("u{n}"), kind, [inputs, outputs], occupancy, latency);
        if uses_memory {
            let DataUse { after, blocking, issue } = self.recipe.data_uses[n % self.recipe.data_uses.len()].clone();
            let unit = &mut self.draw.0.units[n];
            (unit.after, unit.blocking, unit.issue) = (after, blocking, if is_cached { 0 } else { issue });
        }
    }

    /// Adds a unit with one input and one output at the open end.
    fn then(&mut self, kind: UnitKind) {
        let (from, to) = (self.end.clone(), self.fifo());
        self.unit(kind, &from, &to);
        self.end = to;
    }

    fn port(&mut self, memory: usize, outstanding: u32, flips: Option<(u64, u64, bool)>) -> String {
        let memory = &mut self.draw.0.memories[memory];
        let name = format!("{}p{}", memory.name, memory.ports.len());
        let of = memory.periodic.first().map(|periodic| periodic.name.clone());
        let flips = flips.zip(of).map(|((period, hold, wait), of)| PlanFlips { of, period, hold, wait });
        memory.ports.push(PlanPort { name: name.clone(), outstanding, flips });
        name
    }

    fn access(&mut self, requests: &[(usize, bool, u32, u64)], spare: u32) {
        let flips = self.recipe.flips[self.draw.0.units.len() % self.recipe.flips.len()];
        let needs = |m: usize| requests.iter().filter(|r| r.0 == m).count() as u32;
        let ports: Vec<String> =
            (0..2).map(|m| if needs(m) > 0 { self.port(m, needs(m) + m as u32 * spare, flips) } else { String::new() }).collect();
        let place = |(n, &(m, write, bytes, stride)): (usize, &(usize, bool, u32, u64))| {
            let offset = 17 * n as u64;
            PlanRequest { port: ports[m].clone(), write, bytes, stride, offset, span: 1024 }
        };
        self.then(UnitKind::Access { requests: requests.iter().enumerate().map(place).collect() });
    }

    fn branches(&mut self, width: usize, split: UnitKind, join: UnitKind, batch: Option<u64>) {
        let (from, to) = (self.end.clone(), self.fifo());
        let starts: Vec<String> = (0..width).map(|_| self.fifo()).collect();
        let ends: Vec<String> = (0..width).map(|_| self.fifo()).collect();
        self.unit(split, &from, &starts.join(" "));
        for (n, (start, end)) in starts.iter().zip(&ends).enumerate() {
            match batch.filter(|_| n == 0) {
                Some(size) => {
                    let middle = self.fifo();
                    self.unit(UnitKind::Gather { size }, start, &middle);
                    self.unit(UnitKind::Expand { factor: size }, &middle, end);
                }
                None => self.unit(UnitKind::Work, start, end),
            }
        }
        self.unit(join, &ends.join(" "), &to);
        self.end = to;
    }

    fn feedback(&mut self) {
        let (from, round, back, out) = (self.end.clone(), self.fifo(), self.fifo(), self.fifo());
        self.unit(UnitKind::Merge { tokens: 2 * self.tokens }, &format!("{from} {back}"), &round);
        self.unit(UnitKind::Route, &round, &format!("{back} {out}"));
        self.end = out;
        // Renumbers the tokens, because only the odd half has left the loop.
        self.then(UnitKind::Merge { tokens: self.tokens });
    }

    fn add(&mut self, part: &GraphPart) {
        match part {
            GraphPart::Work => self.then(UnitKind::Work),
            GraphPart::Expand { factor } if self.tokens * factor > MOST => self.then(UnitKind::Work),
            &GraphPart::Expand { factor } => {
                self.tokens *= factor;
                self.then(UnitKind::Expand { factor });
            }
            &GraphPart::Gather { size } => {
                self.tokens = self.tokens.div_ceil(size);
                self.then(UnitKind::Gather { size });
            }
            GraphPart::Access { requests, spare } => self.access(requests, *spare),
            GraphPart::Cached { memory, strides, sets, ways, hit_latency, per_cycle, at_once, spare } => {
                let port = self.port(*memory, strides.len() as u32 + spare, None);
                let name = format!("c{}", self.draw.0.caches.len());
                let [sets, ways, hit_latency, lookups_per_cycle] = [*sets, *ways, *hit_latency, *per_cycle];
                let (line_bytes, at_once) = (32, *at_once);
                let cache =
                    PlanCache { name, port, line_bytes, sets, ways, hit_latency, lookups_per_cycle, at_once, always_hits: false };
                let look_up = |(n, &stride): (usize, &u64)| PlanLookUp { stride, offset: 50 * n as u64, span: 512 };
                let kind =
                    UnitKind::Cached { cache: cache.name.clone(), lookups: strides.iter().enumerate().map(look_up).collect() };
                self.draw.cache(cache);
                self.then(kind);
            }
            GraphPart::ForkJoin { width, batch } => {
                // A gathering branch must expand its batches to the same number of tokens.
                let batch = batch.and_then(|size| [size, 4, 3, 2].into_iter().find(|&size| self.tokens.is_multiple_of(size)));
                self.branches(*width, UnitKind::Fork, UnitKind::Join, batch);
            }
            GraphPart::RouteMerge { width } => {
                self.branches(*width, UnitKind::Route, UnitKind::Merge { tokens: self.tokens }, None)
            }
            GraphPart::Feedback => self.feedback(),
        }
    }
}

/// Generates recipes that mostly deadlock: a branch gathers three or four tokens, and the other branch has few slots.
pub fn tight_recipe() -> impl Strategy<Value = Recipe> {
    (recipe(), 1..=2_u64, 0..=5_usize, 3..=4_u64, vec((1..=2_usize, 1..=2_u64), 1..=3)).prop_map(
        |(mut recipe, n, at, size, fifos)| {
            let at = at.min(recipe.parts.len());
            recipe.parts.retain(|part| !matches!(part, GraphPart::Gather { .. }));
            recipe.parts.insert(at.min(recipe.parts.len()), GraphPart::ForkJoin { width: 2, batch: Some(size) });
            Recipe { tokens: 12 * n, fifos, ..recipe }
        },
    )
}

impl Recipe {
    /// Returns the plan and the number of tokens that its sink must receive.
    pub fn plan(&self) -> (Plan, u64) {
        let memory = |n: usize| {
            let mut memory = PlanMemory { name: format!("m{n}"), ..self.memories[n].clone() };
            memory.periodic.iter_mut().enumerate().for_each(|(k, periodic)| periodic.name = format!("m{n}v{k}"));
            memory
        };
        let draw = PlanBuilder(Plan { memories: vec![memory(0), memory(1)], ..Plan::default() });
        let mut builder = Builder { recipe: self, draw, tokens: self.tokens, end: String::new() };
        builder.end = builder.fifo();
        builder.unit(UnitKind::Source { tokens: self.tokens }, "", "f0");
        self.parts.iter().for_each(|part| builder.add(part));
        let end = builder.end.clone();
        builder.unit(UnitKind::Sink, &end, "");
        (builder.draw.0, builder.tokens)
    }

    /// Returns the same plan with its units in another order.
    pub fn reordered(&self) -> Plan {
        let (mut plan, _) = self.plan();
        let keys = self.order.iter().copied().chain(std::iter::repeat(0));
        let mut keyed: Vec<_> = keys.zip(plan.units).collect();
        keyed.sort_by_key(|&(key, _)| key);
        plan.units = keyed.into_iter().map(|(_, unit)| unit).collect();
        plan
    }
}
