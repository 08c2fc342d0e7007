//! Labels: the steps reported to a probe that requests labels.

use basrelief_kernel::{
    Cycle, Demand, Engine, Fifo, Label, Machine, MemoryPorts, MemorySystem, Probe, RunLimits, Stage, StallCause, Step, Unit,
    Visitor, run_with,
};
use basrelief_kernel::{Sink, Source};

/// Adds pairs of neighbours: every other step emits a sum.
#[derive(Default)]
struct Pairs(Option<u64>);

impl Unit for Pairs {
    type In = Option<u64>;
    type Out = Option<u64>;
    fn demand(&self) -> Demand {
        Demand::All
    }
    fn step(&mut self, number: Option<u64>, _: &mut MemoryPorts) -> Step<Option<u64>> {
        let sum = self.0.take().zip(number).map(|(a, b)| a + b);
        self.0 = if sum.is_none() { number } else { None };
        Step::after(1, sum).busy(3)
    }
}

struct Sums {
    source: Stage<Source<std::ops::Range<u64>>>,
    numbers: Fifo<u64>,
    pairs: Stage<Pairs>,
    sums: Fifo<u64>,
    sink: Stage<Sink<u64>>,
    memories: MemorySystem,
}

impl Machine for Sums {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.source.between((), &mut self.numbers));
        v.stage(self.pairs.between(&mut self.numbers, &mut self.sums));
        v.stage(self.sink.between(&mut self.sums, ()));
    }
    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Reports per stage, in order.
#[derive(Default, PartialEq, Debug)]
struct ProbedSteps {
    asks: bool,
    steps: [Vec<(u32, Vec<u64>)>; 3],
    worked: [usize; 3],
    /// Number of intervals reported before their step.
    early: usize,
}

impl Probe for ProbedSteps {
    fn reads_labels(&self) -> bool {
        self.asks
    }
    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        assert_eq!(asked, 0, "there is no memory");
        assert!(given.iter().all(|(output, label)| *output == 0 && label.0[1..] == [0; 2]));
        self.steps[stage].push((taken, given.iter().map(|(_, label)| label.0[0]).collect()));
    }
    fn on_busy(&mut self, stage: usize, _: Cycle, _: Cycle) {
        self.worked[stage] += 1;
        self.early += usize::from(self.asks && self.worked[stage] > self.steps[stage].len());
    }
    fn on_stall(&mut self, _: usize, _: StallCause, _: Cycle, _: Cycle) {}
}

fn probed_steps(engine: Engine, asks: bool) -> ProbedSteps {
    let numbers = |n: &u64| Label([100 + n, 0, 0]);
    let mut machine = Sums {
        source: Stage::new("source", Source::new(0..4)),
        numbers: Fifo::new("numbers", 1, 1).labelled(numbers),
        pairs: Stage::new("pairs", Pairs::default()),
        sums: Fifo::new("sums", 2, 1).labelled(|sum| Label([*sum, 0, 0])),
        sink: Stage::new("sink", Sink::new()),
        memories: MemorySystem::default(),
    };
    let mut reported = ProbedSteps { asks, ..ProbedSteps::default() };
    run_with(&mut machine, engine, Some(&mut reported), RunLimits { max_cycles: u64::MAX, progress: &mut |_| true });
    reported
}

#[test]
fn label_probe_receives_each_step_ahead_of_its_time() {
    for engine in [Engine::Timed, Engine::Ticked] {
        let reported = probed_steps(engine, true);
        assert_eq!(reported.steps[0], [100, 101, 102, 103].map(|label| (0, vec![label])));
        assert_eq!(reported.steps[1], [(1, vec![]), (1, vec![1]), (1, vec![]), (1, vec![5])]);
        assert_eq!(reported.steps[2], [(1, vec![]), (1, vec![])]);
        assert_eq!((reported.worked, reported.early), ([4, 4, 2], 0));
    }
}

#[test]
fn probe_without_labels_receives_times_only() {
    let reported = probed_steps(Engine::Timed, false);
    assert_eq!((reported.steps, reported.worked), (Default::default(), [4, 4, 2]));
}
