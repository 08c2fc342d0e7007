//! Two users of one memory, one of them behind a cache.
//!
//! ```text
//!   left numbers --a--> table reader --+
//!                            | cache   |
//!                            +---------+-- memory
//!   right numbers --b--> log writer ---+
//! ```
//!
//! The reader requests one line eight times. One look-up misses, and the others wait for the same fill. The writer sends 16 bytes for
//! each of its numbers.

use basrelief_kernel::Source;
use basrelief_kernel::*;

/// Looks a number up in a table, or logs it.
enum User {
    Reads,
    Writes,
}

impl Unit for User {
    type In = Option<u64>;
    type Out = ();
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, number: Option<u64>, traffic: &mut MemoryPorts) -> Step<()> {
        let number = number.unwrap_or_default();
        match self {
            User::Reads => traffic.look_up(0, 4 * number, 4),
            User::Writes => traffic.write(0, 4096 + 16 * number, 16),
        }
        Step::after(1, ())
    }
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }
}

struct Shared {
    numbers: [Stage<Source<std::ops::Range<u64>>>; 2],
    fifos: [Fifo<u64>; 2],
    users: [Stage<User>; 2],
    memories: MemorySystem,
    clients: [usize; 2],
}

impl Machine for Shared {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        for i in 0..2 {
            v.stage(self.numbers[i].between((), &mut self.fifos[i]));
            v.stage(self.users[i].between(&mut self.fifos[i], ()).using(&mut self.memories, &self.clients[i..=i]));
        }
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Runs the machine. Returns the traffic of the memory and the results of the look-ups.
pub fn text() -> String {
    let mut memories = MemorySystem::default();
    let memory = memories.add_memory("memory", &MemoryConfig::default());
    let reader = memories.add_cached_client("table", memory, 8, "cache", &CacheConfig::default());
    let clients = [reader, memories.add_client("log", memory, 8)];
    let numbers = ["left numbers", "right numbers"].map(|name| Stage::new(name, Source::new(0..8)));
    let users = [Stage::new("table reader", User::Reads), Stage::new("log writer", User::Writes)];
    let fifos = ["a", "b"].map(|name| Fifo::new(name, 4, 1));
    let report = run(&mut Shared { numbers, fifos, users, memories, clients }, Engine::Timed);
    let ports = report.memories[0].ports.iter().map(|p| (&p.client, p.counts));
    let lines = ports.map(|(name, c)| format!("{name}: {} reads, {} writes, {} bursts\n", c.reads, c.writes, c.rows.bursts()));
    let c = report.caches[0].counts;
    lines.collect::<String>() + &format!("cache: {} hits, {} misses, {} merged\n", c.hits, c.misses, c.merged)
}

fn main() {
    print!("{}", text());
}
