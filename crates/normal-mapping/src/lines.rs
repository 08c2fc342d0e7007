//! Which cache lines a footprint touches.

use basrelief_kernel::Traffic;
use basrelief_shading::{Taps, tap_offsets};

/// The cache in front of the normal-map memory (116).
const NORMAL_MAP: u32 = 0;

/// Lines remembered within a step: of two levels two each.
const RECENT: usize = 4;

/// Texels and cache lines, in bytes.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    texel_bytes: u32,
    line_shift: u32,
    /// Lines that one texel may touch: 1 where texels divide lines.
    pub(crate) per_texel: u32,
    /// Lines looked up last in this step. Saying so again would cost the device nothing, but the host time.
    recent: [u64; RECENT],
    oldest: usize,
}

impl Lines {
    /// `line_bytes` is a power of two.
    pub(crate) fn new(texel_bytes: u32, line_bytes: u32) -> Self {
        let (texel_bytes, line) = (texel_bytes.max(1), line_bytes.max(1));
        let per_texel = if line.is_multiple_of(texel_bytes) { 1 } else { (texel_bytes - 1) / line + 2 };
        Self { texel_bytes, line_shift: line.ilog2(), per_texel, recent: [u64::MAX; RECENT], oldest: 0 }
    }

    /// The look-ups that follow are of another step.
    #[inline]
    pub(crate) fn begin_step(&mut self) {
        self.recent = [u64::MAX; RECENT];
    }

    /// Looks up the taps of a level `width` texels wide that starts `base` texels from the start of the memory: mostly all
    /// four texels lie in one 4 x 4 block, which is one line.
    #[inline]
    pub(crate) fn look_up(&mut self, width: u32, base: u64, taps: &Taps, traffic: &mut Traffic) {
        let bytes = u64::from(self.texel_bytes);
        let addresses = tap_offsets(width, taps).map(|offset| (base + offset) * bytes);
        if self.per_texel > 1 {
            // Rare enough to leave telling the lines apart to the cache.
            return addresses.into_iter().for_each(|address| traffic.look_up(NORMAL_MAP, address, self.texel_bytes));
        }
        let [a, b, c, d] = addresses;
        self.look_up_line(a, traffic);
        if ((a ^ b) | (a ^ c) | (a ^ d)) >> self.line_shift != 0 {
            [b, c, d].into_iter().for_each(|address| self.look_up_line(address, traffic));
        }
    }

    #[inline]
    fn look_up_line(&mut self, address: u64, traffic: &mut Traffic) {
        let line = address >> self.line_shift;
        if !self.recent.contains(&line) {
            self.recent[self.oldest % RECENT] = line;
            self.oldest += 1;
            traffic.look_up(NORMAL_MAP, address, self.texel_bytes);
        }
    }
}
