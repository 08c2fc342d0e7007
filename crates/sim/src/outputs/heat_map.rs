//! Heat maps with a scale.

use super::lettering::{ADVANCE, LINE, lines, set, write};
use basrelief_reference::RgbPicture;

/// Height of a scale without its title \[pixels\]: bar, ticks and numbers.
pub(super) const BAR_HEIGHT: u32 = 30;
/// Distance from the sides of the picture to the bar \[pixels\].
const MARGIN: u32 = 6;
/// Background of the text.
const GROUND: [u8; 3] = [32; 3];

/// Colours of a scale, from 0 to the top.
pub(super) type ColourRamp = [[u8; 3]; 7];

/// Colours from black over violet and orange to light yellow. The lightness grows with the value, so that the scale is readable in print
/// and for colour-blind readers.
pub(super) const HEAT: ColourRamp =
    [[8, 6, 30], [60, 15, 98], [125, 30, 108], [190, 55, 82], [236, 105, 37], [251, 173, 20], [252, 250, 180]];

/// Scale below a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColourScale<'a> {
    /// Quantity and unit of measure.
    pub(super) title: &'a str,
    /// Value of the last colour. The first colour is 0.
    pub(super) top: f64,
    /// True if the last colour also stands for larger values.
    pub(super) and_more: bool,
    /// Labelled values between 0 and the top.
    pub(super) marks: &'a [f64],
    pub(super) colors: &'a ColourRamp,
}

impl<'a> ColourScale<'a> {
    /// Creates a scale from 0 to `top`.
    pub(super) fn new(title: &'a str, top: f64) -> Self {
        Self { title, top, and_more: false, marks: &[], colors: &HEAT }
    }

    /// Returns the height below a picture of this width \[pixels\].
    fn height(&self, width: u32) -> u32 {
        BAR_HEIGHT + LINE * lines(self.title, width - width.min(2 * MARGIN)).len() as u32
    }
}

/// Draws values, row by row, and a scale below. NaN is background.
pub(super) fn heat_map(width: u32, values: &[f32], scale: &ColourScale<'_>) -> RgbPicture {
    heat_maps(width, values, |_| 0, &[*scale])
}

/// Draws values, row by row, and several scales below. `which` returns the scale of a pixel by its index. NaN is background.
pub(super) fn heat_maps(width: u32, values: &[f32], which: impl Fn(usize) -> usize, scales: &[ColourScale<'_>]) -> RgbPicture {
    let height = values.len() as u32 / width.max(1);
    let mut picture = RgbPicture::new(width, height + scales.iter().map(|scale| scale.height(width)).sum::<u32>());
    for (place, value) in values.iter().enumerate().filter(|(_, value)| !value.is_nan()) {
        let scale = &scales[which(place)];
        picture.rgb[place] = color(scale.colors, f64::from(*value) / scale.top);
        picture.covered[place] = true;
    }
    let mut row = height;
    for scale in scales {
        draw_scale(&mut picture, row, scale);
        row += scale.height(width);
    }
    picture
}

/// Returns the colour at a fraction of the scale, clamped to 0..=1.
fn color(colors: &ColourRamp, share: f64) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (colors.len() - 1) as f64;
    let first = (at as usize).min(colors.len() - 2);
    let part = at - first as f64;
    let mix = |channel: usize| {
        let [from, to] = [first, first + 1].map(|i| f64::from(colors[i][channel]));
        (from + (to - from) * part + 0.5) as u8
    };
    std::array::from_fn(mix)
}

fn draw_scale(picture: &mut RgbPicture, row: u32, scale: &ColourScale<'_>) {
    let span = picture.width.saturating_sub(2 * MARGIN).max(1);
    for y in row..row + scale.height(picture.width) {
        (0..picture.width).for_each(|x| set(picture, x, y, GROUND));
    }
    let title = lines(scale.title, span);
    let row = row + LINE * title.len() as u32;
    for (y, x) in (row + 4..row + 12).flat_map(|y| (0..span).map(move |x| (y, x))) {
        set(picture, MARGIN + x, y, color(scale.colors, f64::from(x) / f64::from(span)));
    }
    for (line, text) in (1..).zip(title.iter().rev()) {
        write(picture, MARGIN, row + 4 - line * LINE, text);
    }
    let mut free = 0;
    for value in [0.0].iter().chain(scale.marks).chain([&scale.top]) {
        let at = MARGIN + ((value / scale.top).clamp(0.0, 1.0) * f64::from(span - 1)) as u32;
        (12..15).for_each(|y| set(picture, at, row + y, [255; 3]));
        let more = if scale.and_more && *value == scale.top { "+" } else { "" };
        let text = label(*value) + more;
        let length = ADVANCE * text.len() as u32;
        let start = at.saturating_sub(length / 2).min(picture.width.saturating_sub(length));
        // A number that would overlap the previous one is omitted; its tick remains.
        if start >= free {
            write(picture, start, row + 17, &text);
            free = start + length;
        }
    }
}

/// Formats a number with at most three decimals.
fn label(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bare(top: f64) -> ColourScale<'static> {
        ColourScale::new("", top)
    }

    #[test]
    fn lightness_grows_with_value() {
        let light = |share: f64| color(&HEAT, share).iter().map(|c| u32::from(*c)).sum::<u32>();
        let steps: Vec<u32> = (0..=60).map(|i| light(f64::from(i) / 60.0)).collect();
        assert!(steps.windows(2).all(|pair| pair[0] <= pair[1]), "{steps:?}");
        assert_eq!((color(&HEAT, -1.0), color(&HEAT, 7.0)), (HEAT[0], HEAT[6]));
    }

    #[test]
    fn values_have_colours_and_scale_has_numbers() {
        let mut values = vec![f32::NAN; 120 * 2];
        values[3] = 0.25;
        values[121] = 9.0;
        let picture = heat_map(120, &values, &bare(0.5));
        assert_eq!((picture.width, picture.height), (120, 2 + BAR_HEIGHT));
        assert_eq!((picture.rgb[3], picture.covered[3]), (color(&HEAT, 0.5), true));
        assert_eq!((picture.rgb[121], picture.covered[121]), (HEAT[6], true));
        assert_eq!(picture.covered[..240].iter().filter(|c| **c).count(), 2);
        let bar = |x: usize| picture.rgb[(2 + 6) * 120 + x];
        assert_eq!((bar(6), bar(59)), (HEAT[0], color(&HEAT, 53.0 / 108.0)));
        // "0" below the left end, "0.5" below the right one: white pixels of glyphs, and none in the middle.
        let white = |from: usize, to: usize| {
            (2 + 17..2 + 27).flat_map(|y| (from..to).map(move |x| y * 120 + x)).filter(|i| picture.rgb[*i] == [255; 3]).count()
        };
        assert_eq!(white(0, 20), 12 * 4, "twelve of fifteen");
        assert_eq!(white(90, 120), (12 + 1 + 11) * 4);
        assert_eq!(white(20, 90), 0);
    }

    #[test]
    fn title_wraps_above_its_bar() {
        let titled = |width: u32, title| heat_map(width, &vec![1.0; width as usize], &ColourScale { title, ..bare(1.0) });
        assert_eq!(titled(120, "CYCLES").height, 1 + BAR_HEIGHT + LINE);
        assert_eq!(titled(120, "CYCLES OF ALL UNITS").height, 1 + BAR_HEIGHT + 2 * LINE);
        let row_of_bar = |picture: &RgbPicture| (1..picture.height).find(|y| picture.rgb[(y * 120 + 6) as usize] == HEAT[0]);
        assert_eq!(row_of_bar(&titled(120, "CYCLES")), Some(1 + LINE + 4));
    }

    #[test]
    fn two_scales_are_stacked_and_colour_their_own_values() {
        let other = ColourScale { colors: &[[1, 2, 3]; 7], ..bare(2.0) };
        let picture = heat_maps(40, &[1.0; 40], |place| place % 2, &[bare(1.0), other]);
        assert_eq!((picture.rgb[0], picture.rgb[1]), (HEAT[6], [1, 2, 3]));
        assert_eq!(picture.height, 1 + 2 * BAR_HEIGHT);
    }

    #[test]
    fn overlapping_numbers_are_omitted() {
        for width in [1, 5, 13, 40, 200] {
            let scale = ColourScale { title: "CYCLES", marks: &[0.01, 0.5, 0.99], ..bare(1.0) };
            let picture = heat_map(width, &vec![1.0; width as usize], &scale);
            assert_eq!(picture.rgb.len(), width as usize * picture.height as usize);
        }
        assert_eq!(["0", "0.5", "12", "0.125", "1.001"].map(|t| label(t.parse().unwrap())), ["0", "0.5", "12", "0.125", "1.001"]);
    }
}
