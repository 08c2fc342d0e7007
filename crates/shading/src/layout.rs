//! Memory layouts of the texels of a level: row by row, in blocks, or in blocks of blocks.
//!
//! The layouts have the names of Hakura and Gupta, "The Design and Analysis of a Cache Architecture for Texture Mapping" (ISCA
//! 1997). A memory line that holds a block suits textures that are crossed in any direction. Blocks within superblocks of a
//! cache's size keep vertical neighbours from sharing a cache set.

use crate::texture::times;
use crate::{SampleFootprints, SampleTaps};
use basrelief_signals::MapInline as _;
use basrelief_signals::{Image, Texture};
use serde::{Deserialize, Serialize};
use std::ops::{Add, BitAnd};
use wide::u32x4;

/// Side of the smallest block that a level fills in memory \[texels\]. Scenes and display lists place textures in such blocks,
/// and pictures are traversed and stored in them.
pub const BLOCK: u32 = 4;

/// Largest ratio of a level's padded size to its size in whole 4 x 4 blocks. Blocks are no larger than the level, so each side is
/// padded to less than twice its length.
const SPREAD: u64 = 4;

/// Order of the texels of a level in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextureLayout {
    /// Row by row.
    Linear,
    /// Square blocks, row by row. Each block is stored row by row.
    #[default]
    Blocked,
    /// Square superblocks of square blocks. Superblocks, blocks and texels are each stored row by row.
    #[serde(rename = "blocked_6d")]
    Blocked6d,
}

/// A [`TextureLayout`] with the sides of its blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockLayout {
    /// Sides of a block and of a superblock \[texels\]: powers of two, the first no larger than the second. Row order uses blocks
    /// of one texel. Blocks without superblocks use superblocks of one block.
    sides: [u32; 2],
}

impl Default for BlockLayout {
    /// Returns the layout with blocks of 4 x 4 texels.
    fn default() -> Self {
        Self { sides: [BLOCK; 2] }
    }
}

impl BlockLayout {
    /// Creates a layout with blocks and superblocks of these sides \[texels\], which are powers of two. Sides that the layout
    /// does not have are ignored.
    pub fn new(layout: TextureLayout, block: u32, superblock: u32) -> Self {
        let sides = match layout {
            TextureLayout::Linear => [1; 2],
            TextureLayout::Blocked => [block; 2],
            TextureLayout::Blocked6d => [block.min(superblock), superblock],
        };
        Self { sides }
    }

    /// Returns the sides of blocks and superblocks in a level of this size. They are at most its smaller side, or 4.
    fn of_level(self, [width, height]: [u32; 2]) -> [u32; 2] {
        let most = 1 << width.min(height).max(BLOCK).ilog2();
        self.sides.map_inline(|side| side.min(most))
    }

    /// Returns the texels that a level of this size takes in memory, padded to whole blocks and superblocks.
    pub fn room(self, size: [u32; 2]) -> u64 {
        let [_, side] = self.of_level(size);
        size.iter().map(|n| u64::from(padded(*n, side))).product()
    }

    /// Returns the position of level `level` of the texture, behind its finer levels. A level that does not exist lies behind the
    /// last.
    ///
    /// Scenes and display lists place a texture in whole 4 x 4 blocks. For larger blocks, all positions are spread by the largest
    /// possible growth.
    pub fn level(self, texture: &Texture, level: usize) -> LevelPlace {
        let start = texture.offset * if self.sides[1] > BLOCK { SPREAD } else { 1 };
        let finer = texture.levels.iter().take(level).map(|image| self.room([image.width, image.height]));
        let size = texture.levels.get(level).map_or([1; 2], |Image { width, height, .. }| [*width, *height]);
        LevelPlace { start: finer.fold(start, |a, b| a + b), ..self.place(size) }
    }

    /// Returns the position of a level of this size at the start of the memory.
    #[inline(always)]
    fn place(self, size: [u32; 2]) -> LevelPlace {
        let [block, superblock] = self.of_level(size);
        LevelPlace::new(padded(size[0], superblock), [block, superblock])
    }
}

/// Rounds up to a multiple of a power of two. (`next_multiple_of` divides.)
#[inline(always)]
fn padded(n: u32, side: u32) -> u32 {
    (n + (side - 1)) & !(side - 1)
}

/// Position and layout of a level in memory, constant over a polygon.
///
/// The contributions of column and row to an address are separate bit fields. The row of superblocks is an exception: it is a
/// product, and also a bit field if the texture's width is a power of two. Every layout therefore needs the same operators: one
/// sum per texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LevelPlace {
    /// Address of the first texel \[texels from the start of the memory\].
    pub start: u64,
    /// Width, padded to superblocks \[texels\].
    width: u32,
    /// Sides of blocks and superblocks \[texels\].
    sides: [u32; 2],
    /// Masks of a column or row for the texel in its block, the block in its superblock, and the superblock.
    masks: [u32; 3],
}

impl LevelPlace {
    /// Creates a level at the start of the memory. Sides are powers of two, and `width` is a multiple of the second.
    fn new(width: u32, sides: [u32; 2]) -> Self {
        let [block, superblock] = sides.map_inline(|side| side - 1);
        Self { start: 0, width, sides, masks: [block, superblock & !block, !superblock] }
    }

    /// Returns the address of a texel \[texels from the start of the memory\].
    #[inline(always)]
    pub fn texel(&self, [x, y]: [u32; 2]) -> u64 {
        self.start + self.column(u64::from(x)) + self.row(u64::from(y))
    }

    /// Computes [`LevelPlace::texel`] for each tap. Column and row contribute separately, and four taps share two of each.
    #[inline(always)]
    pub fn taps(&self, taps: &SampleTaps) -> [u64; 4] {
        let [[x0, y0], [x1, _], [_, y1], _] = taps.texel;
        let (left, right) = (self.column(u64::from(x0)), self.column(u64::from(x1)));
        let (upper, lower) = (self.start + self.row(u64::from(y0)), self.start + self.row(u64::from(y1)));
        [upper + left, upper + right, lower + left, lower + right]
    }

    /// Computes the addresses of samples side by side \[texels from the start of the level\]: the largest picture needs 32 bits.
    /// (Closures over arrays are not always inlined: they took 6 % of the instructions of W1.)
    #[inline(always)]
    pub fn footprints(&self, footprints: &SampleFootprints) -> [u32x4; 4] {
        let ([left, right], [upper, lower]) = (footprints.columns, footprints.rows);
        let (left, right) = (self.column(left), self.column(right));
        let (upper, lower) = (self.row(upper), self.row(lower));
        [upper + left, upper + right, lower + left, lower + right]
    }

    /// Returns the part of a column or row under each mask.
    #[inline(always)]
    fn parts<C: LaneCoordinate>(&self, c: C) -> [C; 3] {
        let [texel, block, superblock] = self.masks;
        [c & C::from(texel), c & C::from(block), c & C::from(superblock)]
    }

    /// Returns the contribution of a column to an address. The part under a mask is a number of blocks times their side. Multiplied
    /// by the side again, it counts their texels.
    #[inline(always)]
    fn column<C: LaneCoordinate>(&self, x: C) -> C {
        let [texel, block, superblock] = self.parts(x);
        let [b, s] = self.sides;
        superblock.times(s) + block.times(b) + texel
    }

    #[inline(always)]
    fn row<C: LaneCoordinate>(&self, y: C) -> C {
        let [texel, block, superblock] = self.parts(y);
        let [b, s] = self.sides;
        superblock.times(self.width) + block.times(s) + texel.times(b)
    }
}

/// A column or row of one sample, or of several samples side by side.
trait LaneCoordinate: Copy + From<u32> + BitAnd<Output = Self> + Add<Output = Self> {
    /// Multiplies by a width or side.
    fn times(self, n: u32) -> Self;
}

impl LaneCoordinate for u64 {
    /// (Shifts by amounts unknown to the compiler took up to 2 % more instructions of a run than this product.)
    #[inline(always)]
    fn times(self, n: u32) -> Self {
        self * Self::from(n)
    }
}

impl LaneCoordinate for u32x4 {
    #[inline(always)]
    fn times(self, n: u32) -> Self {
        times(self, n)
    }
}

/// Returns the number of a pixel in a picture of this width that is stored in 4 x 4 blocks.
#[inline(always)]
pub fn pixel_offset(width: u32, pixel: [u32; 2]) -> u64 {
    LevelPlace::new(padded(width, BLOCK), [BLOCK; 2]).texel(pixel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taps;
    use basrelief_signals::{Sampler, TexelFilter};
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn texture(sizes: &[[u32; 2]], offset: u64) -> Texture {
        let image = |&[width, height]: &[u32; 2]| Image { width, height, texels: vec![[0; 4]; (width * height) as usize] };
        let levels = sizes.iter().map(image).collect();
        Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset, elsewhere: None }
    }

    fn any_layout() -> impl Strategy<Value = BlockLayout> {
        use TextureLayout::{Blocked, Blocked6d, Linear};
        (prop_oneof![Just(Linear), Just(Blocked), Just(Blocked6d)], 1u32..5, 0u32..4)
            .prop_map(|(layout, block, more)| BlockLayout::new(layout, 1 << block, 1 << (block + more)))
    }

    fn texels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
    }

    #[test]
    fn default_layout_is_blocked_4_x_4() {
        let texture = texture(&[[6, 5], [3, 2], [1, 1]], 32);
        let at = |level, texel| BlockLayout::default().level(&texture, level).texel(texel);
        assert_eq!([at(0, [0, 0]), at(0, [3, 1]), at(0, [4, 0]), at(0, [1, 4])], [32, 32 + 7, 32 + 16, 32 + 33]);
        assert_eq!([at(1, [2, 1]), at(2, [0, 0]), at(99, [0, 0])], [32 + 64 + 6, 32 + 64 + 16, 32 + 64 + 32]);
        assert_eq!(BlockLayout::default(), BlockLayout::new(TextureLayout::Blocked, 4, 64));
    }

    // Claim: as pictures_do_not_depend_on_raster_order_or_layout.
    #[test]
    fn each_layout_matches_hand_computed_texel() {
        let texture = texture(&[[32, 16]], 0);
        let at = |layout, block, superblock| BlockLayout::new(layout, block, superblock).level(&texture, 0).texel([21, 11]);
        assert_eq!(at(TextureLayout::Linear, 4, 8), 11 * 32 + 21);
        // The first row of blocks has 256 texels, and two blocks are to the left.
        assert_eq!(at(TextureLayout::Blocked, 8, 8), 256 + 2 * 64 + 3 * 8 + 5);
        // In superblock (2, 1) of 8 x 8, block (1, 0) of 4 x 4, texel (1, 3).
        assert_eq!(at(TextureLayout::Blocked6d, 4, 8), 256 + 2 * 64 + 16 + 3 * 4 + 1);
    }

    #[test]
    fn superblocks_and_blocks_are_contiguous() {
        let texture = texture(&[[96, 64]], 0);
        let place = BlockLayout::new(TextureLayout::Blocked6d, 4, 32).level(&texture, 0);
        for side in [4, 32] {
            let numbers = |texel: [u32; 2]| place.texel(texel) / u64::from(side * side);
            let blocks: BTreeSet<_> = texels([96, 64]).map(|t| (numbers(t), t.map(|n| n / side))).collect();
            assert_eq!(blocks.len() as u32, 96 * 64 / (side * side));
        }
    }

    proptest! {
        #[test]
        fn texel_addresses_are_distinct_within_padded_level(
            layout in any_layout(), size in [1u32..70, 1u32..70], finer in [1u32..70, 1u32..70], offset in 0u64..9,
        ) {
            let texture = texture(&[finer, size], 16 * offset);
            let [start, place, end] = [0, 1, 2].map(|level| layout.level(&texture, level));
            prop_assert_eq!([place.start - start.start, end.start - place.start], [finer, size].map(|size| layout.room(size)));
            // In a level padded to whole superblocks, every address is used once.
            let [_, side] = layout.of_level(size);
            let padded = size.map(|n| n.next_multiple_of(side));
            let places: BTreeSet<u64> = texels(padded).map(|texel| place.texel(texel)).collect();
            prop_assert_eq!(places.len() as u64, layout.room(size));
            prop_assert!(places.iter().all(|at| (place.start..end.start).contains(at)));
        }

        #[test]
        fn adjacent_textures_do_not_overlap(layout in any_layout(), sizes in prop::collection::vec([1u32..99, 1u32..99], 1..5)) {
            let one = texture(&sizes, 32);
            // Position of the next texture in a scene.
            let next = texture(&sizes, BlockLayout::default().level(&one, sizes.len()).start);
            prop_assert!(layout.level(&one, sizes.len()).start <= layout.level(&next, 0).start);
        }

        #[test]
        fn default_blocks_are_stored_row_by_row(size in [1u32..70, 1u32..70]) {
            let place = BlockLayout::default().level(&texture(&[size], 0), 0);
            let expected = |[x, y]: [u32; 2]| (y / 4 * size[0].div_ceil(4) + x / 4) * 16 + y % 4 * 4 + x % 4;
            prop_assert!(texels(size).all(|texel| place.texel(texel) == u64::from(expected(texel))));
        }

        #[test]
        fn linear_is_row_by_row(size in [1u32..70, 1u32..70]) {
            let place = BlockLayout::new(TextureLayout::Linear, 4, 64).level(&texture(&[size], 0), 0);
            prop_assert!(texels(size).map(|texel| place.texel(texel)).eq(0..u64::from(size[0] * size[1])));
        }

        #[test]
        fn taps_have_addresses_of_their_texels(layout in any_layout(), size in [1u32..70, 1u32..70], u in -3f32..3.0, v in -3f32..3.0) {
            let texture = texture(&[size], 48);
            let taps = taps(&texture.levels[0], &texture.sampler, TexelFilter::Bilinear, [u, v]);
            let place = layout.level(&texture, 0);
            prop_assert_eq!(place.taps(&taps), taps.texel.map(|texel| place.texel(texel)));
        }
    }
}
