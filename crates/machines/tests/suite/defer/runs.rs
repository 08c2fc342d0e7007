//! Runs of a trace on both engines and the functional model.

use crate::common;
pub use crate::common::replay;
use basrelief_deferred_renderer::{FilledBuffer, TexturePage, TileList, TileOrigin, TileRecord};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::{Engine, Outcome, RunLimits, RunReport};
use basrelief_machines::defer::{DeferConfig, DeferredRenderer, FrontEnd};
use basrelief_machines::{MachineEngines as _, PictureMachine, UnitStats};
use basrelief_signals::Control;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Pictures, logs and figures of a run.
#[derive(Debug, PartialEq)]
pub struct Seen {
    /// Last pictures of their frames.
    pub finished: Vec<FinishedFrame>,
    /// Pictures that a better picture of the same frame follows.
    pub rounds: Vec<FinishedFrame>,
    pub filled: Vec<FilledBuffer>,
    /// Fates of tiles, by frame.
    pub tiles: Vec<Vec<TileRecord>>,
    pub lists: Vec<(Arc<TexturePage>, TileList)>,
    pub facts: UnitStats,
}

/// Result of a run.
pub struct Ran {
    pub report: RunReport,
    pub seen: Seen,
}

/// A tile: texture, number.
pub type Tile = (u32, u32);

impl Seen {
    pub fn count(&self, name: &str) -> u64 {
        common::count(&self.facts, name)
    }

    /// Returns the tiles of a frame that were acquired in this way; with `None`, the tiles that were reused.
    pub fn tiles(&self, frame: usize, how: Option<TileOrigin>) -> BTreeSet<Tile> {
        let tiles = self.tiles[frame].iter().filter(|r| r.acquired == how);
        tiles.map(|r| (r.page.texture, r.tile)).collect()
    }

    /// Returns all tiles acquired for a frame.
    pub fn acquired(&self, frame: usize) -> BTreeSet<Tile> {
        &self.tiles(frame, Some(TileOrigin::Loaded)) | &self.tiles(frame, Some(TileOrigin::Synthesized))
    }
}

/// Loads the default configuration with these settings.
pub fn config(settings: &[(&str, &str)]) -> DeferConfig {
    common::config(settings)
}

fn seen(mut machine: DeferredRenderer) -> Seen {
    Seen {
        finished: machine.drain_finished(),
        rounds: machine.drain_rounds(),
        filled: machine.drain_filled(),
        tiles: machine.drain_records().into_iter().map(|(_, tiles)| tiles).collect(),
        lists: machine.lists().map(|(page, list)| (Arc::clone(page), list.clone())).collect(),
        facts: machine.facts(),
    }
}

pub fn run(front: FrontEnd, config: &DeferConfig, engine: Engine) -> Ran {
    let mut machine = DeferredRenderer::new(front, config).unwrap_or_else(|e| panic!("{e}"));
    machine.keep();
    let report = machine.run_with(engine, None, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true });
    Ran { report, seen: seen(machine) }
}

/// Runs the timed engine, and asserts that the run finishes.
pub fn timed(controls: &[Control], settings: &[(&str, &str)]) -> Ran {
    let config = config(settings);
    let ran = run(replay(controls, &config), &config, Engine::Timed);
    assert_eq!(ran.report.outcome, Outcome::Complete, "{settings:?}");
    ran
}

/// Returns the results of the functional model.
pub fn functional(controls: &[Control], config: &DeferConfig) -> Seen {
    let mut machine = DeferredRenderer::new(replay(controls, config), config).unwrap_or_else(|e| panic!("{e}"));
    machine.keep();
    machine.run_functional(&mut |_| true).unwrap_or_else(|fault| panic!("{fault}"));
    seen(machine)
}
