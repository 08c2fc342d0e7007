//! Which cache lines a footprint touches.

use basrelief_kernel::Traffic;
use basrelief_shading::{Taps, tap_offsets};

/// The cache in front of the normal-map memory (116).
const NORMAL_MAP: u32 = 0;

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

    /// Looks up the taps of a level `width` texels wide that starts `base` texels from the start of the memory, each line
    /// once: mostly all four texels lie in one 4 x 4 block, which is one line.
    #[inline]
    pub(crate) fn look_up(&self, width: u32, base: u64, taps: &Taps, traffic: &mut Traffic) {
        let bytes = u64::from(self.texel_bytes);
        let [oa, ob, oc, od] = tap_offsets(width, taps);
        let [a, b, c, d] = [(base + oa) * bytes, (base + ob) * bytes, (base + oc) * bytes, (base + od) * bytes];
        let mut look_up = |address| traffic.look_up(NORMAL_MAP, address, self.texel_bytes);
        look_up(a);
        if self.per_texel > 1 {
            // Rare enough to leave telling the lines apart to the cache.
            [b, c, d].into_iter().for_each(look_up);
            return;
        }
        let differ = |p: u64, q: u64| (p ^ q) >> self.line_shift != 0;
        if ((a ^ b) | (a ^ c) | (a ^ d)) >> self.line_shift == 0 {
            return;
        }
        if differ(a, b) {
            look_up(b);
        }
        if differ(a, c) && differ(b, c) {
            look_up(c);
        }
        if differ(a, d) && differ(b, d) && differ(c, d) {
            look_up(d);
        }
    }
}
