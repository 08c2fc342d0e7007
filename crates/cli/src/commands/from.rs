//! `basrelief run --from`: renders what a server offers.

use super::simulate::{seconds, settings_of, simulate_source};
use crate::args::{MachineArgs, RunArgs, ViewArgs};
use crate::error::{Done, Failure};
use crate::input;
use crate::interrupt;
use crate::progress::{Progress, TileProgress};
use crate::remote::{Fetcher, Patience, RemoteTiles, TileCache, TileStore};
use basrelief_input::Budget;
use basrelief_session::{Given, MACHINES, MachineConfig, RunInput};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// The configuration of the machine; other machines, and a view, are refused.
fn config_of(args: &RunArgs, budget: &Budget) -> Done<(MachineConfig, Given)> {
    let fetching = || MACHINES.iter().filter(|m| m.fetches_tiles);
    let Some(machine) = args.machine.machine.or_else(|| fetching().next()).filter(|m| m.fetches_tiles) else {
        let names: Vec<String> = fetching().map(|m| format!("`{}`", m.name)).collect();
        return Err(Failure::Usage(format!("--from: only machine {} renders from a server", names.join(", "))));
    };
    if args.view != ViewArgs::default() {
        return Err(Failure::Usage(
            "--from: the server has the view; give --size, --camera, --frames and --orbit to serve".into(),
        ));
    }
    input::config(&MachineArgs { machine: Some(machine), ..args.machine.clone() }, None, budget)
}

/// Renders from the server at `url`.
pub fn run_from(url: &str, args: &RunArgs, budget: &Budget, quiet: bool) -> Done {
    let began = seconds();
    let (config, given) = config_of(args, budget)?;
    let fetch = config.tile_fetch().ok_or_else(|| Failure::Usage("--from: this machine fetches no tiles".into()))?;
    let shown = TileProgress::new(quiet || args.simulation.json);
    let mut fetcher = Fetcher::within(url, Patience::default(), budget);
    let (polygons, textures) = fetcher.polygons(|bytes| shown.polygons(bytes)).map_err(Failure::Bad)?;
    let open = |folder: &PathBuf| TileCache::open(folder, &textures).map_err(Failure::file(folder, "be written"));
    let cache = args.tile_cache.as_ref().map(open).transpose()?;
    if cache.is_some() {
        interrupt::say("interrupted; nothing was written but the tiles in --tile-cache");
    }
    let failed = Arc::new(OnceLock::new());
    let kept = cache.map(|cache| TileStore { cache, failed: Arc::clone(&failed) });
    let tiles = Box::new(RemoteTiles::new(fetcher, (fetch.encoding, fetch.jpeg_quality), fetch.requests, kept, shown));
    let source = RunInput::Remote { reader: Box::new(Cursor::new(polygons)), name: url.into(), tiles };
    let mut settings = settings_of((config, given), &args.simulation, budget);
    settings.exact = false;
    let unshown = Progress::new(None, "commands", true);
    let done = simulate_source(began, (source, unshown, None), settings, None, &args.simulation, quiet);
    if let (Some(why), Some(folder), false) = (failed.get(), &args.tile_cache, quiet) {
        eprintln!("warning: --tile-cache {}: cannot be written: {why}; not all tiles are kept", folder.display());
    }
    done
}
