//! A step waits for its own answers and, on each output, for the token ahead. It never waits for a step on another output.

use basrelief_kernel::{
    CacheConfig, Demand, Engine, Fifo, Machine, MemoryConfig, MemoryPorts, MemorySystem, Stage, Step, Unit, Visitor, run,
};

/// Emits the numbers below its limit.
struct Count(u64, u64);
impl Unit for Count {
    type In = ();
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        if self.0 < self.1 { Demand::Nothing } else { Demand::Finished }
    }
    fn step(&mut self, (): (), _: &mut MemoryPorts) -> Step<Option<u64>> {
        self.0 += 1;
        Step::after(0, Some(self.0 - 1))
    }
    fn is_empty(&self) -> bool {
        self.0 == self.1
    }
}

/// Models a test against a table. Most tokens are looked up or read and go no further. Some pass to the left, some to the right,
/// with or without memory requests.
struct Filter;
impl Unit for Filter {
    type In = Option<u64>;
    type Out = (Option<u64>, Option<u64>);
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let n = input.unwrap_or_default();
        match n % 7 {
            0 | 3 => traffic.look_up(0, n * 40 % 4096, 4),
            1 => traffic.read(1, n * 640 % 8192, 16),
            _ => {}
        }
        let out = match n % 5 {
            0 => (Some(n), None),
            2 => (None, Some(n)),
            4 => (Some(n), Some(n)),
            _ => (None, None),
        };
        Step::after(n % 3, out)
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client < 2)
    }
}

/// Writes each token to memory.
struct Write;
impl Unit for Write {
    type In = Option<u64>;
    type Out = ();
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<()> {
        traffic.write(0, input.unwrap_or_default() * 704 % 16384, 8);
        Step::after(0, ())
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }
}

struct Bench {
    count: Stage<Count>,
    numbers: Fifo<u64>,
    filter: Stage<Filter>,
    left: Fifo<u64>,
    right: Fifo<u64>,
    writers: [Stage<Write>; 2],
    memories: MemorySystem,
    clients: [Vec<usize>; 3],
}

impl Bench {
    fn new(depth: usize, cl: u32, outstanding: u32) -> Self {
        let mut memories = MemorySystem::default();
        let memory = memories.add_memory("memory", &MemoryConfig { cl, ..MemoryConfig::default() });
        let cache = CacheConfig { sets: 2, ways: 2, ..CacheConfig::default() };
        let right = memories.add_client("right", memory, outstanding);
        let cached = memories.add_cached_client("cached", memory, outstanding, "cache", &cache);
        let read = memories.add_client("read", memory, outstanding);
        let left = memories.add_client("left", memory, outstanding);
        Self {
            count: Stage::new("count", Count(0, 400)),
            numbers: Fifo::new("numbers", depth, 1),
            filter: Stage::new("filter", Filter),
            left: Fifo::new("left", depth, 2),
            right: Fifo::new("right", depth, 1),
            writers: ["left writer", "right writer"].map(|name| Stage::new(name, Write)),
            memories,
            clients: [vec![cached, read], vec![left], vec![right]],
        }
    }
}

impl Machine for Bench {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let (m, [filter, left, right]) = (&mut self.memories, &self.clients);
        let [left_writer, right_writer] = &mut self.writers;
        v.stage(self.count.between((), &mut self.numbers));
        v.stage(self.filter.between(&mut self.numbers, (&mut self.left, &mut self.right)).using(m, filter));
        v.stage(left_writer.between(&mut self.left, ()).using(m, left));
        v.stage(right_writer.between(&mut self.right, ()).using(m, right));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

#[test]
fn both_engines_agree_when_steps_overtake() {
    for depth in [1, 3, 16, 64] {
        for cl in [0, 6, 60] {
            for outstanding in [1, 2, 8, 32] {
                let [timed, ticked] =
                    [Engine::Timed, Engine::Ticked].map(|engine| run(&mut Bench::new(depth, cl, outstanding), engine));
                assert_eq!(timed, ticked, "depth {depth}, cl {cl}, outstanding {outstanding}");
            }
        }
    }
}
