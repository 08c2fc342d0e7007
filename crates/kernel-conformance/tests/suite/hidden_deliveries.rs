//! If a step delivers nothing, later tokens do not wait for its answers, in either engine. Otherwise the timed engine would serve
//! requests of later cycles before the requests of these tokens.

use basrelief_kernel::Source;
use basrelief_kernel::{
    CacheConfig, Demand, Engine, Fifo, Machine, MemoryConfig, MemoryPorts, MemorySystem, Outcome, RunReport, Stage, Step, Unit,
    Visitor, run,
};

/// Looks up a separate line for each token, except every fifth token, which passes without a look-up.
struct Filter;

impl Unit for Filter {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<Option<u64>> {
        let passes = input.filter(|token| token % 5 == 1);
        if passes.is_none() {
            traffic.look_up(0, 64 * input.unwrap_or(0), 4);
        }
        Step::after(1, passes)
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }
}

/// Issues one read per token.
struct Reader;

impl Unit for Reader {
    type In = Option<u64>;
    type Out = ();
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<()> {
        traffic.read(0, (1 << 20) + 64 * input.unwrap_or(0), 64);
        Step::after(0, ())
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }
}

/// source --tokens--> filter --passed--> reader; filter and reader share a memory.
struct Sieve {
    source: Stage<Source<std::ops::Range<u64>>>,
    tokens: Fifo<u64>,
    filter: Stage<Filter>,
    passed: Fifo<u64>,
    reader: Stage<Reader>,
    memories: MemorySystem,
    clients: [usize; 2],
}

impl Machine for Sieve {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let m = &mut self.memories;
        v.stage(self.source.between((), &mut self.tokens));
        v.stage(self.filter.between(&mut self.tokens, &mut self.passed).using(m, &self.clients[..1]));
        v.stage(self.reader.between(&mut self.passed, ()).using(m, &self.clients[1..]));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

fn report(engine: Engine, outstanding: u32) -> RunReport {
    let mut memories = MemorySystem::default();
    let memory = memories.add_memory("memory", &MemoryConfig::default());
    let cached = memories.add_cached_client("lines", memory, outstanding, "cache", &CacheConfig::default());
    let direct = memories.add_client("reads", memory, outstanding);
    let mut machine = Sieve {
        source: Stage::new("source", Source::new(0..200)),
        tokens: Fifo::new("tokens", 4, 1),
        filter: Stage::new("filter", Filter),
        passed: Fifo::new("passed", 4, 1),
        reader: Stage::new("reader", Reader),
        memories,
        clients: [cached, direct],
    };
    run(&mut machine, engine)
}

#[test]
fn engines_agree_on_tokens_behind_silent_steps() {
    for outstanding in [1, 2, 8, 64] {
        let timed = report(Engine::Timed, outstanding);
        assert_eq!(timed.outcome, Outcome::Complete);
        assert_eq!(timed, report(Engine::Ticked, outstanding), "{outstanding} credits");
        // Every look-up is counted at the end, even if no token waits for its step.
        let counts = timed.caches[0].counts;
        assert_eq!(counts.hits + counts.misses + counts.merged, 160);
    }
}
