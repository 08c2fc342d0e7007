//! A machine around one unit: a source per input, a sink per output, and the memory behind its clients.

use super::guard::Guard;
use super::{Client, Sink, Source};
use crate::wiring::{Clients, Inputs, Machine, Outputs, Visitor};
use crate::{CacheConfig, Fifo, MemoryConfig, MemorySystem, Stage, Unit};
use std::fmt::{self, Debug};

/// What surrounds the unit in one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Setting {
    /// Slots of every FIFO.
    pub depth: usize,
    /// Cycles from delivery to visibility, of every FIFO.
    pub latency: u64,
    /// Free cycles after item n of each source, repeating.
    pub source_gaps: Vec<u64>,
    /// Cycles for which token n keeps each sink, repeating.
    pub sink_occupancy: Vec<u64>,
    /// Whether the memory is slow, its caches one line small, and credits no more than the largest step needs.
    pub slow_memory: bool,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { depth, latency, source_gaps, sink_occupancy, slow_memory } = self;
        let memory = if *slow_memory { "slow" } else { "fast" };
        write!(f, "FIFOs of {depth} slots and latency {latency}, source gaps {source_gaps:?}, ")?;
        write!(f, "sink occupancy {sink_occupancy:?}, {memory} memory")
    }
}

impl Setting {
    fn memory(&self) -> MemoryConfig {
        let slow = MemoryConfig { banks: 1, burst_cycles: 7, cas: 40, rcd: 23, rp: 17, ..MemoryConfig::default() };
        if self.slow_memory { slow } else { MemoryConfig::default() }
    }

    fn cache(&self, line_bytes: u32) -> CacheConfig {
        let small = CacheConfig { line_bytes, sets: 4, ways: 2, ..CacheConfig::default() };
        let tiny = CacheConfig { sets: 1, ways: 1, hit_latency: 9, lookups_per_cycle: 1, ..small.clone() };
        if self.slow_memory { tiny } else { small }
    }
}

/// What a unit takes, and what feeds it: implemented for `()`, `Option<A>` and `(Option<A>, Option<B>)`.
pub trait Popped: Sized {
    /// The tokens of each input: `()`, `Vec<A>` or `(Vec<A>, Vec<B>)`.
    type Tokens: Clone;
    /// The sources with their FIFOs.
    type Front: Front<Item = Self>;
    /// Sources of `tokens`.
    fn front(tokens: Self::Tokens, setting: &Setting) -> Self::Front;
}

/// Sources with their FIFOs.
pub trait Front {
    /// What the unit behind them pops.
    type Item;
    /// The FIFOs.
    type Wires<'a>: Inputs<Item = Self::Item>
    where
        Self: 'a;
    /// Shows every source.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// The FIFOs' ends at the unit.
    fn ends(&mut self) -> Self::Wires<'_>;
}

/// What a unit emits, and what collects it: implemented for `()`, `Option<A>` and `(Option<A>, Option<B>)`.
pub trait Emitted: Sized {
    /// The tokens of each output: `()`, `Vec<A>` or `(Vec<A>, Vec<B>)`.
    type Tokens: Clone + Debug + PartialEq;
    /// The sinks with their FIFOs.
    type Back: Back<Item = Self, Tokens = Self::Tokens>;
    /// Sinks that expect `tokens`, if given.
    fn back(tokens: Option<Self::Tokens>, setting: &Setting) -> Self::Back;
}

/// Sinks with their FIFOs.
pub trait Back {
    /// What the unit before them emits.
    type Item;
    /// The tokens of each output.
    type Tokens;
    /// The FIFOs.
    type Wires<'a>: Outputs<Item = Self::Item>
    where
        Self: 'a;
    /// Shows every sink.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// The FIFOs' ends at the unit.
    fn ends(&mut self) -> Self::Wires<'_>;
    /// What came.
    fn tokens(&self) -> Self::Tokens;
}

/// A source and its FIFO.
#[derive(Clone, Debug)]
pub struct Inlet<T> {
    stage: Stage<Source<std::vec::IntoIter<T>>>,
    fifo: Fifo<T>,
}

impl<T> Inlet<T> {
    fn new(n: usize, tokens: Vec<T>, setting: &Setting) -> Self {
        let source = Source::new(tokens).with_gaps(&setting.source_gaps);
        let fifo = Fifo::new(&format!("input_{n}"), setting.depth, setting.latency);
        Self { stage: Stage::new(&format!("source_{n}"), source), fifo }
    }
}

/// A sink and its FIFO.
#[derive(Clone, Debug)]
pub struct Outlet<T> {
    stage: Stage<Sink<T>>,
    fifo: Fifo<T>,
}

impl<T: Debug + PartialEq> Outlet<T> {
    fn new(n: usize, tokens: Option<Vec<T>>, setting: &Setting) -> Self {
        let sink = tokens.map_or_else(Sink::new, Sink::expect).with_occupancy(&setting.sink_occupancy);
        let fifo = Fifo::new(&format!("output_{n}"), setting.depth, setting.latency);
        Self { stage: Stage::new(&format!("sink_{n}"), sink), fifo }
    }
}

impl Popped for () {
    type Tokens = ();
    type Front = ();
    fn front((): (), _: &Setting) {}
}

impl Front for () {
    type Item = ();
    type Wires<'a> = ();
    fn wire<V: Visitor>(&mut self, _: &mut V) {}
    fn ends(&mut self) {}
}

impl<A: Clone> Popped for Option<A> {
    type Tokens = Vec<A>;
    type Front = Inlet<A>;
    fn front(tokens: Vec<A>, setting: &Setting) -> Inlet<A> {
        Inlet::new(0, tokens, setting)
    }
}

impl<A> Front for Inlet<A> {
    type Item = Option<A>;
    type Wires<'a>
        = &'a mut Fifo<A>
    where
        A: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(&mut self.stage, (), &mut self.fifo, Clients::none());
    }
    fn ends(&mut self) -> &mut Fifo<A> {
        &mut self.fifo
    }
}

impl<A: Clone, B: Clone> Popped for (Option<A>, Option<B>) {
    type Tokens = (Vec<A>, Vec<B>);
    type Front = (Inlet<A>, Inlet<B>);
    fn front((a, b): (Vec<A>, Vec<B>), setting: &Setting) -> Self::Front {
        (Inlet::new(0, a, setting), Inlet::new(1, b, setting))
    }
}

impl<A, B> Front for (Inlet<A>, Inlet<B>) {
    type Item = (Option<A>, Option<B>);
    type Wires<'a>
        = (&'a mut Fifo<A>, &'a mut Fifo<B>)
    where
        A: 'a,
        B: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        self.0.wire(v);
        self.1.wire(v);
    }
    fn ends(&mut self) -> Self::Wires<'_> {
        (&mut self.0.fifo, &mut self.1.fifo)
    }
}

impl Emitted for () {
    type Tokens = ();
    type Back = ();
    fn back(_: Option<()>, _: &Setting) {}
}

impl Back for () {
    type Item = ();
    type Tokens = ();
    type Wires<'a> = ();
    fn wire<V: Visitor>(&mut self, _: &mut V) {}
    fn ends(&mut self) {}
    fn tokens(&self) {}
}

impl<A: Clone + Debug + PartialEq> Emitted for Option<A> {
    type Tokens = Vec<A>;
    type Back = Outlet<A>;
    fn back(tokens: Option<Vec<A>>, setting: &Setting) -> Outlet<A> {
        Outlet::new(0, tokens, setting)
    }
}

impl<A: Clone + Debug + PartialEq> Back for Outlet<A> {
    type Item = Option<A>;
    type Tokens = Vec<A>;
    type Wires<'a>
        = &'a mut Fifo<A>
    where
        A: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(&mut self.stage, &mut self.fifo, (), Clients::none());
    }
    fn ends(&mut self) -> &mut Fifo<A> {
        &mut self.fifo
    }
    fn tokens(&self) -> Vec<A> {
        self.stage.unit.tokens().to_vec()
    }
}

impl<A: Clone + Debug + PartialEq, B: Clone + Debug + PartialEq> Emitted for (Option<A>, Option<B>) {
    type Tokens = (Vec<A>, Vec<B>);
    type Back = (Outlet<A>, Outlet<B>);
    fn back(tokens: Option<(Vec<A>, Vec<B>)>, setting: &Setting) -> Self::Back {
        let (a, b) = tokens.unzip();
        (Outlet::new(0, a, setting), Outlet::new(1, b, setting))
    }
}

impl<A: Clone + Debug + PartialEq, B: Clone + Debug + PartialEq> Back for (Outlet<A>, Outlet<B>) {
    type Item = (Option<A>, Option<B>);
    type Tokens = (Vec<A>, Vec<B>);
    type Wires<'a>
        = (&'a mut Fifo<A>, &'a mut Fifo<B>)
    where
        A: 'a,
        B: 'a;
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        self.0.wire(v);
        self.1.wire(v);
    }
    fn ends(&mut self) -> Self::Wires<'_> {
        (&mut self.0.fifo, &mut self.1.fifo)
    }
    fn tokens(&self) -> Self::Tokens {
        (self.0.tokens(), self.1.tokens())
    }
}

/// Sources, the unit under test, sinks; and one memory with a port, or a port and a cache, per client of the unit.
///
/// ```text
///   source_0 --input_0--> +------+ --output_0--> sink_0
///   source_1 --input_1--> | unit | --output_1--> sink_1
///                         +------+
///              client_0, client_1 .. | memory
/// ```
pub struct Bench<U: Unit<In: Popped, Out: Emitted>> {
    front: <U::In as Popped>::Front,
    unit: Stage<Guard<U>>,
    back: <U::Out as Emitted>::Back,
    memories: MemorySystem,
    clients: Vec<usize>,
}

impl<U: Unit<In: Popped, Out: Emitted>> Bench<U> {
    /// Feeds `tokens` to `unit`; the sinks expect `expected`, if given.
    pub fn new(
        unit: U,
        tokens: <U::In as Popped>::Tokens,
        expected: Option<<U::Out as Emitted>::Tokens>,
        clients: &[Client],
        setting: &Setting,
    ) -> Self {
        Self::guarded(Guard::new(unit, clients), tokens, expected, setting)
    }

    pub(super) fn guarded(
        guard: Guard<U>,
        tokens: <U::In as Popped>::Tokens,
        expected: Option<<U::Out as Emitted>::Tokens>,
        setting: &Setting,
    ) -> Self {
        let mut memories = MemorySystem::default();
        let memory = memories.add_memory("memory", &setting.memory());
        let mut add = |(n, client): (usize, &Client)| {
            let credits = guard.largest_step(n).max(1) + if setting.slow_memory { 0 } else { 8 };
            let name = format!("client_{n}");
            match client {
                Client::Port => memories.add_client(&name, memory, credits),
                Client::Cache { line_bytes } => {
                    let cache = setting.cache(*line_bytes);
                    memories.add_cached_client(&name, memory, credits, &format!("cache_{n}"), &cache)
                }
            }
        };
        let clients = guard.clients().iter().enumerate().map(&mut add).collect();
        let front = U::In::front(tokens, setting);
        let back = U::Out::back(expected, setting);
        Self { front, unit: Stage::new("unit", guard), back, memories, clients }
    }

    /// The unit.
    pub fn unit(&self) -> &U {
        &self.unit.unit.unit
    }

    /// What the sinks collected.
    pub fn tokens(&self) -> <U::Out as Emitted>::Tokens {
        self.back.tokens()
    }
}

impl<U: Unit<In: Popped, Out: Emitted>> Machine for Bench<U> {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        self.front.wire(v);
        let clients = Clients::of(&mut self.memories, &self.clients);
        v.stage(&mut self.unit, self.front.ends(), self.back.ends(), clients);
        self.back.wire(v);
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
