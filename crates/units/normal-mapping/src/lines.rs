//! Which cache lines a footprint touches.

use basrelief_kernel::Traffic;
use basrelief_shading::{Footprints, LevelPlace};

/// The cache in front of the normal-map memory (116).
const NORMAL_MAP: u32 = 0;

/// Lines remembered within a level of a stamp; what is forgotten is looked up again, and told apart by the cache.
const RECENT: usize = 4;

/// Texels and cache lines, in bytes.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    texel_bytes: u32,
    line_shift: u32,
    /// Lines that one texel may touch: 1 where texels divide lines.
    pub(crate) per_texel: u32,
}

impl Lines {
    /// `line_bytes` is a power of two.
    pub(crate) fn new(texel_bytes: u32, line_bytes: u32) -> Self {
        let (texel_bytes, line) = (texel_bytes.max(1), line_bytes.max(1));
        let per_texel = if line.is_multiple_of(texel_bytes) { 1 } else { (texel_bytes - 1) / line + 2 };
        Self { texel_bytes, line_shift: line.ilog2(), per_texel }
    }

    /// Looks up the taps of the first `count` samples of the level at this place, each line once: saying so again would cost the
    /// device nothing, but the host time. Mostly all four texels of a sample lie in one 4 x 4 block, which is one line.
    #[inline(always)]
    pub(crate) fn look_up(&self, place: LevelPlace, (footprints, count): (&Footprints, usize), traffic: &mut Traffic) {
        let bytes = u64::from(self.texel_bytes);
        let (mut recent, mut oldest) = ([u64::MAX; RECENT], 0);
        let mut look_up = |address: u64| {
            let line = address >> self.line_shift;
            let known = recent.iter().fold(false, |known, seen| known | (*seen == line));
            // A texel across two lines is left to the cache.
            if !known || self.per_texel > 1 {
                recent[oldest % RECENT] = line;
                oldest += 1;
                traffic.look_up(NORMAL_MAP, address, self.texel_bytes);
            }
        };
        for lane in 0..count {
            let [a, b, c, d] = place.taps(&footprints.taps(lane)).map(|texel| texel * bytes);
            look_up(a);
            if self.per_texel > 1 || ((a ^ b) | (a ^ c) | (a ^ d)) >> self.line_shift != 0 {
                [b, c, d].into_iter().for_each(&mut look_up);
            }
        }
    }
}
