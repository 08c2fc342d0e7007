//! Host speed of a machine on a trace, with the timed engine and the functional model.

use basrelief_kernel::Engine;
use basrelief_machines::{ConfigProblem, FrontEnd, PictureMachine};
use basrelief_parameters::Parameters;
use basrelief_signals::Control;
use std::time::Instant;

/// Loads the machine's defaults with the settings of the command line.
pub fn config<C: Parameters>() -> Result<C, String> {
    let settings: Vec<String> = std::env::args().skip(1).collect();
    let settings: Vec<(&str, &str)> = settings.iter().filter_map(|s| s.split_once('=')).collect();
    basrelief_parameters::load("", &settings).map_err(|e| e.to_string())
}

/// Creates a front end that replays these commands.
pub fn replay<'a, C>(controls: &[Control], config: &'a C) -> FrontEnd
where
    basrelief_machines::FrontConfig: From<&'a C>,
{
    let commands: Vec<_> = controls.iter().map(|control| Ok((control.clone(), None))).collect();
    FrontEnd::of_trace(commands.into_iter(), config)
}

/// Runs the timed engine and the functional model, and prints the elements per second. `figure` is the number of elements.
pub fn print_speed<M: PictureMachine>(
    machine: impl Fn() -> Result<M, ConfigProblem>,
    figure: &str,
    elements: &str,
) -> Result<(), String> {
    let machine = || machine().map_err(|e| e.to_string());
    let mut timed = machine()?;
    let began = Instant::now();
    let report = timed.run(Engine::Timed);
    let timed_s = began.elapsed().as_secs_f64();
    let mut functional = machine()?;
    let began = Instant::now();
    functional.run_functional(&mut |_| true)?;
    let functional_s = began.elapsed().as_secs_f64();
    let count = timed.facts().count(figure);
    println!("{:?}: {count} {elements}, {} cycles", report.outcome, report.total);
    for (name, seconds) in [("timed", timed_s), ("functional", functional_s)] {
        println!("{name}: {seconds:.3} s, {:.2} M {elements}/s", count as f64 / seconds * 1e-6);
    }
    Ok(())
}
