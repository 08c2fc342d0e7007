//! Cache lines of a footprint.

use crate::{LevelPlace, SampleFootprints};
use basrelief_signals::MapInline as _;
use wide::u32x4;

/// Texels of a sample: upper left, upper right, lower left, lower right.
const TAPS: usize = 4;

/// Texels of a memory behind a cache: where the first lies, and how large texels and lines are, in bytes.
#[derive(Clone, Debug)]
pub struct FootprintLines {
    base: u64,
    texel_bytes: u32,
    line_shift: u32,
    /// Logarithm of the texels per line. `None` if a texel can lie across two lines.
    texel_shift: Option<u32>,
    /// Lines that one texel can touch: 1 if texels divide lines.
    per_texel: u32,
}

impl FootprintLines {
    /// Texels of `texel_bytes` bytes from address `base` on, and lines of `line_bytes` bytes, a power of two.
    pub fn new(base: u64, texel_bytes: u32, line_bytes: u32) -> Self {
        let (texel_bytes, line) = (texel_bytes.max(1), line_bytes.max(1));
        let is_aligned = line.is_multiple_of(texel_bytes) && base.is_multiple_of(texel_bytes.into());
        let texel_shift = is_aligned.then(|| (line / texel_bytes).ilog2());
        let per_texel = if is_aligned { 1 } else { (texel_bytes - 1) / line + 2 };
        Self { base, texel_bytes, line_shift: line.ilog2(), texel_shift, per_texel }
    }

    /// Lines that one texel can touch: 1 if texels divide lines.
    pub fn per_texel(&self) -> u32 {
        self.per_texel
    }

    /// Calls `look_up` with address and bytes for the taps of the first `count` samples of the level at this position, in most
    /// cases once per line. A repeated look-up would cost the device nothing, but it would cost host time.
    #[inline(always)]
    pub fn each(&self, place: LevelPlace, footprints: &SampleFootprints, count: usize, mut look_up: impl FnMut(u64, u32)) {
        let texels = place.footprints(footprints);
        let Some(shift) = self.texel_shift else {
            return self.each_texel(place.start, texels, count, &mut look_up);
        };
        let start = self.base / u64::from(self.texel_bytes) + place.start;
        let rest = (start & ((1 << shift) - 1)) as u32;
        let lines = texels.map_inline(|texel| (texel + rest).unbounded_shr_scalar(shift));
        let first = start >> shift;
        let mut new = new_lines(lines) & ((1 << (TAPS * count)) - 1);
        let by_sample = u32x4::transpose(lines).map_inline(u32x4::to_array);
        while new != 0 {
            let tap = new.trailing_zeros() as usize;
            new &= new - 1;
            let line = first + u64::from(by_sample[tap / TAPS][tap % TAPS]);
            look_up(line << self.line_shift, self.texel_bytes);
        }
    }

    /// As `each`, for texels that can lie across lines. The cache handles the duplicates.
    #[inline(never)]
    fn each_texel(&self, start: u64, texels: [u32x4; TAPS], count: usize, look_up: &mut dyn FnMut(u64, u32)) {
        let texels = texels.map_inline(u32x4::to_array);
        for lane in 0..count {
            for tap in texels {
                let address = (start + u64::from(tap[lane])) * u64::from(self.texel_bytes);
                look_up(self.base + address, self.texel_bytes);
            }
        }
    }
}

/// Returns the taps whose line differs from those of their neighbouring taps and of the previous sample: bit 4 * sample + tap.
/// The cache merges all other duplicates. Searching each line among the last four took two unpredictable branches per sample.
#[inline(always)]
fn new_lines([a, b, c, d]: [u32x4; TAPS]) -> u32 {
    // The sample before the first has a line that does not exist.
    let before = |lines: u32x4| {
        let [first, second, third, _] = lines.to_array();
        u32x4::new([u32::MAX, first, second, third])
    };
    let (left, right) = (before(a), before(b));
    let known = u32x4::transpose([
        a.simd_eq(left) | a.simd_eq(right),
        b.simd_eq(a) | b.simd_eq(right),
        c.simd_eq(a) | c.simd_eq(before(c)),
        d.simd_eq(b) | d.simd_eq(c) | d.simd_eq(before(d)),
    ]);
    let [first, second, third, last] = known.map_inline(u32x4::to_bitmask);
    !(first | second << 4 | third << 8 | last << 12)
}
