//! Cost of the kernel itself per token and stage, on statically wired machines with minimal units.

use crate::workload::{RunSample, ThroughputUnit, Workload, WorkloadSize, measured};
use basrelief_kernel::Source;
use basrelief_kernel::{
    CacheConfig, Demand, Engine, Fifo, Machine, MemoryConfig, MemoryPorts, MemorySystem, Outcome, Probe, Recorder, RunLimits,
    Stage, Step, Unit, Visitor, run_functional, run_with,
};
use std::hint::black_box;
use std::ops::Range;

type NumberSource = Stage<Source<Range<u64>>>;

fn numbers(tokens: u64) -> NumberSource {
    Stage::new("source", Source::new(0..tokens))
}

fn fifo(name: &str) -> Fifo<u64> {
    Fifo::new(name, 16, 1)
}

/// Unit that passes its token on.
struct PassUnit {
    occupancy: u64,
}

impl Unit for PassUnit {
    type In = Option<u64>;
    type Out = Option<u64>;
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, _: &mut MemoryPorts) -> Step<Option<u64>> {
        Step::after(3, input.map(|n| n + 1)).busy(self.occupancy)
    }
}

/// Unit that drops tokens.
#[derive(Default)]
struct DrainUnit {
    sum: u64,
}

impl Unit for DrainUnit {
    type In = Option<u64>;
    type Out = ();
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, _: &mut MemoryPorts) -> Step<()> {
        self.sum += input.unwrap_or(0);
        Step::after(0, ())
    }
}

fn drain(name: &str) -> Stage<DrainUnit> {
    Stage::new(name, DrainUnit::default())
}

/// Nine stages in a row.
struct NineStageChain {
    source: NumberSource,
    passes: [Stage<PassUnit>; 7],
    fifos: [Fifo<u64>; 8],
    drain: Stage<DrainUnit>,
    memories: MemorySystem,
}

impl NineStageChain {
    const STAGES: u64 = 9;

    fn new(tokens: u64, occupancy: u64) -> Self {
        Self {
            source: numbers(tokens),
            passes: std::array::from_fn(|i| Stage::new(&format!("pass {i}"), PassUnit { occupancy })),
            fifos: std::array::from_fn(|i| fifo(&format!("fifo {i}"))),
            drain: drain("drain"),
            memories: MemorySystem::default(),
        }
    }
}

impl Machine for NineStageChain {
    #[inline]
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let [a, b, c, d, e, f, g] = &mut self.passes;
        let [w0, w1, w2, w3, w4, w5, w6, w7] = &mut self.fifos;
        v.stage(self.source.between((), &mut *w0));
        v.stage(a.between(w0, &mut *w1));
        v.stage(b.between(w1, &mut *w2));
        v.stage(c.between(w2, &mut *w3));
        v.stage(d.between(w3, &mut *w4));
        v.stage(e.between(w4, &mut *w5));
        v.stage(f.between(w5, &mut *w6));
        v.stage(g.between(w6, &mut *w7));
        v.stage(self.drain.between(w7, ()));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Unit that sends its token to both outputs.
struct ForkUnit;

impl Unit for ForkUnit {
    type In = Option<u64>;
    type Out = (Option<u64>, Option<u64>);
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, _: &mut MemoryPorts) -> Step<Self::Out> {
        Step::after(0, (input, input))
    }
}

/// Unit that adds both inputs.
struct JoinUnit;

impl Unit for JoinUnit {
    type In = (Option<u64>, Option<u64>);
    type Out = Option<u64>;
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, (a, b): Self::In, _: &mut MemoryPorts) -> Step<Option<u64>> {
        Step::after(0, a.zip(b).map(|(a, b)| a + b))
    }
}

/// Source, fork, two branches, join, drain.
struct ForkJoin {
    source: NumberSource,
    fork: Stage<ForkUnit>,
    branches: [Stage<PassUnit>; 2],
    join: Stage<JoinUnit>,
    drain: Stage<DrainUnit>,
    fifos: [Fifo<u64>; 6],
    memories: MemorySystem,
}

impl ForkJoin {
    const STAGES: u64 = 6;

    fn new(tokens: u64) -> Self {
        Self {
            source: numbers(tokens),
            fork: Stage::new("fork", ForkUnit),
            branches: [1, 2].map(|occupancy| Stage::new(&format!("branch {occupancy}"), PassUnit { occupancy })),
            join: Stage::new("join", JoinUnit),
            drain: drain("drain"),
            fifos: std::array::from_fn(|i| fifo(&format!("fifo {i}"))),
            memories: MemorySystem::default(),
        }
    }
}

impl Machine for ForkJoin {
    #[inline]
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let [input, left, right, left_out, right_out, out] = &mut self.fifos;
        let [a, b] = &mut self.branches;
        v.stage(self.source.between((), &mut *input));
        v.stage(self.fork.between(input, (&mut *left, &mut *right)));
        v.stage(a.between(left, &mut *left_out));
        v.stage(b.between(right, &mut *right_out));
        v.stage(self.join.between((left_out, right_out), &mut *out));
        v.stage(self.drain.between(out, ()));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Memory access of a client per token.
#[derive(Clone, Copy)]
enum AccessUnit {
    /// One read of 64 bytes at this stride.
    Read { stride: u64 },
    /// Four texels of a row, two of them in the next: mostly hits.
    LookUp,
}

impl Unit for AccessUnit {
    type In = Option<u64>;
    type Out = Option<u64>;
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<Option<u64>> {
        let n = input.unwrap_or(0);
        match *self {
            AccessUnit::Read { stride } => traffic.read(0, n * stride, 64),
            AccessUnit::LookUp => {
                let texel = 4 * (n % 4096);
                [texel, texel + 4, texel + 2048, texel + 2052].iter().for_each(|&address| traffic.look_up(0, address, 4));
            }
        }
        Step::after(1, input)
    }
    fn largest_step(&self, client: usize) -> u32 {
        match self {
            AccessUnit::Read { .. } => u32::from(client == 0),
            AccessUnit::LookUp => 4 * u32::from(client == 0),
        }
    }
}

/// Source, client, drain.
struct ClientRow {
    source: NumberSource,
    input: Fifo<u64>,
    client: Stage<AccessUnit>,
    output: Fifo<u64>,
    drain: Stage<DrainUnit>,
    ids: [usize; 1],
}

/// Rows whose clients share one memory.
struct ClientRows<const N: usize> {
    rows: [ClientRow; N],
    memories: MemorySystem,
}

impl<const N: usize> ClientRows<N> {
    const STAGES: u64 = 3 * N as u64;

    fn new(tokens: u64, accesses: [AccessUnit; N]) -> Self {
        let mut memories = MemorySystem::default();
        let memory = memories.add_memory("memory", &MemoryConfig::default());
        let rows = accesses.map(|access| {
            let id = match access {
                AccessUnit::Read { .. } => memories.add_client("port", memory, 8),
                AccessUnit::LookUp => memories.add_cached_client("port", memory, 8, "cache", &CacheConfig::default()),
            };
            let (client, drain) = (Stage::new("client", access), drain("drain"));
            ClientRow { source: numbers(tokens), input: fifo("in"), client, output: fifo("out"), drain, ids: [id] }
        });
        Self { rows, memories }
    }
}

impl<const N: usize> Machine for ClientRows<N> {
    #[inline]
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        for ClientRow { source, input, client, output, drain, ids } in &mut self.rows {
            v.stage(source.between((), &mut *input));
            v.stage(client.between(input, &mut *output).using(&mut self.memories, &*ids));
            v.stage(drain.between(output, ()));
        }
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

fn simulate<M: Machine>(machine: &mut M, engine: Engine, probe: Option<&mut dyn Probe>) {
    let report = run_with(machine, engine, probe, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true });
    assert_eq!(report.outcome, Outcome::Complete);
    black_box(report.total);
}

fn timed<M: Machine>(machine: &mut M) {
    simulate(machine, Engine::Timed, None);
}

fn ticked<M: Machine>(machine: &mut M) {
    simulate(machine, Engine::Ticked, None);
}

fn functional<M: Machine>(machine: &mut M) {
    assert_eq!(run_functional(machine, &mut |_| true), Ok(()));
}

fn recorded<M: Machine>(machine: &mut M) {
    let mut intervals = Recorder::default();
    simulate(machine, Engine::Timed, Some(&mut intervals));
    black_box(intervals);
}

/// Creates a workload of runs of fresh machines, counted in tokens times stages.
fn workload<M: Machine + 'static>(
    name: impl Into<String>,
    elements: u64,
    new: impl Fn() -> M + Copy + 'static,
    run: fn(&mut M),
) -> Workload {
    Workload::new(format!("kernel/{}", name.into()), ThroughputUnit::TokenStages, move || {
        move || {
            let mut machine = new();
            let ((), time) = measured(|| run(&mut machine));
            RunSample { time, count: elements }
        }
    })
}

/// Returns chains on both engines, without time and under a probe, a fork and join, and clients that share a memory.
pub fn workloads(size: WorkloadSize) -> Vec<Workload> {
    let n = size.of(100_000, 10_000);
    let chain = move |name: String, service: u64, run| {
        workload(name, n * NineStageChain::STAGES, move || NineStageChain::new(n, service), run)
    };
    let mut all = Vec::new();
    for service in [1, 4, 32] {
        all.push(chain(format!("chain/{service}/timed"), service, timed));
        all.push(chain(format!("chain/{service}/ticked"), service, ticked));
    }
    all.push(chain("chain/1/functional".into(), 1, functional));
    all.push(chain("chain/4/recorded".into(), 4, recorded));
    let (near, far) = (AccessUnit::Read { stride: 64 }, AccessUnit::Read { stride: 4160 });
    let pair = n * ClientRows::<2>::STAGES;
    all.push(workload("fork-join", n * ForkJoin::STAGES, move || ForkJoin::new(n), timed));
    all.push(workload("two-readers", pair, move || ClientRows::new(n, [near, far]), timed));
    all.push(workload("reader-and-cache", pair, move || ClientRows::new(n, [near, AccessUnit::LookUp]), timed));
    all.push(workload("cache", n * ClientRows::<1>::STAGES, move || ClientRows::new(n, [AccessUnit::LookUp]), timed));
    all
}
