//! Comparison of the metrics with the standard implementations of their fields, and their laws.

use basrelief_reference::metrics::{IDENTICAL_DB, difference, flip, psnr, scaled_difference, ssim};
use basrelief_reference::{QualityMetrics, RgbPicture};
use proptest::prelude::*;

type Pattern = fn(u32, u32, u32) -> u32;

fn smooth(x: u32, y: u32, c: u32) -> u32 {
    (x * 2 + y * (c + 1) + 40 * c) % 256
}

fn coarse(x: u32, y: u32, c: u32) -> u32 {
    smooth(x, y, c) / 32 * 32
}

fn check(x: u32, y: u32, c: u32) -> u32 {
    if (x / 6 + y / 6) % 2 == c % 2 { 230 } else { 25 }
}

fn shifted(x: u32, y: u32, c: u32) -> u32 {
    check(x + 2, y + 1, c)
}

fn noise(x: u32, y: u32, c: u32) -> u32 {
    (smooth(x, y, c) + (x * x * 31 + y * y * 17 + x * y * 7 + c * 91) % 64) % 256
}

fn picture(width: u32, height: u32, value: impl Fn(u32, u32, u32) -> u32) -> RgbPicture {
    let mut picture = RgbPicture::new(width, height);
    for (i, pixel) in (0..).zip(&mut picture.rgb) {
        *pixel = [0, 1, 2].map(|c| value(i % width, i / width, c) as u8);
    }
    picture.covered.fill(true);
    picture
}

/// Pictures of 96 x 64 pixels. Computed with numpy 2.4 (PSNR from the mean squared error), scikit-image 0.26
/// (`structural_similarity` of the Rec. 601 luma, `gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=255,
/// full=True`, mean of the whole map), and NVIDIA's flip-evaluator 1.7 (`evaluate(a / 255, b / 255, "LDR", inputsRGB=True,
/// applyMagma=False, computeMeanError=True, parameters={"ppd": 67})`).
const EXPECTED: [(Pattern, Pattern, [f64; 3]); 4] = [
    (smooth, coarse, [23.074782, 0.826686, 0.339232]),
    (check, shifted, [6.036421, 0.259750, 0.683534]),
    (smooth, noise, [10.139831, 0.193962, 0.689365]),
    (check, noise, [6.091366, 0.076565, 0.854717]),
];

#[test]
fn metrics_agree_with_numpy_scikit_image_and_nvidia_flip() {
    for (number, (a, b, [psnr_db, ssim, flip])) in EXPECTED.into_iter().enumerate() {
        let quality = QualityMetrics::measure(&picture(96, 64, a), &picture(96, 64, b)).expect("same size");
        assert!((quality.psnr_db - psnr_db).abs() < 2e-6, "pair {number}: {quality:?}");
        assert!((quality.ssim - ssim).abs() < 2e-6, "pair {number}: {quality:?}");
        assert!((quality.flip - flip).abs() < 2e-5, "pair {number}: {quality:?}");
    }
}

#[test]
fn background_counts_only_where_one_picture_covers_it() {
    let small = picture(20, 10, smooth);
    let mut exact = RgbPicture::new(80, 60);
    for y in 0..10 {
        for x in 0..20 {
            exact.rgb[(y + 30) * 80 + x + 40] = small.rgb[y * 20 + x];
            exact.covered[(y + 30) * 80 + x + 40] = true;
        }
    }
    let mut missing = exact.clone();
    let at = 35 * 80 + 45;
    missing.rgb[at] = [0; 3];
    missing.covered[at] = false;
    let squares: f64 = exact.rgb[at].iter().map(|&c| f64::from(c) * f64::from(c)).sum();
    let expected = 10.0 * (255.0f64 * 255.0 * 600.0 / squares).log10();
    assert!((psnr(&exact, &missing).expect("same size") - expected).abs() < 1e-6);
    assert!(flip(&exact, &missing).expect("same size") > 0.0);
    assert!(ssim(&exact, &missing).expect("same size") < 1.0);
}

#[test]
fn uncovered_pictures_are_identical() {
    for (width, height) in [(0, 0), (5, 4)] {
        let nothing = RgbPicture::new(width, height);
        let expected = QualityMetrics { psnr_db: IDENTICAL_DB, ssim: 1.0, flip: 0.0 };
        assert_eq!(QualityMetrics::measure(&nothing, &nothing), Ok(expected));
    }
}

#[test]
fn different_sizes_are_an_error() {
    let (exact, other) = (RgbPicture::new(4, 3), RgbPicture::new(3, 4));
    let error = QualityMetrics::measure(&exact, &other).expect_err("sizes differ");
    assert_eq!((error.exact, error.other), ([4, 3], [3, 4]));
    assert!(error.to_string().contains("4x3 against picture 3x4"));
    let mut short = RgbPicture::new(4, 3);
    short.covered.pop();
    assert!(difference(&exact, &short).is_err());
}

#[test]
fn black_against_white_is_worst() {
    let (black, white) = (picture(30, 30, |_, _, _| 0), picture(30, 30, |_, _, _| 255));
    assert_eq!(psnr(&black, &white), Ok(0.0));
    assert!(ssim(&black, &white).expect("same size") < 1e-3);
    assert!(flip(&black, &white).expect("same size") > 0.9);
}

#[test]
fn largest_difference_is_scaled_to_255() {
    let (result, largest) = scaled_difference(&picture(3, 1, |_, _, _| 100), &picture(3, 1, |x, _, _| 100 - 20 * x)).unwrap();
    assert_eq!((largest, result.rgb), (40, vec![[0; 3], [128; 3], [255; 3]]));
    let same = picture(2, 1, |_, _, _| 7);
    assert_eq!(scaled_difference(&same, &same).map(|(picture, largest)| (picture.rgb, largest)), Ok((vec![[0; 3]; 2], 0)));
}

#[test]
fn difference_is_eightfold_and_saturated() {
    let result = difference(&picture(2, 1, |_, _, _| 100), &picture(2, 1, |x, _, c| 90 + 9 * c + 100 * x));
    let result = result.expect("same size");
    assert_eq!(result.rgb, [[80, 8, 64], [255, 255, 255]]);
    assert_eq!(result.covered, [true, true]);
}

fn any_picture() -> impl Strategy<Value = RgbPicture> {
    prop::collection::vec((prop::array::uniform3(any::<u8>()), any::<bool>()), 12 * 9).prop_map(|pixels| {
        let (rgb, covered) = pixels.into_iter().unzip();
        RgbPicture::drawn([12, 9], rgb, covered)
    })
}

proptest! {
    #[test]
    fn metrics_are_symmetric_and_bounded(a in any_picture(), b in any_picture()) {
        let there = QualityMetrics::measure(&a, &b).expect("same size");
        let back = QualityMetrics::measure(&b, &a).expect("same size");
        prop_assert_eq!(there.psnr_db, back.psnr_db);
        prop_assert!((there.ssim - back.ssim).abs() < 1e-6 && (there.flip - back.flip).abs() < 2e-6);
        prop_assert!((0.0..=IDENTICAL_DB).contains(&there.psnr_db));
        prop_assert!((-1.0..=1.0).contains(&there.ssim));
        prop_assert!((0.0..=1.0).contains(&there.flip));
        prop_assert_eq!(difference(&a, &b), difference(&b, &a));
    }

    #[test]
    fn identical_pictures_have_no_difference(a in any_picture()) {
        let expected = QualityMetrics { psnr_db: IDENTICAL_DB, ssim: 1.0, flip: 0.0 };
        prop_assert_eq!(QualityMetrics::measure(&a, &a), Ok(expected));
        prop_assert!(difference(&a, &a).expect("same size").rgb.iter().all(|p| *p == [0; 3]));
    }
}
