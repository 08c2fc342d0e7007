//! LDR-FLIP: the difference that a viewer sees between two alternating pictures.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Moeller, M. Oskarsson, K. Astroem and M. D. Fairchild: FLIP: A Difference Evaluator for
//! Alternating Images. Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. Section numbers below are those of the paper. The
//! spatial filters are sums of Gaussians and therefore separable: two passes of 21 taps instead of 441.

use super::covered::{SizeMismatch, covered_in, mean, reach, same_size, strip_pixels};
use super::filter::{FilterKernel, FilterWindow, FilteredRows, PlaneSize, RimMode, RowStrip, due};
use crate::RgbPicture;
use std::f64::consts::PI;

/// Pixels per degree of visual angle: 0.7 m from a 0.7 m wide monitor of 3840 pixels.
const PIXELS_PER_DEGREE: f64 = 67.0;
/// Exponent of the colour difference (4.1.3).
const COLOR_EXPONENT: f64 = 0.7;
/// Share of the largest colour difference that is mapped to [`TURN_VALUE`] (4.1.3).
const TURN_SHARE: f64 = 0.4;
const TURN_VALUE: f64 = 0.95;
/// Width of the feature detectors \[degrees\] (4.2.1).
const FEATURE_WIDTH: f64 = 0.082;
/// Reach of a filter \[pixels\]: three standard deviations of the widest Gaussian, rounded up.
const COLOR_RADIUS: usize = 10;
const FEATURE_RADIUS: usize = 9;

/// Illuminant D65.
const WHITE: [f64; 3] = [0.950_428_545_377_180_2, 1.0, 1.088_900_370_798_128];
/// Linear sRGB to XYZ, row by row.
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
/// XYZ to linear sRGB, row by row.
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_232_976_358, -1.537_398_969_488_785, -0.498_615_881_996_363],
    [-0.969_224_252_202_516, 1.875_929_983_695_176, 0.041_554_226_340_085],
    [0.055_639_419_851_975, -0.204_011_206_123_91, 1.057_148_977_187_533],
];

/// Returns the mean FLIP error of the pixels covered in either picture, 0..=1, or 0 if no pixel is covered.
///
/// # Errors
/// Returns an error if the pictures differ in size.
pub fn flip(exact: &RgbPicture, other: &RgbPicture) -> Result<f64, SizeMismatch> {
    same_size(exact, other)?;
    Ok(reach(exact, other, COLOR_RADIUS).map_or(0.0, |window| flip_by(exact, other, &window, strip_pixels(&window))))
}

/// Computes the error in strips of about this many pixels.
fn flip_by(exact: &RgbPicture, other: &RgbPicture, window: &FilterWindow, strip_pixels: usize) -> f64 {
    let planes = FlipFilters::new();
    let largest = largest_color_difference();
    let picture_width = exact.width as usize;
    mean(&RowStrip::all(strip_pixels, window, COLOR_RADIUS), 0.0, |strip| {
        let part = FilterWindow { columns: window.columns.clone(), rows: strip.reached.clone() };
        let mut eyes = [exact, other].map(|picture| VisionRow::new(&planes, picture, &part));
        let mut errors = Vec::with_capacity(strip.rows.len() * part.width());
        for row in strip.rows.clone() {
            eyes.iter_mut().for_each(|eye| eye.look_at(row - part.rows.start));
            let [left, right] = &eyes;
            errors.extend(covered_in(exact, other, row..row + 1).map(|i| {
                let at = i % picture_width - part.columns.start;
                let color = redistributed(power(distance(left.lab(at), right.lab(at)), COLOR_EXPONENT), largest);
                power(color, 1.0 - feature_difference(left, right, at))
            }));
        }
        errors
    })
}

/// Vision model of a row: filtered colour, and strength of edges and points in its luminance. It moves down the picture.
struct VisionRow<'a> {
    planes: &'a FlipFilters,
    picture: &'a RgbPicture,
    window: &'a FilterWindow,
    /// Rows received so far.
    taken: usize,
    /// Luminance, red-green and blue-yellow (the latter twice).
    opponents: [FilteredRows<'a>; 4],
    /// Lightness: smooth, its slope, its bend.
    features: [FilteredRows<'a>; 3],
    /// Filtered luminance and the two chrominances (YCxCz).
    color: [Vec<f64>; 3],
    edges: [Vec<f64>; 2],
    points: [Vec<f64>; 2],
    /// The second part of blue-yellow.
    rest: Vec<f64>,
}

impl<'a> VisionRow<'a> {
    fn new(planes: &'a FlipFilters, picture: &'a RgbPicture, window: &'a FilterWindow) -> Self {
        let size = PlaneSize { width: window.width(), height: window.rows.len() };
        // The features' kernels have a smaller radius, but their rows are received with the others.
        let rows = |across: &'a FilterKernel| FilteredRows::new(across, COLOR_RADIUS, size, RimMode::Extended);
        let [(_, first), (_, second)] = &planes.blue_yellow;
        let row = || vec![0.0; window.width()];
        Self {
            planes,
            picture,
            window,
            taken: 0,
            opponents: [&planes.luminance, &planes.red_green, first, second].map(rows),
            features: [&planes.smooth, &planes.slope, &planes.bend].map(rows),
            color: [(); 3].map(|()| row()),
            edges: [(); 2].map(|()| row()),
            points: [(); 2].map(|()| row()),
            rest: row(),
        }
    }

    /// Moves to a row of the window below the last one.
    fn look_at(&mut self, row: usize) {
        let height = self.window.rows.len();
        for due in due(&mut self.taken, row + COLOR_RADIUS, height) {
            self.take(due);
        }
        let FlipFilters { luminance, red_green, blue_yellow: [(a, first), (b, second)], smooth, slope, bend, .. } = self.planes;
        let [y, cx, cz, rest] = &self.opponents;
        y.down(row, luminance, &mut self.color[0]);
        cx.down(row, red_green, &mut self.color[1]);
        cz.down(row, first, &mut self.color[2]);
        rest.down(row, second, &mut self.rest);
        self.color[2].iter_mut().zip(&self.rest).for_each(|(cz, rest)| *cz = *cz * a + rest * b);
        let [smoothed, sloped, bent] = &self.features;
        sloped.down(row, smooth, &mut self.edges[0]);
        smoothed.down(row, slope, &mut self.edges[1]);
        bent.down(row, smooth, &mut self.points[0]);
        smoothed.down(row, bend, &mut self.points[1]);
    }

    /// Receives a row of the window, in YCxCz, a linear opponent space (4.1.1).
    fn take(&mut self, row: usize) {
        let Self { planes, picture, window, .. } = self;
        let start = (window.rows.start + row) * picture.width as usize;
        let pixels = &picture.rgb[start + window.columns.start..start + window.columns.end];
        let [mut y, mut cx, mut cz] = [(); 3].map(|()| Vec::with_capacity(pixels.len()));
        for rgb in pixels {
            let [x, luminance, z] = relative_xyz(rgb.map(|c| planes.linear[usize::from(c)]));
            y.push(116.0 * luminance - 16.0);
            cx.push(500.0 * (x - luminance));
            cz.push(200.0 * (luminance - z));
        }
        for (rows, plane) in self.opponents.iter_mut().zip([&y, &cx, &cz, &cz]) {
            rows.take(row, plane);
        }
        y.iter_mut().for_each(|y| *y = (*y + 16.0) / 116.0);
        self.features.iter_mut().for_each(|rows| rows.take(row, &y));
    }

    /// Returns the filtered colour, saturated to the monitor's range, in Hunt-adjusted CIELAB.
    fn lab(&self, at: usize) -> [f64; 3] {
        let [y, cx, cz] = [0, 1, 2].map(|k| self.color[k][at]);
        let relative_y = (y + 16.0) / 116.0;
        let xyz = [(relative_y + cx / 500.0) * WHITE[0], relative_y * WHITE[1], (relative_y - cz / 200.0) * WHITE[2]];
        hunt_adjusted_lab(times(&FROM_XYZ, xyz).map(|c| c.clamp(0.0, 1.0)))
    }
}

/// Filters, built once per comparison.
struct FlipFilters {
    linear: Vec<f64>,
    /// Gaussians of the contrast sensitivity of luminance, red-green, and (two, with their weights) blue-yellow.
    luminance: FilterKernel,
    red_green: FilterKernel,
    blue_yellow: [(f64, FilterKernel); 2],
    smooth: FilterKernel,
    slope: FilterKernel,
    bend: FilterKernel,
}

impl FlipFilters {
    fn new() -> Self {
        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let gauss = |x: f64| libm::exp(-x * x / (2.0 * deviation * deviation));
        let feature = |f: &dyn Fn(f64) -> f64| FilterKernel::new(FEATURE_RADIUS, f).normalised();
        Self {
            linear: (0..=255u8).map(|value| linear(f64::from(value) / 255.0)).collect(),
            luminance: sensitivity(0.0047).normalised(),
            red_green: sensitivity(0.0053).normalised(),
            blue_yellow: blue_yellow(),
            smooth: feature(&gauss),
            slope: feature(&|x| -x * gauss(x)),
            bend: feature(&|x| (x * x / (deviation * deviation) - 1.0) * gauss(x)),
        }
    }
}

/// Returns one Gaussian of a contrast sensitivity function, in pixels: exp(-pi^2 d^2 / b) at d degrees (4.1.1).
fn sensitivity(b: f64) -> FilterKernel {
    FilterKernel::new(COLOR_RADIUS, |x| libm::exp(-(PI * x / PIXELS_PER_DEGREE) * (PI * x / PIXELS_PER_DEGREE) / b))
}

/// Returns the parts of blue-yellow: the sum of two Gaussians a * sqrt(pi / b) * exp(..), which sums to 1. Each is normalised by
/// itself and keeps its share.
fn blue_yellow() -> [(f64, FilterKernel); 2] {
    let parts = [(34.1, 0.04), (13.5, 0.025)].map(|(a, b)| {
        let kernel = sensitivity(b);
        let sum: f64 = kernel.0.iter().sum();
        (a * (PI / b).sqrt() * sum * sum, kernel.normalised())
    });
    let total = parts[0].0 + parts[1].0;
    parts.map(|(share, kernel)| (share / total, kernel))
}

/// Returns the difference of edges or of points, the larger of the two, 0..=1 (4.2).
fn feature_difference(left: &VisionRow<'_>, right: &VisionRow<'_>, at: usize) -> f64 {
    let strength = |pair: &[Vec<f64>; 2]| (pair[0][at] * pair[0][at] + pair[1][at] * pair[1][at]).sqrt();
    let edges = (strength(&left.edges) - strength(&right.edges)).abs();
    let points = (strength(&left.points) - strength(&right.points)).abs();
    (edges.max(points) * std::f64::consts::FRAC_1_SQRT_2).sqrt().min(1.0)
}

/// Returns the HyAB distance (4.1.2).
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [l, u, v] = [0, 1, 2].map(|k| a[k] - b[k]);
    l.abs() + (u * u + v * v).sqrt()
}

/// Returns the distance between green and blue, the largest between colours of a monitor, raised to [`COLOR_EXPONENT`].
fn largest_color_difference() -> f64 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(hunt_adjusted_lab);
    power(distance(green, blue), COLOR_EXPONENT)
}

/// Raises a base >= 0 to a power. 0 stays 0. It is off by some units in the last place, at half the time of `libm::pow`.
fn power(base: f64, exponent: f64) -> f64 {
    if base > 0.0 { libm::exp(exponent * libm::log(base)) } else { 0.0 }
}

/// Compresses large differences into [`TURN_VALUE`]..=1 (4.1.3).
fn redistributed(difference: f64, largest: f64) -> f64 {
    let turn = TURN_SHARE * largest;
    if difference < turn {
        TURN_VALUE / turn * difference
    } else {
        TURN_VALUE + (difference - turn) / (largest - turn) * (1.0 - TURN_VALUE)
    }
}

/// Converts to CIELAB with chroma scaled by lightness, because colours look less colourful in the dark (4.1.2).
fn hunt_adjusted_lab(linear_rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(linear_rgb).map(|t| {
        const DELTA: f64 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA { libm::cbrt(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// Returns XYZ divided by that of white.
fn relative_xyz(linear_rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = times(&TO_XYZ, linear_rgb);
    [x / WHITE[0], y / WHITE[1], z / WHITE[2]]
}

fn times(matrix: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

/// Decodes sRGB, 0..=1.
fn linear(value: f64) -> f64 {
    if value > 0.04045 { libm::pow((value + 0.055) / 1.055, 2.4) } else { value / 12.92 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::tests::noise;

    #[test]
    fn strips_match_whole_picture() {
        let (exact, other) = (noise(31, 57, 1), noise(31, 57, 2));
        let window = reach(&exact, &other, COLOR_RADIUS).unwrap();
        let whole = flip_by(&exact, &other, &window, usize::MAX);
        for pixels in [1, 31 * 7, 31 * 40] {
            assert_eq!(flip_by(&exact, &other, &window, pixels).to_bits(), whole.to_bits(), "{pixels}");
        }
    }
}
