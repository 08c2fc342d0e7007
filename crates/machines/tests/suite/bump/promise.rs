//! Measurement of the patent's promise: interpolation of two levels with different tables is better than one level, and better than two
//! levels with identical tables.

use crate::bump::runs::{config, functional, small_demo};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_reference::{RenderOptions, RgbPicture, draw_scene, metrics};
use basrelief_signals::Scene;

/// The reference image of the last frame.
pub fn exact(scene: &Scene) -> RgbPicture {
    draw_scene(scene, scene.frames.last().unwrap(), &RenderOptions::default())
}

/// PSNR of the last picture against the reference image \[dB\].
pub fn psnr(exact: &RgbPicture, frames: &[FinishedFrame]) -> f64 {
    let FinishedFrame { width, height, rgb, covered, .. } = frames.last().unwrap().clone();
    metrics::psnr(exact, &RgbPicture::drawn([width, height], rgb, covered)).unwrap()
}

/// At 64 x 48 pixels, two levels are better than one in every demo of the machine, at every table size. Different tables are better in most
/// cases, but not in all.
// Claim: bump, promise: Two levels beat one in every demo and table size. Different tables beat identical ones in most.
#[test]
fn two_levels_beat_one_and_different_tables_usually_win() {
    let mut gains = Vec::new();
    for demo in ["golf-ball", "coin", "brick", "mixed", "sphere"] {
        let scene = small_demo(demo, 1);
        let exact = exact(&scene);
        for entries in ["16", "64", "256"] {
            let quality = |(levels, tables)| {
                let settings = [("replacement.entries", entries), ("brightness.levels", levels), ("replacement.tables", tables)];
                psnr(&exact, &functional(&scene, &config(&settings)).0)
            };
            let [one, same, two] = [("1", "different"), ("2", "identical"), ("2", "different")].map(quality);
            println!("{demo} {entries}: one level {one} dB, identical tables {same} dB, different tables {two} dB");
            assert!(two > one, "{demo} with {entries} entries: {two} against {one} dB");
            gains.push(two - same);
        }
    }
    let better = gains.iter().filter(|gain| **gain > 0.0).count();
    assert!(2 * better > gains.len() && gains.iter().sum::<f64>() > 0.0, "{gains:?}");
}
