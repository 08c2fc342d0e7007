//! Cap on Dmax (133) \[0033\]: textures with more texels than needed are stored at a lower resolution.

use crate::defer::recipe::{FAST, SMALL, floor, frame, object, rectangle, texture, textured};
use crate::defer::runs::{Ran, timed};
use basrelief_signals::{Control, Image, Texture, WrapMode};
use std::sync::Arc;

/// A texture of half the width and height: means of four texels, rounded half up.
fn halved(texture: &Arc<Texture>) -> Arc<Texture> {
    let finest = &texture.levels[0];
    let (width, height) = (finest.width / 2, finest.height / 2);
    let at = |x: u32, y: u32| finest.texels[(y * finest.width + x) as usize];
    let mean = |x: u32, y: u32| {
        let four = [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
        std::array::from_fn(|c| ((four.iter().map(|t| u32::from(t[c])).sum::<u32>() + 2) / 4) as u8)
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    Arc::new(Texture { levels: vec![Image { width, height, texels }], ..Texture::clone(texture) })
}

/// A floor to the horizon, and a picture so near that its texels are magnified.
fn list(ground: &Arc<Texture>, near: &Arc<Texture>) -> Vec<Control> {
    let polygons = [floor(&textured(ground), 3.0), rectangle([1.0, 0.0, 90.0, 70.0], 0.05, &textured(near))];
    [vec![frame(0), object(0)], polygons.to_vec(), vec![Control::FrameEnd]].concat()
}

fn run(list: &[Control], mode: &str, cap: &str) -> Ran {
    timed(list, &[FAST, SMALL, &[("defer.mode", mode), ("defer.dmax", cap)]].concat())
}

// Claim: as dmax_cap_0033_drops_only_the_finest_layers.
#[test]
fn depth_of_layers_0033_cap_on_dmax_equals_halved_textures() {
    // Tiles of 8 x 8: 128 x 128 texels have Dmax = 4, 64 x 32 have 3.
    let (ground, near) = (texture(0, [128, 128], [WrapMode::Repeat; 2]), texture(1, [64, 32], [WrapMode::Clamp; 2]));
    let halves = list(&halved(&halved(&ground)), &halved(&near));
    let whole = list(&ground, &near);
    for mode in ["best", "progressive", "conventional"] {
        let (capped, expected) = (run(&whole, mode, "2"), run(&halves, mode, "31"));
        assert_eq!(capped.seen.finished, expected.seen.finished, "{mode}: the picture");
        assert_eq!(capped.seen.rounds, expected.seen.rounds, "{mode}: those before it");
        for count in ["path_tile_bytes", "conventional_tile_bytes", "tiles_loaded", "tiles_synthesized"] {
            assert_eq!(capped.seen.count(count), expected.seen.count(count), "{mode}: {count}");
        }
        assert!(capped.seen.lists.iter().all(|(page, _)| page.dmax() == 2));
        let all = run(&whole, mode, "31");
        assert!(all.seen.count("path_tile_bytes") > capped.seen.count("path_tile_bytes"), "{mode}: the cap spares bytes");
        assert_ne!(all.seen.finished, capped.seen.finished, "{mode}: and costs sharpness");
    }
}

// Claim: as dmax_cap_0033_drops_only_the_finest_layers.
#[test]
fn depth_of_layers_0033_cap_of_dmax_or_more_changes_nothing() {
    let list = list(&texture(0, [128, 128], [WrapMode::Repeat; 2]), &texture(1, [37, 61], [WrapMode::Clamp; 2]));
    let (all, capped) = (run(&list, "best", "31"), run(&list, "best", "4"));
    // The hardware differs, because the table of layers ends at the cap.
    let figures = |ran: &Ran| ran.seen.facts.figures().cloned().collect::<Vec<_>>();
    assert_eq!((&all.report, &all.seen.finished, figures(&all)), (&capped.report, &capped.seen.finished, figures(&capped)));
}
