//! Texels of a page in the texture-data memory (130): what is there of its pyramid (134), and how it is interpolated.

use crate::Page;
use crate::acquisition::How;
use crate::page::{Placed, Tap};
use crate::pyramid::LayerTexels;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::sync::Arc;
use wide::f32x4;

/// What became of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileHistory {
    /// How it came, and in which frame, counted from 1.
    pub acquired: Option<(How, u64)>,
    /// The last frame, counted from 1, in which a pixel was coloured from it; 0: none.
    pub needed: u64,
}

/// Tiles of one layer: what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerCounts {
    /// Tiles that came over the path.
    pub loaded: u64,
    /// Tiles averaged from those below.
    pub synthesized: u64,
    /// Tiles of an earlier frame that a frame was coloured from, frame by frame.
    pub reused: u64,
    /// Tiles that no pixel was coloured from.
    pub never_needed: u64,
}

/// Pyramid (134) of one page, as far as its tiles have come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PageTexels {
    /// The page.
    pub page: Arc<Page>,
    layers: Vec<LayerTexels>,
    history: Vec<TileHistory>,
    reused: Vec<u64>,
    /// The tile that was needed last, by layer: neighbours mostly need the same.
    last: Vec<u32>,
}

const NO_TILE: u32 = u32::MAX;

impl PageTexels {
    /// An empty page: layers take memory when their first tile comes.
    pub fn new(page: Arc<Page>) -> Self {
        let layers = vec![LayerTexels::default(); page.layers.len()];
        let history = vec![TileHistory::default(); page.tiles() as usize];
        let (reused, last) = (vec![0; page.layers.len()], vec![NO_TILE; page.layers.len()]);
        Self { page, layers, history, reused, last }
    }

    /// What became of each tile, by number.
    pub fn history(&self) -> &[TileHistory] {
        &self.history
    }

    /// What became of the tiles of a layer.
    pub fn counts(&self, layer: u8) -> LayerCounts {
        let l = &self.page.layers[usize::from(layer)];
        let tiles = &self.history[l.base as usize..(l.base + l.pitch * l.rows) as usize];
        let came = |how: How| tiles.iter().filter(|t| t.acquired.is_some_and(|a| a.0 == how)).count() as u64;
        LayerCounts {
            loaded: came(How::Loaded),
            synthesized: came(How::Synthesized),
            reused: self.reused[usize::from(layer)],
            never_needed: tiles.iter().filter(|t| t.needed == 0).count() as u64,
        }
    }

    /// Texels of a layer, where any of its tiles has come.
    pub fn layer(&self, layer: u8) -> &LayerTexels {
        &self.layers[usize::from(layer)]
    }

    /// Whether a tile is there.
    #[inline]
    pub fn exists(&self, tile: u32) -> bool {
        self.history[tile as usize].acquired.is_some()
    }

    /// Whether all tiles are there that a sample reads of a layer, and how many words of the tile load list (136), of so many entries
    /// each, tell it.
    #[inline]
    pub fn look_up(&self, layer: u8, placed: Placed, entries: u32) -> (bool, u32) {
        let tiles = self.page.marked(layer, placed);
        let mut words: SmallVec<[u32; 4]> = tiles.iter().map(|tile| tile / entries).collect();
        words.sort_unstable();
        words.dedup();
        (tiles.iter().all(|&tile| self.exists(tile)), words.len() as u32)
    }

    /// Stores a tile that has come over the path.
    pub fn store(&mut self, tile: u32, texels: &[[u8; 4]], frame: u64) {
        let layer = self.page.layer_of(tile);
        let place = self.page.texels_of(tile);
        self.room(layer).put(place, texels);
        self.history[tile as usize].acquired = Some((How::Loaded, frame));
    }

    /// Averages a tile from the next finer layer.
    pub fn synthesize(&mut self, tile: u32, frame: u64) {
        let layer = self.page.layer_of(tile);
        let place = self.page.texels_of(tile);
        let mut own = std::mem::take(self.room(layer));
        if let Some(finer) = self.layers.get(usize::from(layer) + 1) {
            own.average(finer.texels(), place);
        }
        self.layers[usize::from(layer)] = own;
        self.history[tile as usize].acquired = Some((How::Synthesized, frame));
    }

    /// The tile of the next coarser layer that a tile was the last one missing for: it can be averaged now (Figure 6), and is not there.
    pub fn average_of(&self, tile: u32) -> Option<u32> {
        let average = self.page.average_of(tile)?;
        let can_be = !self.exists(average) && self.page.sources(average).iter().all(|source| self.exists(*source));
        can_be.then_some(average)
    }

    fn room(&mut self, layer: u8) -> &mut LayerTexels {
        let texels = &mut self.layers[usize::from(layer)];
        if texels.texels.is_empty() {
            *texels = LayerTexels::new(self.page.layers[usize::from(layer)].size);
        }
        texels
    }

    /// A pixel of the final picture of this frame, or one that gets no better, is coloured from these texels of a layer.
    #[inline]
    pub fn need(&mut self, layer: u8, taps: &[Tap; 2], frame: u64) {
        let [x, y] = taps;
        let first = self.page.tile_of(layer, [x.first, y.first]);
        let inside = self.page.tile_of(layer, [x.second, y.second]) == first;
        if inside && self.last[usize::from(layer)] == first && self.history[first as usize].needed == frame {
            return;
        }
        self.last[usize::from(layer)] = first;
        for tile in self.page.tiles_of(layer, taps) {
            let history = &mut self.history[tile as usize];
            if history.needed != frame {
                history.needed = frame;
                self.reused[usize::from(layer)] += u64::from(history.acquired.is_some_and(|a| a.1 < frame));
            }
        }
    }

    /// Bilinear interpolation within a layer, 0..=255 per channel.
    #[inline]
    pub fn bilinear(&self, layer: u8, [x, y]: &[Tap; 2]) -> [f32; 4] {
        let texels = &self.layers[usize::from(layer)];
        let texel = |start: usize, x: u32| {
            let [r, g, b, a] = texels.texels.get(start + x as usize).copied().unwrap_or_default();
            f32x4::new([r.into(), g.into(), b.into(), a.into()])
        };
        let row = |y: u32| {
            let start = y as usize * texels.size[0] as usize;
            between(texel(start, x.first), texel(start, x.second), x.fraction)
        };
        between(row(y.first), row(y.second), y.fraction).to_array()
    }
}

#[inline(always)]
fn between(first: f32x4, second: f32x4, share: f32) -> f32x4 {
    first + (second - first) * share
}
