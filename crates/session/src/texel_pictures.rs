//! The pictures of a log of machine `texel`: displacements, division points.

use crate::heat_map::heat_map;
use basrelief_machines::texel::DisplacementMap;
use basrelief_reference::Picture;

/// How far the texel of each visible pixel is from its place, as a heat map with its scale below: from 0 to the error bound
/// \[pixels\], or to the largest displacement where that is more; then the bound is marked. Pixels without a texture are
/// background.
pub fn displacement_picture(map: &DisplacementMap, error_bound: f64) -> Picture {
    let largest = map.displacement.iter().copied().filter(|d| !d.is_nan()).fold(0.0, f32::max);
    let top = f64::from(largest).max(error_bound);
    let marks: &[f64] = if top > error_bound { &[error_bound] } else { &[] };
    heat_map(map.width, &map.displacement, top, marks)
}

/// The machine's picture, darkened and grey, with every visible pixel whose coordinates were divided in yellow: the ends of
/// spans and the division points between them.
pub fn divisions_picture(picture: &Picture, map: &DisplacementMap) -> Picture {
    const POINT: [u8; 3] = [255, 225, 40];
    let mut drawn = picture.clone();
    for (rgb, divided) in drawn.rgb.iter_mut().zip(&map.divided) {
        let [r, g, b] = rgb.map(u16::from);
        *rgb = if *divided { POINT } else { [((r + 2 * g + b) / 8) as u8; 3] };
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(displacement: &[f32]) -> DisplacementMap {
        let mut map = DisplacementMap::new(displacement.len() as u32, 1);
        (0..).zip(displacement).for_each(|(x, d)| map.note(x, 0, *d, *d == 0.0));
        map
    }

    #[test]
    fn the_scale_ends_at_the_bound_or_at_the_largest_displacement() {
        let within = displacement_picture(&map(&[0.0, 0.25, f32::NAN, 0.5]), 0.5);
        let beyond = displacement_picture(&map(&[0.0, 0.25, f32::NAN, 2.0]), 0.5);
        assert_eq!(within.covered[..4], [true, true, false, true]);
        assert_eq!((within.rgb[0], within.rgb[3]), (beyond.rgb[0], beyond.rgb[3]));
        assert_ne!(within.rgb[1], beyond.rgb[1], "another scale");
    }

    #[test]
    fn divided_pixels_stand_out() {
        let mut picture = Picture::new(3, 1);
        picture.rgb = vec![[80, 80, 80], [200, 100, 0], [0, 0, 0]];
        picture.covered = vec![true, true, false];
        let drawn = divisions_picture(&picture, &map(&[0.0, 0.3, f32::NAN]));
        assert_eq!(drawn.rgb, [[255, 225, 40], [50; 3], [0; 3]]);
        assert_eq!(drawn.covered, picture.covered);
    }
}
