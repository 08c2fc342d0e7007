use super::*;
use proptest::prelude::*;

fn image(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
    Image { width, height, texels }
}

#[test]
fn four_texels_average_with_rounding_half_up() {
    let levels = color_levels(image(2, 2, |x, y| [(x + 2 * y) as u8, 255, 0, 1]));
    assert_eq!(levels[1].texels, [[2, 255, 0, 1]], "(0 + 1 + 2 + 3 + 2) >> 2 = 2");
}

#[test]
fn boxes_of_an_odd_side_share_the_texels_between_them() {
    let levels = color_levels(image(5, 1, |x, _| [(x * 10) as u8; 4]));
    assert_eq!(levels.iter().map(|l| l.width).collect::<Vec<_>>(), [5, 2, 1]);
    // (2 * 0 + 2 * 10 + 1 * 20) / 5 and (1 * 20 + 2 * 30 + 2 * 40) / 5.
    assert_eq!(levels[1].texels, [[8; 4], [32; 4]]);
    assert_eq!(levels[2].texels, [[20; 4]], "the middle stays where it is");
}

#[test]
fn ramp_keeps_position_on_odd_sized_levels() {
    let ramp = HeightMap { width: 101, height: 1, heights: (0..101).map(|i| f64::from(i) + 0.5).collect() };
    let mut level = ramp;
    for width in [50, 25, 12, 6, 3, 1] {
        level = halve_heights(&level);
        assert_eq!(level.width, width);
        for (i, height) in level.heights.iter().enumerate() {
            let middle = (i as f64 + 0.5) * 101.0 / f64::from(width);
            // Texels are constant inside: a box that holds a part of one is off by less than a sixteenth of its own width.
            assert!((height - middle).abs() * f64::from(width) < 101.0 / 16.0, "texel {i} of {width}: {height}, {middle}");
        }
    }
}

#[test]
fn normal_map_has_eight_levels_and_colour_texture_all() {
    let base = image(1024, 4, |_, _| [128, 128, 255, 0]);
    assert_eq!(normal_levels(base.clone()).len(), 8);
    assert_eq!(color_levels(base).len(), 11);
}

#[test]
fn opposite_normals_cancel_to_the_surface_normal() {
    let levels = normal_levels(image(2, 1, |x, _| if x == 0 { [255, 0, 0, 9] } else { [0, 255, 255, 9] }));
    assert_eq!(levels[0].texels[0], [255, 0, 0, 255]);
    assert_eq!(levels[1].texels[0], encode_normal([0.0, 0.0, 1.0]));
}

/// Heights rise to the right: the surface leans to the left, so red is below the middle; rising downwards makes
/// green larger, since +Y points up the image.
#[test]
fn slopes_have_the_signs_of_the_gltf_convention() {
    let ramp = |dx: f64, dy: f64| HeightMap {
        width: 4,
        height: 4,
        heights: (0..16).map(|i| dx * f64::from(i % 4) + dy * f64::from(i / 4)).collect(),
    };
    let centre = |levels: Vec<Image>| levels[0].texels[5];
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    let clamp = [WrapMode::Clamp; 2];
    assert_eq!(centre(height_levels(ramp(1.0, 0.0), 1.0, clamp)), encode_normal([-diagonal, 0.0, diagonal]));
    assert_eq!(centre(height_levels(ramp(0.0, 1.0), 1.0, clamp)), encode_normal([0.0, diagonal, diagonal]));
}

#[test]
fn slope_is_equal_on_every_level() {
    let ramp = HeightMap { width: 64, height: 64, heights: (0..4096).map(|i| f64::from(i % 64)).collect() };
    for (k, level) in height_levels(ramp, 0.5, [WrapMode::Clamp; 2]).iter().enumerate().take(5) {
        let middle = (level.height / 2 * level.width + level.width / 2) as usize;
        let expected = encode_normal(normalize([-0.5, 0.0, 1.0]));
        assert_eq!(level.texels[middle], expected, "level {k}");
    }
}

#[test]
fn wrapping_follows_the_sampler() {
    assert_eq!([-1, 4, 9].map(|i| wrapped(i, 4, WrapMode::Repeat)), [3, 0, 1]);
    assert_eq!([-1, 4, 9].map(|i| wrapped(i, 4, WrapMode::Clamp)), [0, 3, 3]);
    assert_eq!([-1, 4, 9].map(|i| wrapped(i, 4, WrapMode::Mirror)), [0, 3, 1]);
}

proptest! {
    #[test]
    fn pairs_give_texels_of_boxes(half_width in 1u32..9, half_height in 1u32..9, seed in any::<u32>()) {
        let base = image(2 * half_width, 2 * half_height, |x, y| {
            (seed ^ (x + 31 * y).wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b).to_le_bytes()
        });
        let boxed = |mean: fn(&Image, TexelCover) -> [u8; 4]| boxes(base.width, base.height, |covered| mean(&base, covered));
        prop_assert_eq!(halve_pairs::<ColorMean>(&base), boxed(ColorMean::of_box));
        prop_assert_eq!(halve_pairs::<NormalMean>(&base), boxed(NormalMean::of_box));
    }

    #[test]
    fn sizes_halve_and_a_constant_stays_constant(width in 1u32..40, height in 1u32..40, value in any::<[u8; 4]>()) {
        let levels = color_levels(image(width, height, |_, _| value));
        let mut size = (width, height);
        for level in &levels {
            prop_assert_eq!((level.width, level.height), size);
            prop_assert_eq!(level.texels.len() as u32, size.0 * size.1);
            prop_assert!(level.texels.iter().all(|t| *t == value));
            size = (half(size.0), half(size.1));
        }
        prop_assert_eq!((levels[levels.len() - 1].width, levels[levels.len() - 1].height), (1, 1));
    }

    #[test]
    fn every_level_of_a_height_map_stores_unit_normals(
        heights in proptest::collection::vec(0.0f64..1.0, 35), strength in 0.0f64..20.0
    ) {
        for level in height_levels(HeightMap { width: 7, height: 5, heights }, strength, [WrapMode::Repeat; 2]) {
            for t in &level.texels {
                let length: f64 = [0, 1, 2].map(|i| f64::from(t[i]) / 127.5 - 1.0).iter().map(|c| c * c).sum();
                prop_assert!((length.sqrt() - 1.0).abs() < 0.01);
                prop_assert_eq!(t[3], 255);
            }
        }
    }
}
