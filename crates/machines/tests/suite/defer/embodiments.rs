//! Embodiments 1 to 20 of the patent, by name: the device (1-10) and the method (11-20).

use crate::defer::recipe::{FAST, SMALL, rectangle, texture, textured, views};
use crate::defer::runs::{Seen, timed};
use basrelief_deferred_renderer::TileOrigin;
use basrelief_deferred_renderer::acquisition::TileState;
use basrelief_signals::{Control, Material, Polygon, WrapMode};
use std::sync::Arc;

fn seen(list: &[Control], more: &[(&str, &str)]) -> Seen {
    timed(list, &[FAST, SMALL, more].concat()).seen
}

/// The same polygons with other pattern data: texels inverted.
fn repainted(list: &[Control]) -> Vec<Control> {
    let of = |control: &Control| {
        let Control::Polygon(polygon) = control else { return control.clone() };
        let mut polygon = Polygon::clone(polygon);
        let mut material = Material::clone(&polygon.material);
        if let Some(texture) = &mut material.color_texture {
            let inverted = Arc::make_mut(texture);
            inverted.levels.iter_mut().flat_map(|l| &mut l.texels).for_each(|t| *t = t.map(|c| 255 - c));
        }
        polygon.material = Arc::new(material);
        Control::Polygon(Arc::new(polygon))
    };
    list.iter().map(of).collect()
}

// Claim: defer, embodiments 1, 11: A view is rasterized without pattern data, then tiles are fetched, then the image is finished.
#[test]
fn embodiments_1_and_11_rasterize_then_fetch_then_finish() {
    let ran = timed(&views(&[0.0]), &[FAST, SMALL].concat());
    let (seen, report) = (&ran.seen, &ran.report);
    // Rasterization and fetches do not depend on pattern data; finished pictures do.
    let other = timed(&repainted(&views(&[0.0])), &[FAST, SMALL].concat()).seen;
    assert_eq!((&seen.filled, seen.acquired(0)), (&other.filled, other.acquired(0)));
    assert_ne!(seen.finished[0].rgb, other.finished[0].rgb);
    assert_eq!(seen.filled.len(), 1);
    assert!(
        seen.filled[0].cells.iter().any(|c| c.page().is_some())
            && seen.filled[0].cells.iter().any(|c| c.is_drawn() && c.page().is_none())
    );
    assert!(seen.count("path_tile_bytes") < seen.count("conventional_tile_bytes"));
    let names: Vec<&str> = report.units.iter().map(|u| u.name.as_str()).collect();
    for unit in ["server", "path", "reference-buffer", "tile-lists", "final-rasterization", "pixel-buffer"] {
        assert!(names.contains(&unit), "{unit}");
    }
}

// Claim: defer, embodiments 2, 12: Textures are pyramids of tiles.
#[test]
fn embodiments_2_and_12_textures_are_pyramids_of_tiles() {
    let seen = seen(&views(&[0.0]), &[]);
    for (page, list) in &seen.lists {
        assert!(page.layers.windows(2).all(|l| (0..2).all(|i| l[0].size[i] == l[1].size[i].div_ceil(2))));
        assert_eq!(page.layers[0].pitch * page.layers[0].rows, 1, "layer 0 is one tile");
        assert_eq!(list.states().len() as u32, page.tiles());
    }
}

// Claim: defer, embodiments 3, 13: Brightness coefficients are in the cell.
#[test]
fn embodiments_3_and_13_brightness_in_cell_multiplies_texel() {
    let base = texture(1, [8, 8], [WrapMode::Clamp; 2]);
    let half = Arc::new(Material { base_color: [0.5, 1.0, 0.0, 1.0], ..Material::clone(&textured(&base)) });
    let picture = |material: &Arc<Material>| {
        let list = [crate::defer::recipe::frame(0), rectangle([0.0, 0.0, 40.0, 30.0], 0.5, material), Control::FrameEnd];
        seen(&list, &[])
    };
    let (full, half) = (picture(&textured(&base)), picture(&half));
    assert_eq!(half.filled[0].cells[0].coefficients(), [128, 255, 0]);
    for (full, half) in full.finished[0].rgb.iter().zip(&half.finished[0].rgb) {
        assert!((f32::from(full[0]) * 128.0 / 255.0 - f32::from(half[0])).abs() <= 1.0);
        assert_eq!((half[1], half[2]), (full[1], 0));
    }
}

// Claim: defer, embodiments 4, 5, 14, 15: A tile list holds L, and L becomes E on acquisition.
#[test]
fn embodiments_4_5_14_and_15_tile_states_go_from_l_to_e() {
    let left_early = seen(&views(&[0.0]), &[("defer.mode", "progressive"), ("defer.pictures_per_view", "1")]);
    let states = |seen: &Seen, state: TileState| seen.lists.iter().flat_map(|(_, l)| l.states()).filter(|s| **s == state).count();
    assert!(states(&left_early, TileState::Load) > 0, "marked when the user moved on");
    let whole = seen(&views(&[0.0]), &[]);
    assert_eq!(states(&whole, TileState::Load), 0);
    assert_eq!(states(&whole, TileState::Exists), whole.acquired(0).len());
    assert!(states(&whole, TileState::NotPresent) > 0);
}

// Claim: defer, embodiments 6, 9, 16, 19: A tile is synthesized from the layer below, or loaded.
#[test]
fn embodiments_6_9_16_and_19_tile_is_synthesized_or_loaded() {
    let seen = seen(&views(&[0.0]), &[]);
    let (loaded, synthesized) = (seen.tiles(0, Some(TileOrigin::Loaded)), seen.tiles(0, Some(TileOrigin::Synthesized)));
    assert!(!loaded.is_empty() && !synthesized.is_empty());
    let all = seen.acquired(0);
    for (page, _) in &seen.lists {
        let sources_exist = |tile: u32| {
            let sources = page.sources(tile);
            !sources.is_empty() && sources.iter().all(|s| all.contains(&(page.texture, *s)))
        };
        for tile in (0..page.tiles()).filter(|t| all.contains(&(page.texture, *t))) {
            assert_eq!(synthesized.contains(&(page.texture, tile)), sources_exist(tile), "{}, tile {tile}", page.name);
        }
    }
}

// Claim: defer, embodiments 7, 8, 17, 18: Progressive images improve to the best.
#[test]
fn embodiments_7_8_17_and_18_pictures_improve_to_the_best() {
    let progressive = seen(&views(&[0.0]), &[("defer.mode", "progressive")]);
    let best = seen(&views(&[0.0]), &[]);
    assert!(progressive.rounds.len() >= 3);
    let error = |rgb: &[[u8; 3]]| -> u64 {
        let pairs = rgb.as_flattened().iter().zip(best.finished[0].rgb.as_flattened());
        pairs.map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2)).sum()
    };
    let errors: Vec<u64> = progressive.rounds.iter().map(|r| error(&r.rgb)).collect();
    assert!(errors[0] > 0 && errors.last() < errors.first(), "{errors:?}");
    assert_eq!(error(&progressive.finished[0].rgb), 0);
}

// Claim: defer, embodiments 10, 20: An integer D takes one interpolation; other values take two and one between layers.
#[test]
fn embodiments_10_and_20_interpolate_once_or_twice_by_depth() {
    let base = textured(&texture(1, [32, 32], [WrapMode::Clamp; 2]));
    let interpolations = |side: f32| {
        let list = [crate::defer::recipe::frame(0), rectangle([0.0, 0.0, side, side], 0.5, &base), Control::FrameEnd];
        let seen = seen(&list, &[]);
        (seen.count("pixels_textured"), seen.count("interpolations_within_layers"), seen.count("interpolations_between_layers"))
    };
    assert_eq!(interpolations(16.0), (256, 256, 0), "two texels per pixel: D = Dmax - 1");
    assert_eq!(interpolations(12.0), (144, 288, 144));
}
