//! Where the texels of a level lie in memory: row by row, in blocks, or in blocks of blocks.
//!
//! Hakura and Gupta, "The Design and Analysis of a Cache Architecture for Texture Mapping" (ISCA 1997), by whose names the layouts
//! go: a line of memory that is a block serves a texture that is crossed in any direction, and blocks within superblocks of a
//! cache's size keep neighbours above each other from sharing its sets.

use crate::texture::times;
use crate::{Footprints, Taps};
use basrelief_signals::{Image, Texture};
use serde::{Deserialize, Serialize};
use std::ops::{Add, BitAnd};
use wide::u32x4;

/// Side of the smallest block that a level takes whole in memory \[texels\]: of textures as scenes and display lists place them,
/// and of the blocks in which pictures are visited and stored.
pub const BLOCK: u32 = 4;

/// Levels take this many times the room of whole 4 x 4 blocks at most: with blocks no larger than the level, each side is padded
/// to less than twice its length.
const SPREAD: u64 = 4;

/// In which order the texels of a level lie in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextureLayout {
    /// Row by row.
    Linear,
    /// In square blocks, row of blocks by row of blocks, each row by row.
    #[default]
    Blocked,
    /// In square superblocks of square blocks: row by row in each of the three.
    #[serde(rename = "blocked_6d")]
    Blocked6d,
}

/// A [`TextureLayout`] with the sides of its blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Sides of a block and of a superblock \[texels\]: powers of two, the first no larger. Rows are blocks of one texel, and blocks
    /// without superblocks are superblocks of one block.
    sides: [u32; 2],
}

impl Default for Layout {
    /// Blocks of 4 x 4 texels.
    fn default() -> Self {
        Self { sides: [BLOCK; 2] }
    }
}

impl Layout {
    /// A layout with blocks and superblocks of these sides \[texels\], powers of two, as far as it has any.
    pub fn new(layout: TextureLayout, block: u32, superblock: u32) -> Self {
        let sides = match layout {
            TextureLayout::Linear => [1; 2],
            TextureLayout::Blocked => [block; 2],
            TextureLayout::Blocked6d => [block.min(superblock), superblock],
        };
        Self { sides }
    }

    /// Sides of blocks and superblocks in a level of this size: no larger than its smaller side, or 4.
    fn of_level(self, [width, height]: [u32; 2]) -> [u32; 2] {
        let most = 1 << width.min(height).max(BLOCK).ilog2();
        self.sides.map(|side| side.min(most))
    }

    /// Texels that a level of this size takes in memory, padded to whole blocks and superblocks.
    pub fn room(self, size: [u32; 2]) -> u64 {
        let [_, side] = self.of_level(size);
        size.iter().map(|n| u64::from(n.next_multiple_of(side))).product()
    }

    /// Where level `level` of the texture lies: behind its finer ones. One that it does not have lies behind its last.
    ///
    /// A texture begins where its scene or display list has placed it, in whole 4 x 4 blocks; with larger ones all lie as much farther
    /// apart as they may have grown.
    pub fn level(self, texture: &Texture, level: usize) -> LevelPlace {
        let start = texture.offset * if self.sides[1] > BLOCK { SPREAD } else { 1 };
        let finer = texture.levels.iter().take(level).map(|image| self.room([image.width, image.height]));
        let size = texture.levels.get(level).map_or([1; 2], |Image { width, height, .. }| [*width, *height]);
        LevelPlace { start: finer.fold(start, |a, b| a + b), ..self.place(size) }
    }

    /// A level of this size at the start of the memory.
    #[inline(always)]
    fn place(self, size: [u32; 2]) -> LevelPlace {
        let [block, superblock] = self.of_level(size);
        LevelPlace::new(size[0].next_multiple_of(superblock), [block, superblock])
    }
}

/// Where a level lies, and how: constant over a polygon.
///
/// What column and row add to an address are bits side by side, but for the row of superblocks, which is a product or, where a
/// texture's width is a power of two, bits too. So every layout takes the same operators: a sum for each texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LevelPlace {
    /// First texel \[texels from the start of the memory\].
    pub start: u64,
    /// Width, padded to superblocks \[texels\].
    width: u32,
    /// Sides of blocks and superblocks \[texels\].
    sides: [u32; 2],
    /// Bits of a column or row that say which texel of its block it is, which block of its superblock, and which superblock.
    masks: [u32; 3],
}

impl LevelPlace {
    /// At the start of the memory. Sides are powers of two, and `width` a multiple of the second.
    fn new(width: u32, sides: [u32; 2]) -> Self {
        let [block, superblock] = sides.map(|side| side - 1);
        Self { start: 0, width, sides, masks: [block, superblock & !block, !superblock] }
    }

    /// A texel \[texels from the start of the memory\].
    #[inline(always)]
    pub fn texel(&self, [x, y]: [u32; 2]) -> u64 {
        self.start + self.column(u64::from(x)) + self.row(u64::from(y))
    }

    /// [`LevelPlace::texel`] of each tap. Column and row contribute apart, and four taps lie in two of each.
    #[inline(always)]
    pub fn taps(&self, taps: &Taps) -> [u64; 4] {
        let [[x0, y0], [x1, _], [_, y1], _] = taps.texel;
        let (left, right) = (self.column(u64::from(x0)), self.column(u64::from(x1)));
        let (upper, lower) = (self.start + self.row(u64::from(y0)), self.start + self.row(u64::from(y1)));
        [upper + left, upper + right, lower + left, lower + right]
    }

    /// The same of samples side by side, but from the start of the level on \[texels\]: of the largest picture these are 32 bits.
    /// (Not by closures over arrays: they are not always inlined, and then took 6 % of the instructions of W1.)
    #[inline(always)]
    pub fn footprints(&self, footprints: &Footprints) -> [u32x4; 4] {
        let ([left, right], [upper, lower]) = (footprints.columns, footprints.rows);
        let (left, right) = (self.column(left), self.column(right));
        let (upper, lower) = (self.row(upper), self.row(lower));
        [upper + left, upper + right, lower + left, lower + right]
    }

    /// What of a column or row stands under each mask.
    #[inline(always)]
    fn parts<C: Coordinate>(&self, c: C) -> [C; 3] {
        let [texel, block, superblock] = self.masks;
        [c & C::from(texel), c & C::from(block), c & C::from(superblock)]
    }

    /// What stands under a mask is a number of blocks times their side; times the side again, it is their texels.
    #[inline(always)]
    fn column<C: Coordinate>(&self, x: C) -> C {
        let [texel, block, superblock] = self.parts(x);
        let [b, s] = self.sides;
        superblock.times(s) + block.times(b) + texel
    }

    #[inline(always)]
    fn row<C: Coordinate>(&self, y: C) -> C {
        let [texel, block, superblock] = self.parts(y);
        let [b, s] = self.sides;
        superblock.times(self.width) + block.times(s) + texel.times(b)
    }
}

/// A column or row, or those of several samples side by side.
trait Coordinate: Copy + From<u32> + BitAnd<Output = Self> + Add<Output = Self> {
    /// Times a width or side.
    fn times(self, n: u32) -> Self;
}

impl Coordinate for u64 {
    /// (A product: shifts by numbers that the compiler does not know took a run up to 2 % more instructions.)
    #[inline(always)]
    fn times(self, n: u32) -> Self {
        self * Self::from(n)
    }
}

impl Coordinate for u32x4 {
    #[inline(always)]
    fn times(self, n: u32) -> Self {
        times(self, n)
    }
}

/// Number of a pixel of a picture of this width that lies in 4 x 4 blocks.
#[inline(always)]
pub fn pixel_offset(width: u32, pixel: [u32; 2]) -> u64 {
    LevelPlace::new(width.next_multiple_of(BLOCK), [BLOCK; 2]).texel(pixel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taps;
    use basrelief_signals::{Filter, Sampler};
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn texture(sizes: &[[u32; 2]], offset: u64) -> Texture {
        let image = |&[width, height]: &[u32; 2]| Image { width, height, texels: vec![[0; 4]; (width * height) as usize] };
        let levels = sizes.iter().map(image).collect();
        Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset, elsewhere: None }
    }

    fn any_layout() -> impl Strategy<Value = Layout> {
        use TextureLayout::{Blocked, Blocked6d, Linear};
        (prop_oneof![Just(Linear), Just(Blocked), Just(Blocked6d)], 1u32..5, 0u32..4)
            .prop_map(|(layout, block, more)| Layout::new(layout, 1 << block, 1 << (block + more)))
    }

    fn texels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
    }

    #[test]
    fn by_default_a_texel_lies_where_4_x_4_blocks_have_it() {
        let texture = texture(&[[6, 5], [3, 2], [1, 1]], 32);
        let at = |level, texel| Layout::default().level(&texture, level).texel(texel);
        assert_eq!([at(0, [0, 0]), at(0, [3, 1]), at(0, [4, 0]), at(0, [1, 4])], [32, 32 + 7, 32 + 16, 32 + 33]);
        assert_eq!([at(1, [2, 1]), at(2, [0, 0]), at(99, [0, 0])], [32 + 64 + 6, 32 + 64 + 16, 32 + 64 + 32]);
        assert_eq!(Layout::default(), Layout::new(TextureLayout::Blocked, 4, 64));
    }

    #[test]
    fn a_texel_by_hand_in_each_layout() {
        let texture = texture(&[[32, 16]], 0);
        let at = |layout, block, superblock| Layout::new(layout, block, superblock).level(&texture, 0).texel([21, 11]);
        assert_eq!(at(TextureLayout::Linear, 4, 8), 11 * 32 + 21);
        // The first row of blocks has 256 texels, and two blocks are to the left.
        assert_eq!(at(TextureLayout::Blocked, 8, 8), 256 + 2 * 64 + 3 * 8 + 5);
        // Superblock (2, 1) of 8 x 8, in it block (1, 0) of 4 x 4, in that texel (1, 3).
        assert_eq!(at(TextureLayout::Blocked6d, 4, 8), 256 + 2 * 64 + 16 + 3 * 4 + 1);
    }

    #[test]
    fn a_superblock_lies_side_by_side_in_memory_and_so_does_each_of_its_blocks() {
        let texture = texture(&[[96, 64]], 0);
        let place = Layout::new(TextureLayout::Blocked6d, 4, 32).level(&texture, 0);
        for side in [4, 32] {
            let numbers = |texel: [u32; 2]| place.texel(texel) / u64::from(side * side);
            let blocks: BTreeSet<_> = texels([96, 64]).map(|t| (numbers(t), t.map(|n| n / side))).collect();
            assert_eq!(blocks.len() as u32, 96 * 64 / (side * side));
        }
    }

    proptest! {
        #[test]
        fn texels_take_places_of_their_own_in_the_padded_extent_of_their_level(
            layout in any_layout(), size in [1u32..70, 1u32..70], finer in [1u32..70, 1u32..70], offset in 0u64..9,
        ) {
            let texture = texture(&[finer, size], 16 * offset);
            let [start, place, end] = [0, 1, 2].map(|level| layout.level(&texture, level));
            prop_assert_eq!([place.start - start.start, end.start - place.start], [finer, size].map(|size| layout.room(size)));
            // Extended to whole superblocks, every place is taken once.
            let [_, side] = layout.of_level(size);
            let padded = size.map(|n| n.next_multiple_of(side));
            let places: BTreeSet<u64> = texels(padded).map(|texel| place.texel(texel)).collect();
            prop_assert_eq!(places.len() as u64, layout.room(size));
            prop_assert!(places.iter().all(|at| (place.start..end.start).contains(at)));
        }

        #[test]
        fn textures_side_by_side_do_not_overlap(layout in any_layout(), sizes in prop::collection::vec([1u32..99, 1u32..99], 1..5)) {
            let one = texture(&sizes, 32);
            // Where a scene places the next one.
            let next = texture(&sizes, Layout::default().level(&one, sizes.len()).start);
            prop_assert!(layout.level(&one, sizes.len()).start <= layout.level(&next, 0).start);
        }

        #[test]
        fn by_default_blocks_follow_each_other_row_by_row(size in [1u32..70, 1u32..70]) {
            let place = Layout::default().level(&texture(&[size], 0), 0);
            let expected = |[x, y]: [u32; 2]| (y / 4 * size[0].div_ceil(4) + x / 4) * 16 + y % 4 * 4 + x % 4;
            prop_assert!(texels(size).all(|texel| place.texel(texel) == u64::from(expected(texel))));
        }

        #[test]
        fn linear_is_row_by_row(size in [1u32..70, 1u32..70]) {
            let place = Layout::new(TextureLayout::Linear, 4, 64).level(&texture(&[size], 0), 0);
            prop_assert!(texels(size).map(|texel| place.texel(texel)).eq(0..u64::from(size[0] * size[1])));
        }

        #[test]
        fn taps_lie_where_their_texels_do(layout in any_layout(), size in [1u32..70, 1u32..70], u in -3f32..3.0, v in -3f32..3.0) {
            let texture = texture(&[size], 48);
            let taps = taps(&texture.levels[0], &texture.sampler, Filter::Bilinear, [u, v]);
            let place = layout.level(&texture, 0);
            prop_assert_eq!(place.taps(&taps), taps.texel.map(|texel| place.texel(texel)));
        }
    }
}
