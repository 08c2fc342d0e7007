//! A unit in Rust: adds pairs of numbers in four cycles, passes the unit contract, and runs between a source and a sink.
//!
//! ```text
//!   source --numbers--> adder --sums--> sink
//! ```
//!
//! Run it with `cargo run -p basrelief-kernel-conformance --example unit`.

use basrelief_kernel::{Demand, Engine, Fifo, Machine, MemoryPorts, MemorySystem, Sink, Source, Stage, Step, Unit, Visitor, run};
use basrelief_kernel_conformance::contract::Contract;

/// Adds each number to the one before it.
#[derive(Clone, Default)]
struct Adder {
    /// The number that waits for its partner.
    pending: Option<u64>,
}

impl Unit for Adder {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    /// Stores the first number of a pair in one cycle. Adds the second one in four, and delivers the sum three cycles after
    /// the start.
    fn step(&mut self, number: Option<u64>, _: &mut MemoryPorts) -> Step<Option<u64>> {
        match (self.pending.take(), number) {
            (Some(first), Some(second)) => Step::after(3, Some(first + second)).busy(4),
            (_, number) => {
                self.pending = number;
                Step::after(1, None)
            }
        }
    }
}

struct Pairs {
    source: Stage<Source<std::ops::Range<u64>>>,
    numbers: Fifo<u64>,
    adder: Stage<Adder>,
    sums: Fifo<u64>,
    sink: Stage<Sink<u64>>,
    memories: MemorySystem,
}

impl Machine for Pairs {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.source.between((), &mut self.numbers));
        v.stage(self.adder.between(&mut self.numbers, &mut self.sums));
        v.stage(self.sink.between(&mut self.sums, ()));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    Contract::new(Adder::default(), (0..100).collect(), |unit| unit.pending, |unit, pending| unit.pending = pending)
        .check_all()?;
    println!("The adder passes the unit contract.");

    let mut machine = Pairs {
        source: Stage::new("source", Source::new(0..8)),
        numbers: Fifo::new("numbers", 2, 1),
        adder: Stage::new("adder", Adder::default()),
        sums: Fifo::new("sums", 2, 1),
        sink: Stage::new("sink", Sink::new()),
        memories: MemorySystem::default(),
    };
    let report = run(&mut machine, Engine::Timed);
    println!("Sums: {:?} in {} cycles", machine.sink.unit.tokens(), report.total);
    for unit in &report.units {
        let account = &unit.account;
        let (starved, blocked) = (account.starved[0], account.blocked[0]);
        println!("{:6} busy {:2}, starved {starved:2}, blocked {blocked:2}", unit.name, account.busy);
    }
    Ok(())
}
