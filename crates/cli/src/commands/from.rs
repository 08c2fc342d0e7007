//! `basrelief run --from`: renders what a server offers.

use super::simulate::{seconds, settings_of, simulate_source};
use crate::args::{MachineArgs, RunArgs, ViewArgs};
use crate::error::{Done, Failure};
use crate::input;
use crate::interrupt;
use crate::progress::{Progress, TileProgress};
use crate::remote::{Fetcher, Kept, Patience, RemoteTiles, TileCache};
use basrelief_session::{MachineConfig, MachineInfo, Source};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// The configuration of the machine; other machines, and a view, are refused.
fn config_of(args: &RunArgs) -> Done<MachineConfig> {
    if args.machine.machine.is_some_and(|m| m.name != "defer") {
        return Err(Failure::Usage("--from: only machine `defer` renders from a server".into()));
    }
    if args.view != ViewArgs::default() {
        return Err(Failure::Usage(
            "--from: the server has the view; give --size, --camera, --frames and --orbit to serve".into(),
        ));
    }
    let machine = MachineArgs { machine: Some(MachineInfo::named("defer").map_err(Failure::Usage)?), ..args.machine.clone() };
    input::config(&machine, None)
}

/// Renders from the server at `url`.
pub fn run_from(url: &str, args: &RunArgs, quiet: bool) -> Done {
    let began = seconds();
    let config = config_of(args)?;
    let MachineConfig::Defer(device) = &config else { return Err(Failure::Usage("--from: needs machine defer".into())) };
    let shown = TileProgress::new(quiet || args.simulation.json);
    let mut fetcher = Fetcher::new(url, Patience::default());
    let (polygons, textures) = fetcher.polygons(|bytes| shown.polygons(bytes)).map_err(Failure::Bad)?;
    let open = |folder: &PathBuf| TileCache::open(folder, &textures).map_err(Failure::file(folder, "be written"));
    let cache = args.tile_cache.as_ref().map(open).transpose()?;
    if cache.is_some() {
        interrupt::say("interrupted; nothing was written but the tiles in --tile-cache");
    }
    let failed = Arc::new(OnceLock::new());
    let kept = cache.map(|cache| Kept { cache, failed: Arc::clone(&failed) });
    let encoding = (device.tile.encoding, device.tile.jpeg_quality);
    let tiles = Box::new(RemoteTiles::new(fetcher, encoding, device.path.requests, kept, shown));
    let source = Source::Remote { reader: Box::new(Cursor::new(polygons)), name: url.into(), tiles };
    let mut settings = settings_of(config, &args.simulation);
    settings.exact = false;
    let unshown = Progress::new(None, "commands", true);
    let done = simulate_source(began, (source, unshown, None), settings, &args.simulation, quiet);
    if let (Some(why), Some(folder), false) = (failed.get(), &args.tile_cache, quiet) {
        eprintln!("warning: --tile-cache {}: cannot be written: {why}; not all tiles are kept", folder.display());
    }
    done
}
