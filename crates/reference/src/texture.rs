//! Texture sampling as OpenGL defines it, in `f64`.

use crate::TextureFilter;
use basrelief_signals::{Image, Texture, Wrap};
use glam::{DVec2, DVec3};

/// Texture coordinates of a pixel and their change per pixel to the right and down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    pub at: DVec2,
    pub right: DVec2,
    pub down: DVec2,
}

/// Filtered RGB, 0..=1. A texture without levels is white.
pub(crate) fn sample(texture: &Texture, filter: TextureFilter, footprint: &Footprint) -> DVec3 {
    let Some(finest) = texture.levels.first() else { return DVec3::ONE };
    let wrap = texture.sampler.wrap;
    let stored = match filter {
        TextureFilter::None => return DVec3::ONE,
        TextureFilter::Nearest => nearest(finest, wrap, footprint.at),
        TextureFilter::Bilinear => bilinear(finest, wrap, footprint.at),
        TextureFilter::Trilinear => trilinear(texture, level_of_detail(finest, footprint), footprint.at),
    };
    stored / 255.0
}

/// log2 of the longer axis of the pixel's footprint \[texels of level 0\]; minus infinity where it is a point.
fn level_of_detail(finest: &Image, footprint: &Footprint) -> f64 {
    let size = DVec2::new(f64::from(finest.width), f64::from(finest.height));
    let squared = (footprint.right * size).length_squared().max((footprint.down * size).length_squared());
    0.5 * libm::log2(squared)
}

fn trilinear(texture: &Texture, lod: f64, at: DVec2) -> DVec3 {
    let wrap = texture.sampler.wrap;
    let last = texture.levels.len().saturating_sub(1);
    let lod = lod.clamp(0.0, last as f64);
    let level = lod.floor() as usize;
    let fraction = lod - level as f64;
    let of = |k: usize| texture.levels.get(k.min(last)).map_or(DVec3::ZERO, |image| bilinear(image, wrap, at));
    let fine = of(level);
    if fraction > 0.0 { fine + (of(level + 1) - fine) * fraction } else { fine }
}

fn nearest(image: &Image, wrap: [Wrap; 2], at: DVec2) -> DVec3 {
    let column = wrapped((at.x * f64::from(image.width)).floor(), image.width, wrap[0]);
    let row = wrapped((at.y * f64::from(image.height)).floor(), image.height, wrap[1]);
    texel(image, column, row)
}

fn bilinear(image: &Image, wrap: [Wrap; 2], at: DVec2) -> DVec3 {
    let (left, right, fx) = taps(at.x, image.width, wrap[0]);
    let (upper, lower, fy) = taps(at.y, image.height, wrap[1]);
    let row = |y| {
        let start = texel(image, left, y);
        start + (texel(image, right, y) - start) * fx
    };
    let top = row(upper);
    top + (row(lower) - top) * fy
}

/// The two texels around a coordinate and the share of the second.
fn taps(coordinate: f64, size: u32, wrap: Wrap) -> (usize, usize, f64) {
    let at = coordinate * f64::from(size) - 0.5;
    let first = at.floor();
    (wrapped(first, size, wrap), wrapped(first + 1.0, size, wrap), at - first)
}

/// Texel number of an unbounded one (a whole number), 0..size. Not a number becomes 0.
fn wrapped(index: f64, size: u32, wrap: Wrap) -> usize {
    let size = f64::from(size);
    if index >= 0.0 && index < size {
        return index as usize;
    }
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::Clamp => index,
        Wrap::Mirror => {
            let folded = index.rem_euclid(2.0 * size);
            if folded < size { folded } else { 2.0 * size - 1.0 - folded }
        }
    };
    inside.clamp(0.0, size - 1.0) as usize
}

/// RGB as stored, 0..=255; white where the image is too short.
fn texel(image: &Image, column: usize, row: usize) -> DVec3 {
    let [r, g, b, _] = image.texels.get(row * image.width as usize + column).copied().unwrap_or([255; 4]);
    DVec3::new(f64::from(r), f64::from(g), f64::from(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Sampler;

    fn gray(width: u32, height: u32, values: &[u8]) -> Image {
        Image { width, height, texels: values.iter().map(|&v| [v, v, v, 255]).collect() }
    }

    fn ramp(wrap: Wrap) -> Texture {
        let sampler = Sampler { wrap: [wrap; 2], ..Sampler::default() };
        let levels = vec![gray(4, 1, &[0, 51, 102, 153]), gray(2, 1, &[0, 255]), gray(1, 1, &[204])];
        Texture { id: 0, name: String::new(), sampler, levels, offset: 0 }
    }

    /// Value in fifths at column coordinate `u` \[texels of level 0\], footprint `step` texels wide.
    fn fifths(texture: &Texture, filter: TextureFilter, u: f64, step: f64) -> f64 {
        let at = Footprint { at: DVec2::new(u / 4.0, 0.5), right: DVec2::new(step / 4.0, 0.0), down: DVec2::ZERO };
        sample(texture, filter, &at).x * 5.0
    }

    #[test]
    fn texel_centres_are_exact_and_between_them_it_is_linear() {
        let texture = ramp(Wrap::Clamp);
        for (u, expected) in [(0.5, 0.0), (1.5, 1.0), (2.0, 1.5), (3.5, 3.0), (0.0, 0.0), (4.0, 3.0), (9.0, 3.0)] {
            assert!((fifths(&texture, TextureFilter::Bilinear, u, 0.0) - expected).abs() < 1e-12, "u = {u}");
        }
    }

    #[test]
    fn wrap_modes_are_those_of_opengl() {
        let nearest = |wrap, u| fifths(&ramp(wrap), TextureFilter::Nearest, u, 0.0).round();
        let row = |wrap| [-4.5, -1.5, -0.5, 0.5, 3.9, 4.5, 7.5, 8.5].map(|u| nearest(wrap, u));
        assert_eq!(row(Wrap::Repeat), [3.0, 2.0, 3.0, 0.0, 3.0, 0.0, 3.0, 0.0]);
        assert_eq!(row(Wrap::Mirror), [3.0, 1.0, 0.0, 0.0, 3.0, 3.0, 0.0, 0.0]);
        assert_eq!(row(Wrap::Clamp), [0.0, 0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0]);
        let seam = fifths(&ramp(Wrap::Repeat), TextureFilter::Bilinear, 0.0, 0.0);
        assert!((seam - 1.5).abs() < 1e-12);
    }

    #[test]
    fn level_of_detail_picks_and_blends_levels() {
        let texture = ramp(Wrap::Clamp);
        let at = |step| fifths(&texture, TextureFilter::Trilinear, 1.5, step);
        assert!((at(0.0) - 1.0).abs() < 1e-12, "magnified: level 0");
        assert!((at(1.0) - 1.0).abs() < 1e-12);
        assert!((at(2.0) - 1.25).abs() < 1e-12, "level 1, a quarter of the way");
        assert!((at(4.0) - 4.0).abs() < 1e-12);
        assert!((at(1e9) - 4.0).abs() < 1e-12, "last level");
        assert!((at(2.0 * std::f64::consts::SQRT_2) - 0.5 * (1.25 + 4.0)).abs() < 1e-9);
    }

    #[test]
    fn senseless_input_is_harmless() {
        let mut texture = ramp(Wrap::Mirror);
        for u in [f64::NAN, f64::INFINITY, -1e300] {
            for filter in [TextureFilter::Nearest, TextureFilter::Bilinear, TextureFilter::Trilinear] {
                let _ = fifths(&texture, filter, u, u);
            }
        }
        texture.levels[0].texels.clear();
        assert_eq!(fifths(&texture, TextureFilter::Nearest, 0.5, 0.0), 5.0);
        texture.levels.clear();
        assert_eq!(fifths(&texture, TextureFilter::Trilinear, 0.5, 0.0), 5.0);
    }
}
