//! `basrelief run --from`: renders the scene of a server.

use super::real_times::RealTimes;
use super::simulate::{RunSource, Simulation};
use crate::args::{MachineArgs, RunArgs};
use crate::error::{CommandError, CommandResult};
use crate::global::GlobalOptions;
use crate::input::{self, ResolvedView};
use crate::interrupt;
use crate::outputs::{PartialFile, remove_remains};
use crate::progress::{InputProgress, Progress, TileProgress};
use crate::terminal;
use basrelief_deferred_renderer::TileSource;
use basrelief_input::MemoryPool;
use basrelief_scene::ViewOptions;
use basrelief_sim::{MACHINES, MachineConfig, Overrides, PreparedScene, RunInput, TileFetch};
use basrelief_tile_server::client::{Fetcher, RemoteTiles, RetryPolicy, TileCache, TileStore};
use basrelief_tile_server::preview::{LivePreview, PreviewedTiles};
use basrelief_tile_server::protocol::{GroupHashes, ReceivedScene, scene_path, unpack};
use std::io::{self, Write as _};
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Returns the parameters of the machine; only some machines can render from a server.
fn config_of(args: &RunArgs, look: &ResolvedView, budget: &MemoryPool) -> CommandResult<(MachineConfig, Overrides)> {
    let fetching = || MACHINES.iter().filter(|m| m.fetches_tiles);
    let Some(machine) = args.machine.machine.or_else(|| fetching().next()).filter(|m| m.fetches_tiles) else {
        let names: Vec<String> = fetching().map(|m| format!("`{}`", m.name)).collect();
        return Err(CommandError::Usage(format!("--from: only machine {} can render from a server", names.join(", "))));
    };
    let machine = MachineArgs { machine: Some(machine), ..args.machine.clone() };
    input::config(&look.with_view_times(&machine, None)?, None, budget)
}

/// Fetches the scene of a server and applies the view. Returns it with the hashes of its tiles. Their memory stays reserved until the
/// end of the program.
fn scene_of(
    fetcher: &Fetcher,
    fetch: &TileFetch,
    view: &ViewOptions,
    shown: &TileProgress,
    budget: &MemoryPool,
) -> CommandResult<(PreparedScene, GroupHashes)> {
    let address = scene_path(fetch.format);
    let (url, body, _held) = fetcher.scene(&address, |bytes| shown.scene(bytes)).map_err(CommandError::BadInput)?;
    let ReceivedScene { subject, hashes, held } = unpack(&body, &url, budget).map_err(CommandError::BadInput)?;
    held.keep_forever();
    let (scene, held) = subject.seen_within(view, budget).map_err(CommandError::bad_input)?;
    held.keep_forever();
    Ok((Arc::new(scene).into(), hashes))
}

/// Opens the folder of `--tile-cache` for a server.
fn open_cache(folder: &Path, url: &str) -> CommandResult<TileCache> {
    let cache = TileCache::open(folder, url, write_tile).map_err(CommandError::at_file(folder, "be written"))?;
    remove_remains(folder);
    Ok(cache)
}

fn write_tile(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = PartialFile::create_in_folder(path)?;
    file.write_all(bytes)?;
    file.publish()
}

/// Renders from the server at `url`.
pub fn run_from(url: &str, args: &RunArgs, global: &GlobalOptions) -> CommandResult {
    let budget = &global.budget;
    let look = input::resolve_view(&args.view, budget)?;
    let mut simulation = Simulation::new(&args.simulation, config_of(args, &look, budget)?, global);
    simulation.options.exact = false;
    let config = &simulation.options.config;
    let fetch = config.tile_fetch().ok_or_else(|| CommandError::Usage("--from: this machine does not fetch tiles".into()))?;
    let shown = TileProgress::new(simulation.is_quiet());
    let retry = args
        .wait
        .map_or_else(RetryPolicy::default, |s| RetryPolicy { starting: Duration::from_secs(s), ..RetryPolicy::default() });
    let fetcher = Fetcher::new(url, retry, budget);
    let (scene, hashes) = scene_of(&fetcher, &fetch, &look.view, &shown, budget)?;
    let cache = args.tile_cache.as_deref().map(|folder| open_cache(folder, url)).transpose()?;
    let has_cache = cache.is_some();
    if has_cache {
        interrupt::set_message("interrupted; only tiles in --tile-cache were written");
    }
    let failed = Arc::new(OnceLock::new());
    let kept = cache.map(|cache| TileStore { cache, failed: Arc::clone(&failed) });
    let interrupted = match has_cache {
        true => "interrupted; only the images shown so far and the tiles in --tile-cache were written",
        false => "interrupted; only the images shown so far were written",
    };
    let real = RealTimes::new(fetcher.metrics().clone(), shown.clone(), interrupted);
    let (tiles, watched) = (Box::new(RemoteTiles::new(fetcher, fetch, hashes, kept, Arc::new(shown))), LivePreview::default());
    let tiles = match config.preview().filter(|_| args.simulation.watch.is_some()) {
        Some(preview) => Box::new(PreviewedTiles::new(tiles, watched.clone(), preview)),
        None => tiles as Box<dyn TileSource>,
    };
    let input = RunInput::Remote { scene, tiles, name: url.into() };
    let progress = InputProgress { bar: Progress::new(None, "commands", true), read: None };
    let done = simulation.run(RunSource { input, progress, real: Some(real), watched }, None);
    if let (Some(why), Some(folder), false) = (failed.get(), &args.tile_cache, global.quiet) {
        terminal::print_note(&format!(
            "warning: --tile-cache {}: cannot be written: {why}; some tiles are not cached",
            folder.display()
        ));
    }
    done
}
