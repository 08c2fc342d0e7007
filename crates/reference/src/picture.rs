//! A finished picture.

/// RGB picture, 8 bits per channel, with a mask of drawn pixels. The background is black and not covered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbPicture {
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// `width * height` pixels, top row first.
    pub rgb: Vec<[u8; 3]>,
    /// Pixels that some polygon covered, in the same order as `rgb`.
    pub covered: Vec<bool>,
    /// Number of covered pixels that show the back of a surface; 0 in pictures that this crate did not draw.
    pub backs: usize,
}

impl RgbPicture {
    /// Creates a picture of background only.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        Self::drawn([width, height], vec![[0; 3]; pixels], vec![false; pixels])
    }

    /// A picture of `width * height` pixels that this crate did not draw.
    pub fn drawn([width, height]: [u32; 2], rgb: Vec<[u8; 3]>, covered: Vec<bool>) -> Self {
        Self { width, height, rgb, covered, backs: 0 }
    }

    /// Returns RGBA, 8 bits each, rows from the top. Covered pixels have alpha 255, and the background is 0, 0, 0, 0.
    pub fn to_rgba(&self) -> Vec<u8> {
        let pixel = |(rgb, covered): (&[u8; 3], &bool)| [rgb[0], rgb[1], rgb[2], if *covered { 255 } else { 0 }];
        self.rgb.iter().zip(&self.covered).flat_map(pixel).collect()
    }
}

/// Converts 0..=1 to 0..=255 as in OpenGL: saturated, rounded half up. NaN becomes 0.
pub(crate) fn to_8_bits(channel: f64) -> u8 {
    (channel.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_up_and_saturates() {
        assert_eq!(to_8_bits(0.5 / 255.0), 1);
        assert_eq!(to_8_bits(0.499 / 255.0), 0);
        assert_eq!([to_8_bits(-1.0), to_8_bits(7.0), to_8_bits(f64::NAN)], [0, 255, 0]);
    }

    #[test]
    fn background_is_transparent_black() {
        let mut picture = RgbPicture::new(2, 1);
        picture.rgb[1] = [1, 2, 3];
        picture.covered[1] = true;
        assert_eq!(picture.to_rgba(), [0, 0, 0, 0, 1, 2, 3, 255]);
    }
}
