//! Figure 6: loading or synthesis of the tiles in the tile load list (136).

use crate::TexturePage;
use serde::{Deserialize, Serialize};

/// State of a tile in the tile load list (136), 2 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TileState {
    /// N: not present.
    #[default]
    NotPresent,
    /// L: to be loaded.
    Load,
    /// E: exists.
    Exists,
}

impl TileState {
    /// Returns the patent's letter.
    pub fn letter(self) -> char {
        match self {
            Self::NotPresent => 'N',
            Self::Load => 'L',
            Self::Exists => 'E',
        }
    }
}

/// Origin of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TileOrigin {
    /// Loaded over the path.
    Loaded,
    /// Averaged from its sources in the layer below it (the next finer one).
    Synthesized,
}

/// A tile to be acquired.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AcquiredTile {
    /// Number of the tile in its texture.
    pub tile: u32,
    /// Origin of the tile.
    pub how: TileOrigin,
}

/// Tile load list (136) of one page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileList {
    states: Vec<TileState>,
    /// Number of tiles in state L.
    waiting: u32,
}

impl TileList {
    /// Creates a list with all tiles in state N.
    pub fn new(tiles: u32) -> Self {
        Self { states: vec![TileState::NotPresent; tiles as usize], waiting: 0 }
    }

    /// Returns the states in order of tile number.
    pub fn states(&self) -> &[TileState] {
        &self.states
    }

    /// Marks a tile: N becomes L. E stays E (taken literally, steps \[0100\], \[0148\] would load it anew). Returns true if the
    /// state was N.
    #[inline]
    pub fn mark(&mut self, tile: u32) -> bool {
        let state = &mut self.states[tile as usize];
        let new = *state == TileState::NotPresent;
        if new {
            *state = TileState::Load;
            self.waiting += 1;
        }
        new
    }

    /// Cancels the acquisition of a tile: E becomes N again.
    pub fn abandon(&mut self, tile: u32) {
        self.states[tile as usize] = TileState::NotPresent;
    }

    /// Begins a new viewpoint: L becomes N again.
    pub fn forget(&mut self) {
        for state in self.states.iter_mut().filter(|s| **s == TileState::Load) {
            *state = TileState::NotPresent;
        }
        self.waiting = 0;
    }

    /// Runs Figure 6: from layer Dmax down to 0, every tile in state L is loaded, or synthesized if all its sources exist. Its
    /// state becomes E. The result is in order: a tile follows its sources.
    ///
    /// A layer ends before the first tile of the next finer one (the text says behind it).
    pub fn acquire(&mut self, page: &TexturePage) -> Vec<AcquiredTile> {
        let mut all = Vec::new();
        if self.waiting == 0 {
            return all;
        }
        for layer in page.layers.iter().rev() {
            for tile in layer.base..layer.base + layer.pitch * layer.rows {
                if self.states[tile as usize] != TileState::Load {
                    continue;
                }
                let sources = page.sources(tile);
                let exist = |t: &u32| self.states[*t as usize] == TileState::Exists;
                let how =
                    if !sources.is_empty() && sources.iter().all(exist) { TileOrigin::Synthesized } else { TileOrigin::Loaded };
                self.states[tile as usize] = TileState::Exists;
                all.push(AcquiredTile { tile, how });
            }
        }
        self.waiting = 0;
        all
    }
}
