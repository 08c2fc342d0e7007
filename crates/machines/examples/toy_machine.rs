//! A complete machine of two units, from its parameters to its report.
//!
//! ```text
//!   counter --numbers--> divider
//! ```
//!
//! The counter emits 2, 3, 4 and so on; the divider finds the least divisor of each number by trial. Run it with parameters as
//! `KEY=VALUE`: `cargo run -p basrelief-machines --example toy_machine last=1000 division=4`.

use basrelief_kernel::{Demand, Engine, Fifo, Machine, MemoryPorts, MemorySystem, RunReport, Stage, Step, Unit, Visitor, run};
use basrelief_parameters::{load, parameters};
use std::fmt::Write;

parameters! {
    /// All parameters of the machine.
    pub struct ToyConfig {
        /// Last number that the counter emits.
        last: u32 = 30, unit: "", Assumed("primes enough for the counter to be held up"), range: 2..=1_000_000;
        /// One trial division.
        division: u32 = 2, unit: "cycles", Assumed("any will do"), range: 1..=1024;
        /// FIFO between counter and divider.
        depth: u32 = 4, unit: "slots", Assumed("any will do"), range: 1..=1024;
    }
}

/// Emits one number per cycle.
struct Counter {
    next: u32,
    last: u32,
}

impl Unit for Counter {
    type In = ();
    type Out = Option<u32>;

    fn demand(&self) -> Demand {
        if self.next <= self.last { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), _: &mut MemoryPorts) -> Step<Option<u32>> {
        self.next += 1;
        Step::after(1, Some(self.next - 1))
    }
}

/// Finds least divisors. A step takes the time of all trial divisions of its number.
struct Divider {
    cycles_per_division: u32,
    primes: Vec<u32>,
}

impl Unit for Divider {
    type In = Option<u32>;
    type Out = ();

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, number: Option<u32>, _: &mut MemoryPorts) -> Step<()> {
        let Some(number) = number else { return Step::after(0, ()) };
        let divisor = (2..=number).find(|d| number % d == 0).unwrap_or(number);
        if divisor == number {
            self.primes.push(number);
        }
        let cycles = u64::from(divisor - 1) * u64::from(self.cycles_per_division);
        Step::after(cycles, ()).busy(cycles)
    }
}

/// The machine: its stages and its FIFO. It has no memories.
struct Toy {
    counter: Stage<Counter>,
    numbers: Fifo<u32>,
    divider: Stage<Divider>,
    memories: MemorySystem,
}

impl Toy {
    fn new(config: &ToyConfig) -> Self {
        Self {
            counter: Stage::new("counter", Counter { next: 2, last: config.last }),
            numbers: Fifo::new("numbers", config.depth as usize, 1),
            divider: Stage::new("divider", Divider { cycles_per_division: config.division, primes: vec![] }),
            memories: MemorySystem::default(),
        }
    }
}

impl Machine for Toy {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        v.stage(self.counter.between((), &mut self.numbers));
        v.stage(self.divider.between(&mut self.numbers, ()));
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}

/// Prints the cycle breakdown of each unit.
fn table(report: &RunReport) -> String {
    let mut text = format!("{:<8} {:>6} {:>6} {:>8} {:>8} {:>6}\n", "unit", "steps", "busy", "starved", "blocked", "done");
    for unit in &report.units {
        let (account, sum) = (&unit.account, |cycles: &[u64]| cycles.iter().sum::<u64>());
        let (starved, blocked) = (sum(&account.starved), sum(&account.blocked));
        let (name, steps, busy, done) = (&unit.name, unit.steps, account.busy, account.done);
        let _ = writeln!(text, "{name:<8} {steps:>6} {busy:>6} {starved:>8} {blocked:>8} {done:>6}");
    }
    text + &format!("{} cycles\n", report.total)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let settings: Vec<(&str, &str)> = arguments.iter().filter_map(|a| a.split_once('=')).collect();
    let mut machine = Toy::new(&load::<ToyConfig>("", &settings)?);
    let report = run(&mut machine, Engine::Timed);
    println!("{}primes: {:?}", table(&report), machine.divider.unit.primes);
    Ok(())
}

#[test]
fn toy_machine_matches_the_table_computed_by_hand() {
    let config = load::<ToyConfig>("", &[("last", "7"), ("depth", "2")]).expect("a configuration");
    // 2 to 7 take 1, 2, 1, 4, 1, 6 trial divisions of 2 cycles: from cycle 2, when the first number is visible, to 31. Of the
    // counter's steps, the last starts in the cycle after the pop of 5, in cycle 11; it waits for slots in 2, 4, 6 to 8 and 10.
    let mut machines = [Toy::new(&config), Toy::new(&config)];
    let [timed, ticked] = &mut machines;
    let report = run(timed, Engine::Timed);
    assert_eq!(report, run(ticked, Engine::Ticked));
    assert_eq!(timed.divider.unit.primes, [2, 3, 5, 7]);
    assert_eq!(
        table(&report),
        "unit      steps   busy  starved  blocked   done\n\
         counter       6      6        0        6     20\n\
         divider       6     30        2        0      0\n\
         32 cycles\n"
    );
}
