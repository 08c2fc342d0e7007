//! `basrelief run` and `basrelief demo`.

use super::from::run_from;
use super::sensitivity::prepare_analysis;
use super::simulate::{RunSource, Simulation, spare_inputs};
use super::tables::{ablate, compare_methods};
use crate::args::{DemoArgs, RunArgs};
use crate::error::{CommandError, CommandResult};
use crate::global::GlobalOptions;
use crate::input::{self, Input};
use crate::progress::{InputProgress, Progress};
use crate::scene_input::{demo_of, open_scene, scene_error};
use basrelief_sim::{MACHINES, RunInput};
use basrelief_tile_server::preview::LivePreview;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Draws a demo scene.
pub fn demo(args: &DemoArgs, global: &GlobalOptions) -> CommandResult {
    spare_inputs(&args.simulation, None, &args.machine, &args.view)?;
    let machine = args.machine.machine.unwrap_or(&MACHINES[0]);
    let name = args.name.as_deref().unwrap_or(machine.demos[0]);
    let look = input::resolve_view(&args.view, &global.budget)?;
    // Settings are checked first, because a large scene takes seconds.
    let machine = input::config(&look.with_view_times(&args.machine, Some(name))?, Some(name), &global.budget)?;
    let path = PathBuf::from(format!("demo:{name}"));
    let scene = open_scene(&path, &look.view, global).map_err(scene_error(&path))?;
    simulate(Input::Scene(scene.into()), Simulation::new(&args.simulation, machine, global))
}

/// Draws a model or replays a trace.
pub fn run(args: &RunArgs, global: &GlobalOptions) -> CommandResult {
    spare_inputs(&args.simulation, args.input.as_deref(), &args.machine, &args.view)?;
    if let Some(url) = &args.from {
        return run_from(url, args, global);
    }
    // The parser does not require --from here, because INPUT excludes it.
    for (option, given) in [("--tile-cache", args.tile_cache.is_some()), ("--wait", args.wait.is_some())] {
        if given {
            return Err(CommandError::Usage(format!("{option}: applies to the scene of a server only; add --from URL")));
        }
    }
    let path = args.input.as_deref().unwrap_or(Path::new("-"));
    let look = input::resolve_view(&args.view, &global.budget)?;
    let machine = input::config(&look.with_view_times(&args.machine, demo_of(path))?, demo_of(path), &global.budget)?;
    let input = input::open_seen(path, &look.view, global)?;
    simulate(input, Simulation::new(&args.simulation, machine, global))
}

fn simulate(input: Input, simulation: Simulation<'_>) -> CommandResult {
    let budget = &simulation.global.budget;
    if simulation.args.ablate {
        return ablate(&input.for_several_runs(budget), &simulation);
    }
    if simulation.args.compare_methods {
        return compare_methods(&input.for_several_runs(budget), &simulation);
    }
    let quiet = simulation.is_quiet();
    if simulation.args.sensitivity {
        let input = input.for_several_runs(budget);
        let around = prepare_analysis(&input, &simulation.options)?;
        return simulation.run(source_of(input, quiet), Some(around));
    }
    simulation.run(source_of(input, quiet), None)
}

fn source_of(input: Input, quiet: bool) -> RunSource {
    let (input, progress) = match input {
        Input::Scene(prepared) => {
            let scene = prepared.scene();
            let per_frame: usize = 2 + scene.objects.iter().map(|o| o.mesh.indices.len() / 3 + 1).sum::<usize>();
            let bar = Progress::new(Some((per_frame * scene.frames.len()) as u64), "draw commands", quiet);
            (RunInput::Scene(prepared), InputProgress { bar, read: None })
        }
        Input::Trace(trace) => {
            let (bar, read) = (Progress::new(trace.bytes, "bytes", quiet), Some(Rc::clone(&trace.read)));
            (trace.into_source(), InputProgress { bar, read })
        }
    };
    RunSource { input, progress, real: None, watched: LivePreview::default() }
}
