//! `basrelief run` and `basrelief demo`.

use super::from::run_from;
use super::sensitivity::around;
use super::simulate::{Source, seconds, settings_of, simulate_source, spare_inputs};
use super::tables::{ablate, compare_methods};
use crate::args::{DemoArgs, RunArgs, SimulationArgs};
use crate::error::{Done, Failure};
use crate::input::{self, Input, demo_of};
use crate::progress::Progress;
use basrelief_input::Budget;
use basrelief_sim::{MACHINES, RunInput, RunOptions};
use basrelief_tile_server::preview::LivePreview;
use std::path::Path;
use std::rc::Rc;

/// Draws a demo scene.
pub fn demo(args: &DemoArgs, budget: &Budget, quiet: bool) -> Done {
    let began = seconds();
    spare_inputs(&args.simulation, None, &args.machine, &args.view)?;
    let machine = args.machine.machine.unwrap_or(&MACHINES[0]);
    let name = args.name.as_deref().unwrap_or(machine.demos[0]);
    let look = input::look(&args.view, budget)?;
    let scene = input::demo_scene(name, &look.view)?;
    let machine = look.tell(&args.machine, Some(name))?;
    let settings = settings_of(input::config(&machine, Some(name), budget)?, &args.simulation, budget);
    simulate(began, Input::Scene(scene.into()), settings, &args.simulation, quiet)
}

/// Draws a model or replays a trace.
pub fn run(args: &RunArgs, budget: &Budget, quiet: bool) -> Done {
    let began = seconds();
    spare_inputs(&args.simulation, args.input.as_deref(), &args.machine, &args.view)?;
    if let Some(url) = &args.from {
        return run_from(url, args, budget, quiet);
    }
    // The parser does not require --from here, because INPUT excludes it.
    for (option, given) in [("--tile-cache", args.tile_cache.is_some()), ("--wait", args.wait.is_some())] {
        if given {
            return Err(Failure::Usage(format!("{option}: applies to the scene of a server only; add --from URL")));
        }
    }
    let path = args.input.as_deref().unwrap_or(Path::new("-"));
    let look = input::look(&args.view, budget)?;
    let input = input::open_seen(path, &look.view, budget)?;
    let machine = look.tell(&args.machine, demo_of(path))?;
    let settings = settings_of(input::config(&machine, demo_of(path), budget)?, &args.simulation, budget);
    simulate(began, input, settings, &args.simulation, quiet)
}

fn simulate(began: f64, input: Input, settings: RunOptions, simulation: &SimulationArgs, quiet: bool) -> Done {
    if simulation.ablate {
        return ablate(&input.for_several_runs(&settings.budget), &settings, simulation, quiet);
    }
    if simulation.compare_methods {
        return compare_methods(&input.for_several_runs(&settings.budget), &settings, simulation, quiet);
    }
    if simulation.sensitivity {
        let input = input.for_several_runs(&settings.budget);
        let around = around(&input, &settings)?;
        return simulate_source(began, source_of(input, quiet || simulation.json), settings, Some(around), simulation, quiet);
    }
    simulate_source(began, source_of(input, quiet || simulation.json), settings, None, simulation, quiet)
}

fn source_of(input: Input, quiet: bool) -> Source {
    match input {
        Input::Scene(prepared) => {
            let scene = prepared.scene();
            let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
            let progress = Progress::new(Some((per_frame * scene.frames.len()) as u64), "draw commands", quiet);
            Source { input: RunInput::Scene(prepared), progress, read: None, real: None, watched: LivePreview::default() }
        }
        Input::Trace(trace) => {
            let (progress, read) = (Progress::new(trace.bytes, "bytes", quiet), Rc::clone(&trace.read));
            Source { input: trace.into_source(), progress, read: Some(read), real: None, watched: LivePreview::default() }
        }
    }
}
