//! Cost of the kernel itself, per token and stage, on statically wired machines whose units do next to nothing.

use basrelief_kernel::contract::Source;
use basrelief_kernel::{
    CacheConfig, Clients, Demand, Engine, Fifo, Limits, Machine, MemoryConfig, MemorySystem, NoProbe, Outcome, Probe, Recorder,
    Stage, Step, Traffic, Unit, Visitor, run_functional, run_with,
};
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::ops::Range;
use std::time::Duration;

const TOKENS: u64 = 100_000;

type Numbers = Stage<Source<Range<u64>>>;

fn numbers(name: &str) -> Numbers {
    Stage::new(name, Source::new(0..TOKENS))
}

fn fifo(name: &str) -> Fifo<u64> {
    Fifo::new(name, 16, 1)
}

/// Passes its token on.
struct Pass {
    occupancy: u64,
}

impl Unit for Pass {
    type In = Option<u64>;
    type Out = Option<u64>;
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, _: &mut Traffic) -> Step<Option<u64>> {
        Step::after(3, input.map(|n| n + 1)).busy(self.occupancy)
    }
}

/// Swallows tokens.
#[derive(Default)]
struct Drain {
    sum: u64,
}

impl Unit for Drain {
    type In = Option<u64>;
    type Out = ();
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, _: &mut Traffic) -> Step<()> {
        self.sum += input.unwrap_or(0);
        Step::after(0, ())
    }
}

fn drain(name: &str) -> Stage<Drain> {
    Stage::new(name, Drain::default())
}

/// Nine stages in a row.
struct Chain {
    source: Numbers,
    passes: [Stage<Pass>; 7],
    fifos: [Fifo<u64>; 8],
    drain: Stage<Drain>,
    memories: MemorySystem,
}

impl Chain {
    const STAGES: u64 = 9;

    fn new(occupancy: u64) -> Self {
        Self {
            source: numbers("source"),
            passes: std::array::from_fn(|i| Stage::new(&format!("pass {i}"), Pass { occupancy })),
            fifos: std::array::from_fn(|i| fifo(&format!("fifo {i}"))),
            drain: drain("drain"),
            memories: MemorySystem::default(),
        }
    }
}

impl Machine for Chain {
    #[inline]
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let [a, b, c, d, e, f, g] = &mut self.passes;
        let [w0, w1, w2, w3, w4, w5, w6, w7] = &mut self.fifos;
        v.stage(&mut self.source, (), &mut *w0, Clients::none());
        v.stage(a, w0, &mut *w1, Clients::none());
        v.stage(b, w1, &mut *w2, Clients::none());
        v.stage(c, w2, &mut *w3, Clients::none());
        v.stage(d, w3, &mut *w4, Clients::none());
        v.stage(e, w4, &mut *w5, Clients::none());
        v.stage(f, w5, &mut *w6, Clients::none());
        v.stage(g, w6, &mut *w7, Clients::none());
        v.stage(&mut self.drain, w7, (), Clients::none());
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Gives its token to both sides.
struct Fork;

impl Unit for Fork {
    type In = Option<u64>;
    type Out = (Option<u64>, Option<u64>);
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, _: &mut Traffic) -> Step<Self::Out> {
        Step::after(0, (input, input))
    }
}

/// Adds both sides.
struct Join;

impl Unit for Join {
    type In = (Option<u64>, Option<u64>);
    type Out = Option<u64>;
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, (a, b): Self::In, _: &mut Traffic) -> Step<Option<u64>> {
        Step::after(0, a.zip(b).map(|(a, b)| a + b))
    }
}

/// Source, fork, two branches, join, drain.
struct ForkJoin {
    source: Numbers,
    fork: Stage<Fork>,
    branches: [Stage<Pass>; 2],
    join: Stage<Join>,
    drain: Stage<Drain>,
    fifos: [Fifo<u64>; 6],
    memories: MemorySystem,
}

impl ForkJoin {
    const STAGES: u64 = 6;

    fn new() -> Self {
        Self {
            source: numbers("source"),
            fork: Stage::new("fork", Fork),
            branches: [1, 2].map(|occupancy| Stage::new(&format!("branch {occupancy}"), Pass { occupancy })),
            join: Stage::new("join", Join),
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
        v.stage(&mut self.source, (), &mut *input, Clients::none());
        v.stage(&mut self.fork, input, (&mut *left, &mut *right), Clients::none());
        v.stage(a, left, &mut *left_out, Clients::none());
        v.stage(b, right, &mut *right_out, Clients::none());
        v.stage(&mut self.join, (left_out, right_out), &mut *out, Clients::none());
        v.stage(&mut self.drain, out, (), Clients::none());
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// What a client does per token.
#[derive(Clone, Copy)]
enum Access {
    /// One read of 64 bytes, this far apart.
    Read { stride: u64 },
    /// Four texels of a row, two of them in the next: mostly hits.
    LookUp,
}

impl Unit for Access {
    type In = Option<u64>;
    type Out = Option<u64>;
    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }
    #[inline]
    fn step(&mut self, input: Option<u64>, traffic: &mut Traffic) -> Step<Option<u64>> {
        let n = input.unwrap_or(0);
        match *self {
            Access::Read { stride } => traffic.read(0, n * stride, 64),
            Access::LookUp => {
                let texel = 4 * (n % 4096);
                [texel, texel + 4, texel + 2048, texel + 2052].iter().for_each(|&address| traffic.look_up(0, address, 4));
            }
        }
        Step::after(1, input)
    }
    fn largest_step(&self, _: usize) -> u32 {
        match self {
            Access::Read { .. } => 1,
            Access::LookUp => 4,
        }
    }
}

/// Source, client, drain.
struct Row {
    source: Numbers,
    input: Fifo<u64>,
    client: Stage<Access>,
    output: Fifo<u64>,
    drain: Stage<Drain>,
    ids: [usize; 1],
}

/// Rows whose clients share one memory.
struct Rows<const N: usize> {
    rows: [Row; N],
    memories: MemorySystem,
}

impl<const N: usize> Rows<N> {
    const STAGES: u64 = 3 * N as u64;

    fn new(accesses: [Access; N]) -> Self {
        let mut memories = MemorySystem::default();
        let memory = memories.add_memory("memory", &MemoryConfig::default());
        let rows = accesses.map(|access| {
            let id = match access {
                Access::Read { .. } => memories.add_client("port", memory, 8),
                Access::LookUp => memories.add_cached_client("port", memory, 8, "cache", &CacheConfig::default()),
            };
            let (client, drain) = (Stage::new("client", access), drain("drain"));
            Row { source: numbers("source"), input: fifo("in"), client, output: fifo("out"), drain, ids: [id] }
        });
        Self { rows, memories }
    }
}

impl<const N: usize> Machine for Rows<N> {
    #[inline]
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        for Row { source, input, client, output, drain, ids } in &mut self.rows {
            v.stage(source, (), &mut *input, Clients::none());
            v.stage(client, input, &mut *output, Clients::of(&mut self.memories, &*ids));
            v.stage(drain, output, (), Clients::none());
        }
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

fn simulate<M: Machine, P: Probe>(machine: &mut M, engine: Engine, probe: &mut P) {
    let report = run_with(machine, engine, probe, Limits { max_cycles: u64::MAX, progress: &mut |_| true });
    assert_eq!(report.outcome, Outcome::Complete);
    black_box(report.total);
}

fn timed<M: Machine>(machine: &mut M) {
    simulate(machine, Engine::Timed, &mut NoProbe);
}

fn ticked<M: Machine>(machine: &mut M) {
    simulate(machine, Engine::Ticked, &mut NoProbe);
}

/// Times runs of fresh machines, in elements of one token in one stage.
fn bench<M: Machine>(c: &mut Criterion, id: BenchmarkId, stages: u64, new: impl Fn() -> M, mut run: impl FnMut(&mut M)) {
    let mut group = c.benchmark_group("kernel");
    group.throughput(Throughput::Elements(TOKENS * stages)).sample_size(20).measurement_time(Duration::from_secs(3));
    group.bench_with_input(id, &(), |b, ()| b.iter_batched_ref(&new, &mut run, BatchSize::PerIteration));
    group.finish();
}

fn benches(c: &mut Criterion) {
    for service in [1, 4, 32] {
        bench(c, BenchmarkId::new("chain", service), Chain::STAGES, || Chain::new(service), timed);
        bench(c, BenchmarkId::new("chain, ticked", service), Chain::STAGES, || Chain::new(service), ticked);
    }
    let functional = |machine: &mut Chain| assert_eq!(run_functional(machine, &mut |_| true), Ok(()));
    bench(c, BenchmarkId::from_parameter("chain, functional"), Chain::STAGES, || Chain::new(1), functional);
    let recorded = |machine: &mut Chain| {
        let mut intervals = Recorder::default();
        simulate(machine, Engine::Timed, &mut intervals);
        black_box(intervals);
    };
    bench(c, BenchmarkId::new("chain, recorded", 4), Chain::STAGES, || Chain::new(4), recorded);
    bench(c, BenchmarkId::from_parameter("fork-join"), ForkJoin::STAGES, ForkJoin::new, timed);
    let (near, far) = (Access::Read { stride: 64 }, Access::Read { stride: 4160 });
    bench(c, BenchmarkId::from_parameter("two readers of one memory"), Rows::<2>::STAGES, || Rows::new([near, far]), timed);
    let mixed = || Rows::new([near, Access::LookUp]);
    bench(c, BenchmarkId::from_parameter("reader and cache of one memory"), Rows::<2>::STAGES, mixed, timed);
    bench(c, BenchmarkId::from_parameter("cached client"), Rows::<1>::STAGES, || Rows::new([Access::LookUp]), timed);
}

criterion_group!(kernel, benches);
criterion_main!(kernel);
