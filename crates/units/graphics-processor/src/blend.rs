//! Colour of a pixel.

use basrelief_shading::{SampleTaps, saturated};
use basrelief_signals::Image;
use basrelief_signals::MapInline as _;

/// Returns the filtered RGB of the texels in `taps`, 0..=1 each.
#[inline]
pub fn filtered(image: &Image, taps: &SampleTaps) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for (&[column, row], &weight) in taps.texel.iter().zip(&taps.weight).take(usize::from(taps.count)) {
        let texel = image.texels.get(row as usize * image.width as usize + column as usize);
        for (sum, &stored) in sum.iter_mut().zip(texel.copied().unwrap_or_default().iter()) {
            *sum += weight * f32::from(stored);
        }
    }
    sum.map_inline(|c| c / 255.0)
}

/// Computes `base * brightness + highlight` in 8 bits each. Values saturate and halves round up.
#[inline]
pub fn blended(base: [f32; 3], brightness: f32, highlight: f32) -> [u8; 3] {
    saturated(base.map_inline(|c| c * brightness + highlight))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn blend_saturates_and_rounds_half_up() {
        assert_eq!(blended([1.0, 0.5, 0.0], 1.0, 0.0), [255, 128, 0]);
        assert_eq!(blended([1.0, 0.5, 0.0], 3.0, 0.0), [255, 255, 0]);
        assert_eq!(blended([1.0, 0.5, 0.0], 0.0, 0.5), [128; 3]);
        assert_eq!(blended([-1.0, f32::NAN, 1.0], 1.0, 0.0), [0, 0, 255]);
    }

    #[test]
    fn filter_weighs_texels() {
        let image = Image { width: 2, height: 1, texels: vec![[0, 51, 255, 255], [255, 51, 0, 0]] };
        let taps = SampleTaps { count: 2, texel: [[0, 0], [1, 0], [9, 9], [9, 9]], weight: [0.25, 0.75, 9.0, 9.0] };
        assert_eq!(filtered(&image, &taps), [0.75, 0.2, 0.25]);
    }

    proptest! {
        #[test]
        fn blend_is_within_half_a_step_of_exact_value(c in 0f32..1.5, b in 0f32..1.5, h in 0f32..0.5) {
            let exact = ((f64::from(c) * f64::from(b) + f64::from(h)) * 255.0).clamp(0.0, 255.0);
            let [drawn, ..] = blended([c; 3], b, h);
            prop_assert!((f64::from(drawn) - exact).abs() <= 0.5001, "{drawn} {exact}");
        }
    }
}
