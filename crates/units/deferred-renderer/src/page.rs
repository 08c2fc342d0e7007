//! Texture page (132): division of a texture into layers and tiles.
//!
//! Layer 0 is one tile, and layer Dmax (133) is the full resolution, or less if Dmax is capped. Each layer halves the one below
//! it, rounding up. Tiles of a layer are numbered row by row, and layers one after the other: a tile has one number within its
//! texture.

pub use crate::layers::{PyramidCut, PyramidLayer, TexelCentre};
use basrelief_signals::{Texture, WrapMode};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// Rectangle of texels of one layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexelArea {
    /// First column and row.
    pub first: [u32; 2],
    /// Column and row behind the last.
    pub end: [u32; 2],
}

impl TexelArea {
    /// Returns width and height \[texels\].
    pub fn size(self) -> [u32; 2] {
        [0, 1].map(|i| self.end[i] - self.first[i])
    }
}

/// A texture page (132), without its texels: Dmax (133), tile pitch array (138), tile base array (140).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TexturePage {
    /// Number of the page, which is the texture page pointer (310) of a cell.
    pub number: u16,
    /// Number of the texture in its scene or display list.
    pub texture: u32,
    /// Width and height of the texture \[texels\].
    pub texture_size: [u32; 2],
    /// Name for messages.
    pub name: String,
    /// Division into layers and tiles.
    pub cut: PyramidCut,
    /// Layers from coarsest to finest.
    pub layers: Vec<PyramidLayer>,
    /// Number of finer layers that the cap of Dmax leaves out \[0033\].
    pub left_out: u8,
    /// Start of the page in the texture-data memory (130) \[bytes\].
    pub address: u64,
    /// Number of all tiles: the extra entry of the tile base array (140).
    tiles: u32,
    shift: [u32; 2],
    offset: f32,
    size: [f32; 2],
    inverse: [f32; 2],
}

/// Distinct tiles of one layer that a sample reads, one to four.
pub type SampleTiles = SmallVec<[u32; 4]>;

/// Texels of a sample along one axis of a layer: two neighbours and the share of the second. If the share is 0, the second texel
/// is not read and equals the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisTap {
    /// Integer coordinate S_i.
    pub first: u32,
    /// Right or lower neighbour.
    pub second: u32,
    /// Fraction S_f, 0..1.
    pub fraction: f32,
}

/// Texture coordinates (312) wrapped into the texture by the wrap modes of their cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrappedCoordinates {
    /// Coordinates, 0 ..= size \[finest texels\].
    pub coordinates: [f32; 2],
    /// True if the texture repeats: its first texel follows its last.
    pub repeats: [bool; 2],
}

/// Rounds towards minus infinity. The library function would be a call.
#[inline]
fn floor(x: f32) -> f32 {
    let whole = x as i32 as f32;
    if whole > x { whole - 1.0 } else { whole }
}

impl TexturePage {
    /// Creates the page of a texture. `address` is the start of free space in the texture-data memory (130).
    pub fn new(number: u16, texture: &Texture, cut: PyramidCut, address: u64) -> Self {
        let texture_size = texture.levels.first().map_or([1, 1], |image| [image.width.max(1), image.height.max(1)]);
        let (layers, left_out) = cut.layers(texture_size);
        // Not the finest layer's own size, which is rounded up so that its last texel extends beyond the texture.
        let size = texture_size.map(|n| n as f32 / (1_u64 << left_out) as f32);
        let tiles = layers.last().map_or(0, |l| l.base + l.pitch * l.rows);
        let offset = if cut.centre == TexelCentre::Half { 0.5 } else { 0.0 };
        Self {
            number,
            texture: texture.id,
            texture_size,
            name: texture.name.clone(),
            cut,
            layers,
            left_out,
            address,
            tiles,
            shift: cut.tile.map(u32::trailing_zeros),
            offset,
            size,
            inverse: size.map(|n| 1.0 / n),
        }
    }

    /// Returns the depth of the finest layer, Dmax (133).
    #[inline]
    pub fn dmax(&self) -> u8 {
        (self.layers.len() - 1) as u8
    }

    /// Returns width and height of the texture, in texels of the finest layer.
    #[inline]
    pub fn size(&self) -> [f32; 2] {
        self.size
    }

    /// Returns the reciprocals of width and height.
    pub(crate) fn inverse(&self) -> [f32; 2] {
        self.inverse
    }

    /// Returns the number of tiles of all layers.
    #[inline]
    pub fn tiles(&self) -> u32 {
        self.tiles
    }

    /// Returns the size of the page in the texture-data memory (130) \[bytes\]: whole tiles, 4 bytes per texel.
    pub fn bytes(&self) -> u64 {
        u64::from(self.tiles) * self.tile_bytes()
    }

    /// Returns the room of a tile in the texture-data memory (130) \[bytes\].
    #[inline]
    pub fn tile_bytes(&self) -> u64 {
        4 * u64::from(self.cut.tile[0]) * u64::from(self.cut.tile[1])
    }

    /// Returns the layer of a tile.
    pub fn layer_of(&self, tile: u32) -> u8 {
        (self.layers.partition_point(|l| l.base <= tile) - 1) as u8
    }

    /// Computes Ntil = B_D + Tr * W_D + Sr: the tile that holds a texel of a layer.
    #[inline]
    pub fn tile_of(&self, layer: u8, texel: [u32; 2]) -> u32 {
        let l = &self.layers[usize::from(layer)];
        l.base + (texel[1] >> self.shift[1]) * l.pitch + (texel[0] >> self.shift[0])
    }

    /// Returns the texels of a tile. Tiles at the right and lower edge may be smaller.
    pub fn texels_of(&self, tile: u32) -> TexelArea {
        let layer = &self.layers[usize::from(self.layer_of(tile))];
        let place = [(tile - layer.base) % layer.pitch, (tile - layer.base) / layer.pitch];
        let first = [0, 1].map(|i| place[i] << self.shift[i]);
        TexelArea { first, end: [0, 1].map(|i| (first[i] + self.cut.tile[i]).min(layer.size[i])) }
    }

    /// Returns the number of texels of a tile.
    pub fn texels_in(&self, tile: u32) -> u64 {
        self.texels_of(tile).size().map(u64::from).into_iter().product()
    }

    /// Returns address and size of the texels of a tile in the texture-data memory (130) \[bytes\]. An edge tile fills its room only in
    /// part. Its rows of blocks lie apart, but count as one range.
    pub fn range_of(&self, tile: u32) -> (u64, u32) {
        (self.address + u64::from(tile) * self.tile_bytes(), 4 * self.texels_in(tile) as u32)
    }

    /// Returns the tiles of the next finer layer that a tile is the average of: four, or two or one at the right and lower edge.
    /// Empty for the finest layer.
    pub fn sources(&self, tile: u32) -> SampleTiles {
        let depth = self.layer_of(tile);
        let Some(finer) = self.layers.get(usize::from(depth) + 1) else { return SampleTiles::new() };
        let layer = &self.layers[usize::from(depth)];
        let (column, row) = ((tile - layer.base) % layer.pitch, (tile - layer.base) / layer.pitch);
        let rows = (2 * row..2 * row + 2).filter(|r| *r < finer.rows);
        rows.flat_map(|r| {
            (2 * column..2 * column + 2).filter(|c| *c < finer.pitch).map(move |c| finer.base + r * finer.pitch + c)
        })
        .collect()
    }

    /// Returns the tile of the next coarser layer that a tile is a source of. Returns `None` for the coarsest layer.
    pub fn average_of(&self, tile: u32) -> Option<u32> {
        let coarser = self.layer_of(tile).checked_sub(1)?;
        Some(self.tile_of(coarser, self.texels_of(tile).first.map(|first| first / 2)))
    }

    /// Returns the byte address of a texel in the texture-data memory (130). Tiles follow each other, and each has 4 x 4 blocks
    /// row by row.
    #[inline]
    pub fn address_of(&self, layer: u8, texel: [u32; 2]) -> u64 {
        let tile = u64::from(self.tile_of(layer, texel)) * self.tile_bytes();
        let [x, y] = [0, 1].map(|i| texel[i] & (self.cut.tile[i] - 1));
        let block = (y >> 2) * (self.cut.tile[0] >> 2) + (x >> 2);
        self.address + tile + u64::from(block * 64 + (y & 3) * 16 + (x & 3) * 4)
    }

    /// Wraps texture coordinates (312) into the texture. NaN becomes 0.
    #[inline]
    pub fn placed(&self, st: [f32; 2], wrap: [WrapMode; 2]) -> WrappedCoordinates {
        // (`map` and its closure would become calls.)
        let coordinates = [self.placed_along(0, st[0], wrap[0]), self.placed_along(1, st[1], wrap[1])];
        WrappedCoordinates { coordinates, repeats: [wrap[0] == WrapMode::Repeat, wrap[1] == WrapMode::Repeat] }
    }

    #[inline(always)]
    fn placed_along(&self, axis: usize, s: f32, wrap: WrapMode) -> f32 {
        let size = self.size[axis];
        let inside = match wrap {
            WrapMode::Repeat => {
                let rest = s - size * floor(s * self.inverse[axis]);
                // The quotient is rounded, so the rest may be off by one texture.
                let rest = if rest < 0.0 { rest + size } else { rest };
                if rest >= size { rest - size } else { rest }
            }
            WrapMode::Mirror => {
                let rest = s - 2.0 * size * floor(0.5 * s * self.inverse[axis]);
                if rest > size { 2.0 * size - rest } else { rest }
            }
            WrapMode::Clamp => s,
        };
        if inside > 0.0 { inside.min(size) } else { 0.0 }
    }

    /// Returns the taps of a bilinear sample at `placed` coordinates in a layer, by axis.
    #[inline]
    pub fn taps(&self, layer: u8, placed: WrappedCoordinates) -> [AxisTap; 2] {
        let l = &self.layers[usize::from(layer)];
        [self.tap(l, 0, placed), self.tap(l, 1, placed)]
    }

    #[inline(always)]
    fn tap(&self, layer: &PyramidLayer, axis: usize, placed: WrappedCoordinates) -> AxisTap {
        let x = placed.coordinates[axis] * layer.scale - self.offset;
        let whole = floor(x);
        tap(whole as i32, x - whole, layer.size[axis] as i32, placed.repeats[axis])
    }

    /// Returns the tiles that a bilinear sample at `placed` coordinates reads of a layer: Figure 5A with the border check of
    /// Figure 5B, corrected.
    ///
    /// A neighbour is read only if the fraction is above 0. If the texel is the last of its tile, the neighbour lies in the next
    /// tile. At the edge of the layer it lies in column (row) 0 if the texture repeats, and otherwise does not exist.
    #[inline]
    pub fn marked(&self, layer: u8, placed: WrappedCoordinates) -> SampleTiles {
        self.tiles_of(layer, &self.taps(layer, placed))
    }

    /// Returns the tiles that these taps read of a layer.
    #[inline]
    pub fn tiles_of(&self, layer: u8, [x, y]: &[AxisTap; 2]) -> SampleTiles {
        let l = &self.layers[usize::from(layer)];
        let [across, down] = self.shift;
        let (column, row) = (x.first >> across, y.first >> down);
        let (beyond, under) = (x.second >> across, y.second >> down);
        let number = |column: u32, row: u32| l.base + row * l.pitch + column;
        let mut tiles = SampleTiles::new();
        tiles.push(number(column, row));
        let (right, below) = (beyond != column, under != row);
        if right {
            tiles.push(number(beyond, row));
        }
        if right && below {
            tiles.push(number(beyond, under));
        }
        if below {
            tiles.push(number(column, under));
        }
        tiles
    }
}

#[inline(always)]
fn tap(whole: i32, fraction: f32, size: i32, repeats: bool) -> AxisTap {
    if repeats {
        let first = if whole < 0 { size - 1 } else { whole.min(size - 1) };
        let next = if first + 1 == size { 0 } else { first + 1 };
        let second = if fraction > 0.0 { next } else { first };
        AxisTap { first: first as u32, second: second as u32, fraction }
    } else if whole < 0 || whole >= size - 1 {
        // Beyond the edge the edge texel extends, without a neighbour.
        let edge = if whole < 0 { 0 } else { size - 1 } as u32;
        AxisTap { first: edge, second: edge, fraction: 0.0 }
    } else {
        AxisTap { first: whole as u32, second: whole as u32 + u32::from(fraction > 0.0), fraction }
    }
}
