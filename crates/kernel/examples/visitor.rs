//! A visitor of one's own: it prints the block diagram of any machine, one box per line.
//!
//! ```text
//!   source --numbers--> fork --even--> even sink
//!                          \--odd--> odd sink
//! ```
//!
//! A machine shows itself to a visitor; the engines are visitors like this one.

use basrelief_kernel::{BoundStage, Demand, Fifo, Machine, MemoryPorts, MemorySystem, Stage, Step, Unit, Visitor, Wires};
use basrelief_kernel::{Sink, Source};

/// Hands even numbers to the left and odd ones to the right.
struct Fork;

impl Unit for Fork {
    type In = Option<u64>;
    type Out = (Option<u64>, Option<u64>);
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, number: Option<u64>, _: &mut MemoryPorts) -> Step<Self::Out> {
        let even = number.is_some_and(|n| n % 2 == 0);
        Step::after(1, if even { (number, None) } else { (None, number) })
    }
}

struct Sorter {
    source: Stage<Source<std::ops::Range<u64>>>,
    numbers: Fifo<u64>,
    fork: Stage<Fork>,
    even: Fifo<u64>,
    odd: Fifo<u64>,
    sinks: [Stage<Sink<u64>>; 2],
    memories: MemorySystem,
}

impl Machine for Sorter {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        let [even_sink, odd_sink] = &mut self.sinks;
        v.stage(self.source.between((), &mut self.numbers));
        v.stage(self.fork.between(&mut self.numbers, (&mut self.even, &mut self.odd)));
        v.stage(even_sink.between(&mut self.even, ()));
        v.stage(odd_sink.between(&mut self.odd, ()));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Writes one line per stage: what it pops from, its name, what it pushes to.
struct Diagram(String);

impl Visitor for Diagram {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let names = |wires: &dyn Wires| (0..wires.count()).map(|i| format!("--{}-->", wires.link(i).name())).collect::<Vec<_>>();
        let (inputs, outputs) = (names(&connections.inputs), names(&connections.outputs));
        self.0 += format!("{} [{}] {}", inputs.join(" "), stage.name(), outputs.join(" ")).trim();
        self.0 += "\n";
    }
}

/// The diagram.
pub fn text() -> String {
    let fifo = |name: &str| Fifo::new(name, 2, 1);
    let sinks = ["even sink", "odd sink"].map(|name| Stage::new(name, Sink::new()));
    let (source, fork) = (Stage::new("source", Source::new(0..4)), Stage::new("fork", Fork));
    let (numbers, even, odd, memories) = (fifo("numbers"), fifo("even"), fifo("odd"), MemorySystem::default());
    let mut diagram = Diagram(String::new());
    Sorter { source, numbers, fork, even, odd, sinks, memories }.wire(&mut diagram);
    diagram.0
}

fn main() {
    print!("{}", text());
}
