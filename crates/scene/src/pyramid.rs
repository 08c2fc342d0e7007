//! MIP pyramids of colour textures, normal maps and height maps.
//!
//! Each level has `max(1, floor(size / 2))` texels per side and covers the one before it with as many boxes of equal size:
//! 2 texels wide where the side is even, and where it is 2m + 1 texels, 2 + 1/m texels. A texel that two boxes share counts
//! in each by its part. (With boxes of 2 and the odd texel dropped, or joined to the last box, the picture would shift from
//! level to level by up to a texel: against Mesa, which resamples, a floor of 101 x 38 texels was at
//! 27 to 29 dB so, and is at 36 to 41 now.)

use basrelief_signals::{Image, WrapMode};
use basrelief_threads as threads;
use wide::f64x4;

/// Levels of a normal map, 0..=7: the LOD range 0..=63 addresses these.
pub const NORMAL_LEVELS: usize = 8;

/// A grey image of heights.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// Width \[texels\], at least 1.
    pub width: u32,
    /// Height \[texels\], at least 1.
    pub height: u32,
    /// `width * height` heights, top row first; 1 is `strength` texels high.
    pub heights: Vec<f64>,
}

/// Levels of a colour texture, down to 1 x 1: the mean of the stored values, rounded half up.
pub fn color_levels(base: Image) -> Vec<Image> {
    levels::<ColorMean>(base, usize::MAX)
}

/// Levels of a normal map: mean of the decoded normals, made unit again. Level 0 keeps its texels as they are, only
/// alpha becomes 255.
pub fn normal_levels(mut base: Image) -> Vec<Image> {
    for texel in &mut base.texels {
        texel[3] = 255;
    }
    levels::<NormalMean>(base, NORMAL_LEVELS)
}

/// Normal map of a height map, level by level: the heights are filtered, then differentiated.
///
/// `strength` is the height \[texels of level 0\] of 1.0. Level k holds `normalize(-dh/dcol, dh/drow, 1)` with central
/// differences over its own texels, divided by 2^k since they are 2^k level-0 texels wide.
pub fn height_levels(base: HeightMap, strength: f64, wrap: [WrapMode; 2]) -> Vec<Image> {
    let mut map = base;
    let mut images = Vec::new();
    let mut scale = strength;
    loop {
        images.push(differentiate(&map, scale, wrap));
        if images.len() == NORMAL_LEVELS || (map.width == 1 && map.height == 1) {
            return images;
        }
        map = halve_heights(&map);
        scale *= 0.5;
    }
}

/// The heights of a picture: the mean of its red, green and blue, 0..=1.
pub fn heights_of(image: &Image) -> HeightMap {
    HeightMap::of_texels([image.width, image.height], &image.texels, u8::MAX)
}

impl HeightMap {
    /// Returns the mean of red, green and blue of RGBA texels. `white` becomes 1.
    pub(crate) fn of_texels<T: Copy + Into<f64>>([width, height]: [u32; 2], texels: &[[T; 4]], white: T) -> Self {
        let mean = |t: &[T; 4]| (t[0].into() + t[1].into() + t[2].into()) / (3.0 * white.into());
        Self { width, height, heights: texels.iter().map(mean).collect() }
    }
}

/// The unit normal that a texel stores; a zero vector gives (0, 0, 1).
pub fn decode_normal(texel: [u8; 4]) -> [f64; 3] {
    normalize([0, 1, 2].map(|i| COMPONENTS[usize::from(texel[i])]))
}

/// Component of a normal before normalization, by the stored value.
const COMPONENTS: [f64; 256] = {
    let mut components = [0.0; 256];
    let mut value = 0;
    while value < components.len() {
        components[value] = value as f64 / 127.5 - 1.0;
        value += 1;
    }
    components
};

/// The texel that stores a unit normal: round(127.5 * (n + 1)), alpha 255.
pub fn encode_normal(normal: [f64; 3]) -> [u8; 4] {
    let [x, y, z] = normal.map(|n| {
        let value = (127.5 * (n + 1.0)).clamp(0.0, 255.0);
        // `f64::round` is a call, unless the processor has more than the base instructions.
        let whole = value as u8;
        whole + u8::from(value - f64::from(whole) >= 0.5)
    });
    [x, y, z, 255]
}

fn levels<M: TexelMean>(base: Image, most: usize) -> Vec<Image> {
    let mut all = Vec::new();
    let mut last = base;
    while all.len() + 1 < most && (last.width > 1 || last.height > 1) {
        let next = halve::<M>(&last);
        all.push(std::mem::replace(&mut last, next));
    }
    all.push(last);
    all
}

fn halve<M: TexelMean>(image: &Image) -> Image {
    let (width, height) = (half(image.width), half(image.height));
    let in_pairs = image.width.is_multiple_of(2) && image.height.is_multiple_of(2);
    let texels = if in_pairs && image.texels.len() == image.width as usize * image.height as usize {
        halve_pairs::<M>(image)
    } else {
        boxes(image.width, image.height, |covered| M::of_box(image, covered))
    };
    Image { width, height, texels }
}

/// Returns the next level of an image with even sides. Boxes of equal weights take a quarter of the instructions of [`boxes`].
fn halve_pairs<M: TexelMean>(image: &Image) -> Vec<[u8; 4]> {
    let side = image.width as usize;
    threads::par_fill_rows(side / 2, image.height as usize / 2, |row, texels| {
        let (upper, lower) = image.texels[2 * row * side..][..2 * side].split_at(side);
        M::of_pairs([upper.as_chunks().0, lower.as_chunks().0], texels);
    })
}

/// Two texels side by side.
type TexelPair = [[u8; 4]; 2];

/// Mean of texels.
trait TexelMean {
    /// Computes the means of boxes of four texels of equal weight, two of an upper and two of a lower row.
    fn of_pairs(rows: [&[TexelPair]; 2], means: &mut [[u8; 4]]);
    /// Returns the mean of the texels that a box covers.
    fn of_box(image: &Image, covered: TexelCover) -> [u8; 4];
}

fn half(size: u32) -> u32 {
    (size / 2).max(1)
}

/// Columns and rows that a texel of the next level covers.
type TexelCover = [SideCover; 2];

/// Up to three texels of a side, from the first, and their weights.
#[derive(Clone, Copy)]
struct SideCover {
    first: u32,
    weights: [u32; 3],
}

impl SideCover {
    /// Part of a side that texel `i` of the next level covers.
    fn of(i: u32, size: u32) -> Self {
        let m = size / 2;
        let weights = match size {
            1 => [1, 0, 0],
            _ if size.is_multiple_of(2) => [1, 1, 0],
            _ => [m - i, m, i + 1],
        };
        Self { first: 2 * i, weights }
    }

    fn texels(self) -> impl Iterator<Item = (u32, u32)> {
        (self.first..).zip(self.weights).filter(|(_, weight)| *weight > 0)
    }
}

/// A value for every box of the next level, row by row.
fn boxes<T: Clone + Default + Send>(width: u32, height: u32, mean: impl Fn(TexelCover) -> T + Sync) -> Vec<T> {
    threads::par_fill_rows(half(width) as usize, half(height) as usize, |row, texels| {
        let rows = SideCover::of(row as u32, height);
        for (column, texel) in (0..).zip(texels) {
            *texel = mean([SideCover::of(column, width), rows]);
        }
    })
}

/// Numbers of the texels in a box, and their weights.
fn texels_in(width: u32, [x, y]: TexelCover) -> impl Iterator<Item = (usize, u64)> {
    y.texels().flat_map(move |(row, down)| {
        x.texels()
            .map(move |(column, across)| (row as usize * width as usize + column as usize, u64::from(down) * u64::from(across)))
    })
}

/// Mean of stored values, rounded half up.
struct ColorMean;

impl TexelMean for ColorMean {
    fn of_pairs([upper, lower]: [&[TexelPair]; 2], means: &mut [[u8; 4]]) {
        for (mean, (&[a, b], &[c, d])) in means.iter_mut().zip(upper.iter().zip(lower)) {
            *mean = std::array::from_fn(|i| ([a, b, c, d].iter().fold(2, |sum, texel| sum + u16::from(texel[i])) / 4) as u8);
        }
    }

    fn of_box(image: &Image, covered: TexelCover) -> [u8; 4] {
        let (mut sum, mut whole) = ([0; 4], 0);
        for (texel, weight) in texels_in(image.width, covered).filter_map(|(i, weight)| Some((image.texels.get(i)?, weight))) {
            whole += weight;
            for (s, t) in sum.iter_mut().zip(texel) {
                *s += u64::from(*t) * weight;
            }
        }
        let whole = whole.max(1);
        sum.map(|s| ((s + whole / 2) / whole) as u8)
    }
}

/// Mean of decoded normals, made unit again.
struct NormalMean;

impl TexelMean for NormalMean {
    fn of_pairs([upper, lower]: [&[TexelPair]; 2], means: &mut [[u8; 4]]) {
        let mut boxes = upper.iter().zip(lower).map(|(&[a, b], &[c, d])| [a, b, c, d]);
        let (groups, rest) = means.as_chunks_mut();
        for group in groups {
            *group = mean_normals(std::array::from_fn(|_| boxes.next().unwrap_or_default()));
        }
        for (mean, texels) in rest.iter_mut().zip(boxes) {
            [*mean, ..] = mean_normals([texels; 4]);
        }
    }

    fn of_box(image: &Image, covered: TexelCover) -> [u8; 4] {
        let mut sum = [0.0; 3];
        for (texel, weight) in texels_in(image.width, covered).filter_map(|(i, weight)| Some((image.texels.get(i)?, weight))) {
            for (s, n) in sum.iter_mut().zip(decode_normal(*texel)) {
                *s += n * weight as f64;
            }
        }
        encode_normal(normalize(sum))
    }
}

/// Returns the mean normals of four boxes of four texels, side by side. One box after the other took a third more time.
#[inline]
fn mean_normals(boxes: [[[u8; 4]; 4]; 4]) -> [[u8; 4]; 4] {
    let mut sum = [f64x4::ZERO; 3];
    for place in 0..4 {
        let [x, y, z] = [0, 1, 2].map(|i| f64x4::new(boxes.map(|texels| COMPONENTS[usize::from(texels[place][i])])));
        // No component is 0, so no length is.
        let length = (x * x + y * y + z * z).sqrt();
        for (s, n) in sum.iter_mut().zip([x, y, z]) {
            *s += n / length;
        }
    }
    let lanes = sum.map(f64x4::to_array);
    std::array::from_fn(|lane| encode_normal(normalize(lanes.map(|component| component[lane]))))
}

fn halve_heights(map: &HeightMap) -> HeightMap {
    let mean = |covered: TexelCover| {
        let heights = texels_in(map.width, covered).filter_map(|(i, weight)| Some((map.heights.get(i)?, weight as f64)));
        let (sum, whole) = heights.fold((0.0, 0.0), |(sum, whole), (height, weight)| (sum + height * weight, whole + weight));
        if whole > 0.0 { sum / whole } else { 0.0 }
    };
    HeightMap { width: half(map.width), height: half(map.height), heights: boxes(map.width, map.height, mean) }
}

fn differentiate(map: &HeightMap, scale: f64, wrap: [WrapMode; 2]) -> Image {
    let at = |column: i64, row: i64| {
        let (x, y) = (wrapped(column, map.width, wrap[0]), wrapped(row, map.height, wrap[1]));
        map.heights.get(y * map.width as usize + x).copied().unwrap_or_default()
    };
    let normal = |column: i64, row: i64| {
        let slope_right = scale * (at(column + 1, row) - at(column - 1, row)) / 2.0;
        let slope_down = scale * (at(column, row + 1) - at(column, row - 1)) / 2.0;
        encode_normal(normalize([-slope_right, slope_down, 1.0]))
    };
    let texels = threads::par_fill_rows(map.width as usize, map.height as usize, |row, texels| {
        for (column, texel) in (0..).zip(texels) {
            *texel = normal(column, row as i64);
        }
    });
    Image { width: map.width, height: map.height, texels }
}

fn wrapped(i: i64, size: u32, wrap: WrapMode) -> usize {
    let size = i64::from(size);
    let inside = match wrap {
        WrapMode::Repeat => i.rem_euclid(size),
        WrapMode::Clamp => i.clamp(0, size - 1),
        WrapMode::Mirror => {
            let folded = i.rem_euclid(2 * size);
            folded.min(2 * size - 1 - folded)
        }
    };
    inside as usize
}

fn normalize(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    if length > 0.0 && length.is_finite() { v.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}

#[cfg(test)]
mod tests;
