//! The engines: three ways to run the same unit code.

mod functional;
mod ticked;
mod timed;
mod work;

use crate::check::check_wiring;
use crate::report::RunReport;
use crate::shape::Shape;
use crate::time::Time;
use crate::wiring::Machine;
use crate::{Cycle, Probe, Traffic};
use work::Survey;

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
    let mut time = Time::new(Shape::of(machine));
    let halt = match engine {
        Engine::Timed => timed::run(machine, &mut time, probe, limits),
        Engine::Ticked => ticked::run(machine, &mut time, probe, limits),
    };
    let mut rests = Survey::default();
    machine.wire(&mut rests);
    let report = time.conclude(&rests.0, halt);
    *machine.memories() = time.memories;
    report
}

/// Runs the same steps without time, with memories that answer at once: the functional model (law 6). Returns the
/// fault, if a unit raised one or the wiring is wrong.
pub fn run_functional<M: Machine>(machine: &mut M, progress: &mut dyn FnMut(&mut M) -> bool) -> Result<(), String> {
    check_wiring(machine).map_err(|error| error.to_string())?;
    functional::run(machine, progress)
}

/// Shows the machine to who looks on, with its memories as they are by now: they are the engine's while it runs.
fn look<M: Machine>(machine: &mut M, time: &mut Time, progress: &mut dyn FnMut(&mut M) -> bool) -> bool {
    std::mem::swap(machine.memories(), &mut time.memories);
    let goes_on = progress(machine);
    std::mem::swap(machine.memories(), &mut time.memories);
    goes_on
}

/// A fault, prefixed with the unit that raised it and, where there is time, the cycle in which its step started.
fn fault_of(traffic: &mut Traffic, name: &str, start: Option<Cycle>) -> Option<String> {
    let cycle = start.map_or_else(String::new, |start| format!(", {start}"));
    traffic.fault.take().map(|f| format!("{name}{cycle}: {f}"))
}
