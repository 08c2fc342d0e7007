//! Three units in a row, and their cycle breakdown.
//!
//! ```text
//!   source --numbers--> square --squares--> sink
//! ```
//!
//! Square keeps each number for 3 cycles, so the source waits for slots and the sink for tokens.

use basrelief_kernel::{Demand, Engine, Fifo, Machine, MemoryPorts, MemorySystem, Stage, Step, Unit, Visitor, run};
use basrelief_kernel::{Sink, Source};

/// Squares a number in 3 cycles, one number at a time.
struct Square;

impl Unit for Square {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, number: Option<u64>, _: &mut MemoryPorts) -> Step<Option<u64>> {
        Step::after(2, number.map(|n| n * n)).busy(3)
    }
}

struct Squares {
    source: Stage<Source<std::ops::Range<u64>>>,
    numbers: Fifo<u64>,
    square: Stage<Square>,
    squares: Fifo<u64>,
    sink: Stage<Sink<u64>>,
    memories: MemorySystem,
}

impl Machine for Squares {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.source.between((), &mut self.numbers));
        v.stage(self.square.between(&mut self.numbers, &mut self.squares));
        v.stage(self.sink.between(&mut self.squares, ()));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Runs the machine. Returns the output, and a line per unit.
pub fn text() -> String {
    let mut machine = Squares {
        source: Stage::new("source", Source::new(0..4)),
        numbers: Fifo::new("numbers", 1, 1),
        square: Stage::new("square", Square),
        squares: Fifo::new("squares", 2, 1),
        sink: Stage::new("sink", Sink::new()),
        memories: MemorySystem::default(),
    };
    let report = run(&mut machine, Engine::Timed);
    let mut text = format!("{:?} in {} cycles\n", machine.sink.unit.tokens(), report.total);
    for unit in &report.units {
        let a = &unit.account;
        let (starved, blocked) = (a.starved[0], a.blocked[0]);
        text += &format!("{:6} busy {:2}, starved {starved:2}, blocked {blocked}, done {}\n", unit.name, a.busy, a.done);
    }
    text
}

fn main() {
    print!("{}", text());
}
