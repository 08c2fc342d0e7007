//! The engines: three ways to run the same unit code.

mod functional;
mod ticked;
mod timed;

use crate::check::check_wiring;
use crate::connections::Clients;
use crate::place::Place;
use crate::report::{RunReport, conclude};
use crate::wiring::{Machine, Visitor};
use crate::{Cycle, Probe, Traffic};

/// How to run a machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// Time-stamped dataflow: every token carries its time, idle cycles are not visited.
    #[default]
    Timed,
    /// Visits every unit in every cycle: slow, obviously right; the oracle.
    Ticked,
}

/// Bounds of a run and what to do as it goes.
pub struct Limits<'a, M> {
    /// No step starts in this cycle or later; the run then ends as [`Outcome::Limit`](crate::Outcome::Limit).
    pub max_cycles: u64,
    /// Called every now and then with the machine, to show progress and to take finished results away; `false` stops
    /// the run as [`Outcome::Stopped`](crate::Outcome::Stopped).
    pub progress: &'a mut dyn FnMut(&mut M) -> bool,
}

/// Runs `machine` to its end.
pub fn run<M: Machine>(machine: &mut M, engine: Engine) -> RunReport {
    run_with(machine, engine, &mut crate::NoProbe, Limits { max_cycles: u64::MAX, progress: &mut |_| true })
}

/// Runs `machine` under a probe, within limits.
pub fn run_with<M: Machine, P: Probe>(machine: &mut M, engine: Engine, probe: &mut P, limits: Limits<'_, M>) -> RunReport {
    if let Err(error) = check_wiring(machine) {
        return RunReport::of_fault(error.to_string());
    }
    attach(machine);
    let halt = match engine {
        Engine::Timed => timed::run(machine, probe, limits),
        Engine::Ticked => ticked::run(machine, probe, limits),
    };
    conclude(machine, halt)
}

/// Runs the same steps without time, with memories that answer at once: the functional model (law 6). Returns the
/// fault, if a unit raised one or the wiring is wrong.
pub fn run_functional<M: Machine>(machine: &mut M, progress: &mut dyn FnMut(&mut M) -> bool) -> Result<(), String> {
    check_wiring(machine).map_err(|error| error.to_string())?;
    functional::run(machine, progress)
}

/// Learns what does not change, before the first step: who has which clients and needs how many credits, and which
/// memories are private.
fn attach(machine: &mut impl Machine) {
    #[derive(Default)]
    struct Attach(Vec<Vec<usize>>);
    impl Visitor for Attach {
        fn stage<P: Place>(&mut self, mut place: P) {
            let (stage, connections) = place.open();
            stage.clock.attach(&stage.unit, connections);
            self.0.push(connections.clients.ids().to_vec());
        }
    }
    let mut all = Attach::default();
    machine.wire(&mut all);
    machine.memories().find_private(&all.0);
}

/// Delivers what is known by now, for every stage; used after the last memory answers.
struct Land;
impl Visitor for Land {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        stage.clock.land_known(connections);
    }
}

/// A fault, prefixed with the unit that raised it and, where there is time, the cycle in which its step started.
fn fault_of(traffic: &mut Traffic, name: &str, start: Option<Cycle>) -> Option<String> {
    let cycle = start.map_or_else(String::new, |start| format!(", {start}"));
    traffic.fault.take().map(|f| format!("{name}{cycle}: {f}"))
}
