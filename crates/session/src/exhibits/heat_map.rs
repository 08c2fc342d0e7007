//! Values per pixel as colours, with the scale drawn below.

use super::lettering::{ADVANCE, set, write};
use basrelief_reference::Picture;

/// Height of the scale below the picture \[pixels\]: a bar, ticks, numbers.
const SCALE_HEIGHT: u32 = 30;

/// From black over violet and orange to light yellow: lightness grows with the value, also in print and for the
/// colour-blind.
const COLORS: [[u8; 3]; 7] =
    [[8, 6, 30], [60, 15, 98], [125, 30, 108], [190, 55, 82], [236, 105, 37], [251, 173, 20], [252, 250, 180]];

/// Draws `values`, row by row; not a number is background. Colours run from 0 to `top`, and these numbers and `marks` between
/// stand below.
pub(super) fn heat_map(width: u32, values: &[f32], top: f64, marks: &[f64]) -> Picture {
    let height = values.len() as u32 / width.max(1);
    let mut picture = Picture::new(width, height + SCALE_HEIGHT);
    for (place, value) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
        picture.rgb[place] = color(f64::from(*value) / top);
        picture.covered[place] = true;
    }
    draw_scale(&mut picture, height, top, marks);
    picture
}

/// The colour of a share of the scale, cut off at its ends.
fn color(share: f64) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (COLORS.len() - 1) as f64;
    let first = (at as usize).min(COLORS.len() - 2);
    let part = at - first as f64;
    let mix = |channel: usize| {
        let [from, to] = [first, first + 1].map(|i| f64::from(COLORS[i][channel]));
        (from + (to - from) * part + 0.5) as u8
    };
    std::array::from_fn(mix)
}

fn draw_scale(picture: &mut Picture, row: u32, top: f64, marks: &[f64]) {
    const MARGIN: u32 = 6;
    let span = picture.width.saturating_sub(2 * MARGIN).max(1);
    for y in row..row + SCALE_HEIGHT {
        for x in 0..picture.width {
            let bar = (row + 4..row + 12).contains(&y) && (MARGIN..MARGIN + span).contains(&x);
            set(picture, x, y, if bar { color(f64::from(x - MARGIN) / f64::from(span)) } else { [32; 3] });
        }
    }
    let mut free = 0;
    for value in [0.0].iter().chain(marks).chain([&top]) {
        let at = MARGIN + ((value / top).clamp(0.0, 1.0) * f64::from(span - 1)) as u32;
        (12..15).for_each(|y| set(picture, at, row + y, [255; 3]));
        let text = label(*value);
        let length = ADVANCE * text.len() as u32;
        let start = at.saturating_sub(length / 2).min(picture.width.saturating_sub(length));
        // A number that would run into the one before it is left out; its tick stays.
        if start >= free {
            write(picture, start, row + 17, &text);
            free = start + length;
        }
    }
}

/// Three digits behind the point at most.
fn label(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_grow_lighter_from_nothing_to_the_top() {
        let light = |share: f64| color(share).iter().map(|c| u32::from(*c)).sum::<u32>();
        let steps: Vec<u32> = (0..=60).map(|i| light(f64::from(i) / 60.0)).collect();
        assert!(steps.windows(2).all(|pair| pair[0] <= pair[1]), "{steps:?}");
        assert_eq!((color(-1.0), color(7.0)), (COLORS[0], COLORS[6]));
    }

    #[test]
    fn every_value_has_its_colour_and_the_scale_its_numbers() {
        let mut values = vec![f32::NAN; 120 * 2];
        values[3] = 0.25;
        values[121] = 9.0;
        let picture = heat_map(120, &values, 0.5, &[]);
        assert_eq!((picture.width, picture.height), (120, 2 + SCALE_HEIGHT));
        assert_eq!((picture.rgb[3], picture.covered[3]), (color(0.5), true));
        assert_eq!((picture.rgb[121], picture.covered[121]), (COLORS[6], true));
        assert_eq!(picture.covered[..240].iter().filter(|c| **c).count(), 2);
        let bar = |x: usize| picture.rgb[(2 + 6) * 120 + x];
        assert_eq!((bar(6), bar(59)), (COLORS[0], color(53.0 / 108.0)));
        // "0" below the left end, "0.5" below the right one: white pixels of glyphs, and none in the middle.
        let white = |from: usize, to: usize| {
            (2 + 17..2 + 27).flat_map(|y| (from..to).map(move |x| y * 120 + x)).filter(|i| picture.rgb[*i] == [255; 3]).count()
        };
        assert_eq!(white(0, 20), 12 * 4, "twelve of fifteen");
        assert_eq!(white(90, 120), (12 + 1 + 11) * 4);
        assert_eq!(white(20, 90), 0);
    }

    #[test]
    fn numbers_that_would_overlap_are_left_out_and_narrow_pictures_do_no_harm() {
        for width in [1, 5, 13, 40, 200] {
            let picture = heat_map(width, &vec![1.0; width as usize], 1.0, &[0.01, 0.5, 0.99]);
            assert_eq!(picture.rgb.len(), width as usize * (1 + SCALE_HEIGHT as usize));
        }
        assert_eq!(["0", "0.5", "12", "0.125", "1.001"].map(|t| label(t.parse().unwrap())), ["0", "0.5", "12", "0.125", "1.001"]);
    }
}
