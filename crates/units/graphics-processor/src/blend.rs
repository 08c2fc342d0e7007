//! Colours of pixels, side by side.

use basrelief_shading::{SampleFootprints, saturated_beside, stored};
use basrelief_signals::Image;
use basrelief_signals::MapInline as _;
use wide::f32x4;

/// Returns the filtered RGB of samples, 0..=1 each.
#[inline(always)]
pub fn filtered(image: &Image, footprints: &SampleFootprints) -> [f32x4; 3] {
    let mut sum = [f32x4::ZERO; 3];
    let taps = footprints.weights().into_iter().zip(footprints.numbers(image.width));
    for (weight, numbers) in taps.take(footprints.count.into()) {
        for (sum, stored) in sum.iter_mut().zip(stored(image, numbers, [0; 4])) {
            *sum += weight * stored;
        }
    }
    sum.map_inline(|c| c / 255.0)
}

/// Computes `base * brightness + highlight` in 8 bits each. Values saturate and halves round up. Returns the bytes by component.
#[inline(always)]
pub fn blended(base: [f32x4; 3], [brightness, highlight]: [f32x4; 2]) -> [[i32; 4]; 3] {
    saturated_beside(base.map_inline(|c| c * brightness + highlight))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use wide::u32x4;

    #[test]
    fn blend_saturates_and_rounds_half_up() {
        let lit = [[1.0, 3.0, 0.0, 1.0], [0.0, 0.0, 0.5, f32::NAN]].map(f32x4::new);
        let bytes = blended([1.0, 0.5, -1.0].map(f32x4::splat), lit);
        assert_eq!(bytes, [[255, 255, 128, 0], [128, 255, 128, 0], [0, 0, 128, 0]]);
    }

    #[test]
    fn filter_weighs_texels() {
        let image = Image { width: 2, height: 1, texels: vec![[0, 51, 255, 255], [255, 51, 0, 0]] };
        let (first, second) = (u32x4::ZERO, u32x4::ONE);
        let shares = [[0.75, 0.0, 1.0, 0.25], [0.0; 4]].map(f32x4::new);
        let footprints = |count| SampleFootprints { count, columns: [first, second], rows: [first; 2], shares };
        let [red, green, blue] = filtered(&image, &footprints(4)).map(f32x4::to_array);
        assert_eq!((red, green, blue), ([0.75, 0.0, 1.0, 0.25], [0.2; 4], [0.25, 1.0, 0.0, 0.75]));
        let cut = Image { texels: vec![[0, 51, 255, 255]], ..image };
        assert_eq!(filtered(&cut, &footprints(4)).map(|c| c.to_array()[2]), [0.0; 3], "the missing texel is black");
    }

    proptest! {
        #[test]
        fn blend_is_within_half_a_step_of_exact_value(c in 0f32..1.5, b in 0f32..1.5, h in 0f32..0.5) {
            let exact = ((f64::from(c) * f64::from(b) + f64::from(h)) * 255.0).clamp(0.0, 255.0);
            let [[drawn, ..], ..] = blended([f32x4::splat(c); 3], [b, h].map(f32x4::splat));
            prop_assert!((f64::from(drawn) - exact).abs() <= 0.5001, "{drawn} {exact}");
        }
    }
}
