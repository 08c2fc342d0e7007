//! Texels of a page in the texture-data memory (130): the present part of its pyramid (134), and its interpolation.

use crate::TexturePage;
use crate::acquisition::TileOrigin;
use crate::page::{AxisTap, WrappedCoordinates};
use crate::pyramid::LayerTexels;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::sync::Arc;
use wide::f32x4;

/// History of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileHistory {
    /// Origin of the tile, and the frame of its arrival, counted from 1.
    pub acquired: Option<(TileOrigin, u64)>,
    /// Last frame, counted from 1, in which a pixel was coloured from it. 0 means none.
    pub needed: u64,
}

/// Counts of the tiles of one layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerCounts {
    /// Tiles loaded over the path.
    pub loaded: u64,
    /// Tiles averaged from finer ones.
    pub synthesized: u64,
    /// Tiles of an earlier frame that a frame was coloured from, summed over the frames.
    pub reused: u64,
    /// Tiles from which no pixel was coloured.
    pub never_needed: u64,
}

/// Pyramid (134) of one page, as far as its tiles are present.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PageTexels {
    /// Page of the pyramid.
    pub page: Arc<TexturePage>,
    layers: Vec<LayerTexels>,
    history: Vec<TileHistory>,
    reused: Vec<u64>,
    /// Last needed tile by layer, because neighbours usually need the same one.
    last: Vec<u32>,
}

const NO_TILE: u32 = u32::MAX;

impl PageTexels {
    /// Creates an empty page. Layers allocate memory with their first tile.
    pub fn new(page: Arc<TexturePage>) -> Self {
        let layers = vec![LayerTexels::default(); page.layers.len()];
        let history = vec![TileHistory::default(); page.tiles() as usize];
        let (reused, last) = (vec![0; page.layers.len()], vec![NO_TILE; page.layers.len()]);
        Self { page, layers, history, reused, last }
    }

    /// Returns the history of each tile, by number.
    pub fn history(&self) -> &[TileHistory] {
        &self.history
    }

    /// Returns the counts of the tiles of a layer.
    pub fn counts(&self, layer: u8) -> LayerCounts {
        let l = &self.page.layers[usize::from(layer)];
        let tiles = &self.history[l.base as usize..(l.base + l.pitch * l.rows) as usize];
        let came = |how: TileOrigin| tiles.iter().filter(|t| t.acquired.is_some_and(|a| a.0 == how)).count() as u64;
        LayerCounts {
            loaded: came(TileOrigin::Loaded),
            synthesized: came(TileOrigin::Synthesized),
            reused: self.reused[usize::from(layer)],
            never_needed: tiles.iter().filter(|t| t.needed == 0).count() as u64,
        }
    }

    /// Returns the texels of a layer, if any of its tiles is present.
    pub fn layer(&self, layer: u8) -> &LayerTexels {
        &self.layers[usize::from(layer)]
    }

    /// Returns true if a tile is present.
    #[inline]
    pub fn exists(&self, tile: u32) -> bool {
        self.history[tile as usize].acquired.is_some()
    }

    /// Returns true if all tiles of a sample of a layer are present, and the number of words of the tile load list (136), of
    /// `entries` entries each, that the test reads.
    #[inline]
    pub fn look_up(&self, layer: u8, placed: WrappedCoordinates, entries: u32) -> (bool, u32) {
        let tiles = self.page.marked(layer, placed);
        let mut words: SmallVec<[u32; 4]> = tiles.iter().map(|tile| tile / entries).collect();
        words.sort_unstable();
        words.dedup();
        (tiles.iter().all(|&tile| self.exists(tile)), words.len() as u32)
    }

    /// Stores a tile received over the path.
    pub fn store(&mut self, tile: u32, texels: &[[u8; 4]], frame: u64) {
        let layer = self.page.layer_of(tile);
        let place = self.page.texels_of(tile);
        self.room(layer).put(place, texels);
        self.history[tile as usize].acquired = Some((TileOrigin::Loaded, frame));
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
        self.history[tile as usize].acquired = Some((TileOrigin::Synthesized, frame));
    }

    /// Returns the tile of the next coarser layer that can now be averaged (Figure 6), because this tile was its last missing
    /// source. Returns `None` if that tile is already present.
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

    /// Records that a pixel of the final image of this frame, or a pixel that cannot be improved, is coloured from these texels
    /// of a layer.
    #[inline]
    pub fn need(&mut self, layer: u8, taps: &[AxisTap; 2], frame: u64) {
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

    /// Interpolates bilinearly within a layer, 0..=255 per channel.
    #[inline]
    pub fn bilinear(&self, layer: u8, [x, y]: &[AxisTap; 2]) -> [f32; 4] {
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
