//! Texture sampling as defined by OpenGL, and as in the rate-limited renderer, in `f64`.

use crate::{LevelRule, PyramidLevels, RenderOptions, TexelCentre, TextureFilter};
use basrelief_signals::{Image, Texture, WrapMode};
use glam::{DVec2, DVec3};

/// Texture coordinates of a pixel and their change per pixel to the right and down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextureFootprint {
    pub at: DVec2,
    pub right: DVec2,
    pub down: DVec2,
}

/// Returns the filtered RGB, 0..=1. A texture without levels is white.
pub(crate) fn sample(texture: &Texture, options: &RenderOptions, footprint: &TextureFootprint) -> DVec3 {
    let Some(finest) = texture.levels.first() else { return DVec3::ONE };
    let sampler = TextureSampler { texture, finest, pyramid: options.pyramid, at: footprint.at };
    let lod = || {
        let last = texture.levels.len() - 1;
        level_of_detail(finest, options.level, footprint).clamp(0.0, last as f64)
    };
    let stored = match options.filter {
        TextureFilter::None => return DVec3::ONE,
        TextureFilter::Nearest => sampler.nearest(0),
        TextureFilter::Bilinear => sampler.bilinear(0),
        TextureFilter::Trilinear => blended(lod(), |k| sampler.bilinear(k)),
        TextureFilter::NearestMipNearest => sampler.nearest(nearest_level(lod())),
        TextureFilter::BilinearMipNearest => sampler.bilinear(nearest_level(lod())),
        TextureFilter::NearestMipLinear => blended(lod(), |k| sampler.nearest(k)),
    };
    stored / 255.0
}

/// Returns the level of detail of a pixel, or minus infinity if its footprint is a point.
fn level_of_detail(finest: &Image, rule: LevelRule, footprint: &TextureFootprint) -> f64 {
    let size = DVec2::new(f64::from(finest.width), f64::from(finest.height));
    let (right, down) = (footprint.right * size, footprint.down * size);
    match rule {
        LevelRule::LongerAxis => 0.5 * libm::log2(right.length_squared().max(down.length_squared())),
        LevelRule::AlongScanLine => libm::log2(right.abs().max_element()),
    }
}

/// Blends the values of two levels by the fraction of the level of detail.
fn blended(lod: f64, of: impl Fn(usize) -> DVec3) -> DVec3 {
    let level = lod.floor() as usize;
    let fraction = lod - level as f64;
    let fine = of(level);
    if fraction > 0.0 { fine + (of(level + 1) - fine) * fraction } else { fine }
}

/// Returns the nearest level. A tie selects the finer one.
fn nearest_level(lod: f64) -> usize {
    (lod - 0.5).ceil().max(0.0) as usize
}

/// A texture at one pair of coordinates.
struct TextureSampler<'a> {
    texture: &'a Texture,
    finest: &'a Image,
    pyramid: PyramidLevels,
    at: DVec2,
}

impl TextureSampler<'_> {
    fn nearest(&self, level: usize) -> DVec3 {
        let Some(image) = self.texture.levels.get(level) else { return DVec3::ZERO };
        let [column, row] = self.place(image, level).map(|(at, size, wrap)| wrapped(at.floor(), size, wrap));
        texel(image, column, row)
    }

    fn bilinear(&self, level: usize) -> DVec3 {
        let Some(image) = self.texture.levels.get(level) else { return DVec3::ZERO };
        let [(left, right, fx), (upper, lower, fy)] = self.place(image, level).map(|(at, size, wrap)| taps(at, size, wrap));
        let row = |y| {
            let start = texel(image, left, y);
            start + (texel(image, right, y) - start) * fx
        };
        let top = row(upper);
        top + (row(lower) - top) * fy
    }

    /// Returns, across and down: the coordinate in texels of a level (texel i covers i..i + 1), the number of texels, and the
    /// wrap mode.
    fn place(&self, image: &Image, level: usize) -> [(f64, u32, WrapMode); 2] {
        let [across, down] = self.texture.sampler.wrap;
        [
            (self.coordinate(self.at.x, self.finest.width, image.width, level, across), image.width, across),
            (self.coordinate(self.at.y, self.finest.height, image.height, level, down), image.height, down),
        ]
    }

    fn coordinate(&self, at: f64, finest: u32, size: u32, level: usize, wrap: WrapMode) -> f64 {
        let PyramidLevels::Tiled { centre, .. } = self.pyramid else { return at * f64::from(size) };
        // Period and edge are those of the finest level, because a side that was rounded up does not fill its level.
        let inside = match wrap {
            WrapMode::Repeat => at.rem_euclid(1.0),
            WrapMode::Clamp => at.clamp(0.0, 1.0),
            WrapMode::Mirror => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
        };
        let corner = match centre {
            TexelCentre::Half => 0.0,
            TexelCentre::Integer => 0.5,
        };
        inside * f64::from(finest) / (1_u64 << level.min(63)) as f64 + corner
    }
}

/// Returns the two texels around a coordinate and the share of the second.
fn taps(coordinate: f64, size: u32, wrap: WrapMode) -> (usize, usize, f64) {
    let at = coordinate - 0.5;
    let first = at.floor();
    (wrapped(first, size, wrap), wrapped(first + 1.0, size, wrap), at - first)
}

/// Wraps an unbounded texel number (a whole number) into 0..size. NaN becomes 0.
fn wrapped(index: f64, size: u32, wrap: WrapMode) -> usize {
    let size = f64::from(size);
    if index >= 0.0 && index < size {
        return index as usize;
    }
    let inside = match wrap {
        WrapMode::Repeat => index.rem_euclid(size),
        WrapMode::Clamp => index,
        WrapMode::Mirror => {
            let folded = index.rem_euclid(2.0 * size);
            if folded < size { folded } else { 2.0 * size - 1.0 - folded }
        }
    };
    inside.clamp(0.0, size - 1.0) as usize
}

/// Returns RGB as stored, 0..=255, or white if the image is too short.
fn texel(image: &Image, column: usize, row: usize) -> DVec3 {
    let [r, g, b, _] = image.texels.get(row * image.width as usize + column).copied().unwrap_or([255; 4]);
    DVec3::new(f64::from(r), f64::from(g), f64::from(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Sampler as Modes;

    fn gray(width: u32, height: u32, values: &[u8]) -> Image {
        Image { width, height, texels: values.iter().map(|&v| [v, v, v, 255]).collect() }
    }

    fn ramp(wrap: WrapMode) -> Texture {
        let sampler = Modes { wrap: [wrap; 2], ..Modes::default() };
        let levels = vec![gray(4, 1, &[0, 51, 102, 153]), gray(2, 1, &[0, 255]), gray(1, 1, &[204])];
        Texture { id: 0, name: String::new(), sampler, levels, offset: 0, elsewhere: None }
    }

    /// Returns the value in fifths at column coordinate `u` \[texels of level 0\], with a footprint of `step` texels.
    fn fifths(texture: &Texture, filter: TextureFilter, u: f64, step: f64) -> f64 {
        let at = TextureFootprint { at: DVec2::new(u / 4.0, 0.5), right: DVec2::new(step / 4.0, 0.0), down: DVec2::ZERO };
        sample(texture, &RenderOptions { filter, ..RenderOptions::default() }, &at).x * 5.0
    }

    /// Returns the value as [`fifths`], with any options and footprint \[texels of level 0\].
    fn fifths_by(texture: &Texture, options: RenderOptions, u: f64, right: [f64; 2], down: [f64; 2]) -> f64 {
        let finest = &texture.levels[0];
        let size = DVec2::new(f64::from(finest.width), f64::from(finest.height));
        let at =
            TextureFootprint { at: DVec2::new(u, 0.5) / size, right: DVec2::from(right) / size, down: DVec2::from(down) / size };
        sample(texture, &options, &at).x * 5.0
    }

    #[test]
    fn texel_centres_are_exact_and_linear_in_between() {
        let texture = ramp(WrapMode::Clamp);
        for (u, expected) in [(0.5, 0.0), (1.5, 1.0), (2.0, 1.5), (3.5, 3.0), (0.0, 0.0), (4.0, 3.0), (9.0, 3.0)] {
            assert!((fifths(&texture, TextureFilter::Bilinear, u, 0.0) - expected).abs() < 1e-12, "u = {u}");
        }
    }

    #[test]
    fn wrap_modes_match_opengl() {
        let nearest = |wrap, u| fifths(&ramp(wrap), TextureFilter::Nearest, u, 0.0).round();
        let row = |wrap| [-4.5, -1.5, -0.5, 0.5, 3.9, 4.5, 7.5, 8.5].map(|u| nearest(wrap, u));
        assert_eq!(row(WrapMode::Repeat), [3.0, 2.0, 3.0, 0.0, 3.0, 0.0, 3.0, 0.0]);
        assert_eq!(row(WrapMode::Mirror), [3.0, 1.0, 0.0, 0.0, 3.0, 3.0, 0.0, 0.0]);
        assert_eq!(row(WrapMode::Clamp), [0.0, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0]);
        let seam = fifths(&ramp(WrapMode::Repeat), TextureFilter::Bilinear, 0.0, 0.0);
        assert!((seam - 1.5).abs() < 1e-12);
    }

    #[test]
    fn level_of_detail_selects_and_blends_levels() {
        let texture = ramp(WrapMode::Clamp);
        let at = |step| fifths(&texture, TextureFilter::Trilinear, 1.5, step);
        assert!((at(0.0) - 1.0).abs() < 1e-12, "magnified: level 0");
        assert!((at(1.0) - 1.0).abs() < 1e-12);
        assert!((at(2.0) - 1.25).abs() < 1e-12, "level 1, a quarter of the way");
        assert!((at(4.0) - 4.0).abs() < 1e-12);
        assert!((at(1e9) - 4.0).abs() < 1e-12, "last level");
        assert!((at(2.0 * std::f64::consts::SQRT_2) - 0.5 * (1.25 + 4.0)).abs() < 1e-9);
    }

    const FILTERS: [TextureFilter; 6] = [
        TextureFilter::Nearest,
        TextureFilter::Bilinear,
        TextureFilter::Trilinear,
        TextureFilter::NearestMipNearest,
        TextureFilter::BilinearMipNearest,
        TextureFilter::NearestMipLinear,
    ];

    const TILED: PyramidLevels = PyramidLevels::Tiled { tile: [1, 1], centre: TexelCentre::Half };

    #[test]
    fn nearest_level_tie_selects_finer_level() {
        let texture = ramp(WrapMode::Clamp);
        let half_way = std::f64::consts::SQRT_2;
        let (below, above) = (half_way * 0.999, half_way * 1.001);
        let nearest = |step| fifths(&texture, TextureFilter::NearestMipNearest, 3.2, step);
        assert_eq!([0.0, 1.0, below, above, 2.0, 4.0, 1e9].map(nearest), [3.0, 3.0, 3.0, 5.0, 5.0, 4.0, 4.0]);
        assert_eq!((nearest_level(0.5), nearest_level(1.5), nearest_level(0.0)), (0, 1, 0));
        let bilinear = |step| fifths(&texture, TextureFilter::BilinearMipNearest, 1.5, step);
        assert!((bilinear(below) - 1.0).abs() < 1e-12 && (bilinear(above) - 1.25).abs() < 1e-12);
        let blended = fifths(&texture, TextureFilter::NearestMipLinear, 3.2, half_way);
        assert!((blended - 4.0).abs() < 1e-9, "half of 3 and half of 5: {blended}");
    }

    // Claim: images: The level of the MIP-map selector (320) is that of the derived formula.
    #[test]
    fn mip_map_selector_uses_only_scan_line_direction() {
        let texture = ramp(WrapMode::Clamp);
        let by =
            |level| move |right, down| fifths_by(&texture, RenderOptions { level, ..RenderOptions::default() }, 1.5, right, down);
        let scan_line = by(LevelRule::AlongScanLine);
        assert!((scan_line([2.0, 0.0], [1e6, 1e6]) - 1.25).abs() < 1e-12, "level 1, whatever changes downwards");
        assert!((scan_line([-4.0, 0.1], [0.0, 0.0]) - 4.0).abs() < 1e-12);
        assert!((scan_line([2.0, 2.0], [0.0, 0.0]) - 1.25).abs() < 1e-12, "the larger component, not the length");
        assert!((scan_line([0.0, 0.0], [9.0, 9.0]) - 1.0).abs() < 1e-12, "no change at all: level 0");
    }

    /// Creates a row of five texels: levels of 5, 3, 2 and 1 texels if sides are rounded up.
    fn five(centre: TexelCentre, wrap: WrapMode) -> (Texture, RenderOptions) {
        let sampler = Modes { wrap: [wrap; 2], ..Modes::default() };
        let levels = [&[0, 10, 20, 30, 40][..], &[5, 25, 40], &[15, 40], &[28]].map(|v| gray(v.len() as u32, 1, v));
        let options = RenderOptions { pyramid: PyramidLevels::Tiled { tile: [1, 1], centre }, ..RenderOptions::default() };
        (Texture { id: 0, name: String::new(), sampler, levels: levels.into(), offset: 0, elsewhere: None }, options)
    }

    #[test]
    fn tiled_texels_of_level_k_are_2_to_the_k_finest_wide() {
        let value = |centre, wrap, u, step| {
            let (texture, options) = five(centre, wrap);
            fifths_by(&texture, options, u, [step, 0.0], [0.0, 0.0]) * 51.0
        };
        let half = |u, step| value(TexelCentre::Half, WrapMode::Clamp, u, step);
        assert!((half(1.0, 2.0) - 5.0).abs() < 1e-9 && (half(3.0, 2.0) - 25.0).abs() < 1e-9, "middles of level 1");
        assert!((half(2.0, 2.0) - 15.0).abs() < 1e-9 && (half(5.0, 2.0) - 40.0).abs() < 1e-9);
        assert!((half(5.0, 4.0) - 33.75).abs() < 1e-9, "the edge of level 2 is a quarter into its last texel");
        assert_eq!([half(5.001, 4.0), half(70.0, 4.0)], [half(5.0, 4.0); 2], "and goes on beyond");
        let integer = |u, step| value(TexelCentre::Integer, WrapMode::Clamp, u, step);
        assert!((integer(2.0, 2.0) - 25.0).abs() < 1e-9, "texel 1 of level 1, half a texel aside");
        assert!((integer(3.0, 1.0) - 30.0).abs() < 1e-9);
        // The seam of a texture that repeats: half of the last texel and half of the first, on every level.
        let seam = value(TexelCentre::Half, WrapMode::Repeat, 0.0, 2.0);
        assert!((seam - 22.5).abs() < 1e-9, "{seam}");
        assert!((value(TexelCentre::Half, WrapMode::Repeat, 5.0 + 3.0, 2.0) - 25.0).abs() < 1e-9, "one turn on");
        assert!((value(TexelCentre::Half, WrapMode::Mirror, 10.0 - 3.0, 2.0) - 25.0).abs() < 1e-9, "and mirrored");
        assert!((value(TexelCentre::Half, WrapMode::Mirror, -3.0, 2.0) - 25.0).abs() < 1e-9);
    }

    #[test]
    fn invalid_texture_input_is_harmless() {
        let mut texture = ramp(WrapMode::Mirror);
        for u in [f64::NAN, f64::INFINITY, -1e300] {
            for filter in FILTERS {
                let _ = fifths(&texture, filter, u, u);
                let _ =
                    fifths_by(&texture, RenderOptions { filter, pyramid: TILED, ..RenderOptions::default() }, u, [u, u], [u, u]);
            }
        }
        texture.levels[0].texels.clear();
        assert_eq!(fifths(&texture, TextureFilter::Nearest, 0.5, 0.0), 5.0);
        texture.levels.clear();
        assert_eq!(fifths(&texture, TextureFilter::Trilinear, 0.5, 0.0), 5.0);
    }
}
