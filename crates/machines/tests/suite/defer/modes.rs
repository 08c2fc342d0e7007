//! The modes: best resolution, progressive and conventional. They draw the same picture. Several views in sequence.

use crate::defer::recipe::{FAST, SMALL, display_lists, floor, frame, object, texture, views};
use crate::defer::runs::{Ran, Seen, Tile, config, timed};
use basrelief_deferred_renderer::cell::split_depth;
use basrelief_deferred_renderer::{ReferenceCell, TexturePage, TileOrigin};
use basrelief_machines::defer::warnings;
use basrelief_signals::{Control, Frame, Material, WrapMode};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

const MODES: [&str; 3] = ["best", "progressive", "conventional"];

fn mode<'a>(mode: &'a str, more: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a str)> {
    [FAST, SMALL, &[("defer.mode", mode)], more].concat()
}

fn modes(list: &[Control], more: &[(&str, &str)]) -> [Ran; 3] {
    MODES.map(|m| timed(list, &mode(m, more)))
}

/// Last pictures, without the number of their round.
fn pictures(seen: &Seen) -> Vec<&[[u8; 3]]> {
    seen.finished.iter().map(|f| f.rgb.as_slice()).collect()
}

/// Returns the tiles that the pixels of a reference buffer read, from its cells.
fn wanted(seen: &Seen, frame: usize) -> BTreeSet<Tile> {
    let filled = &seen.filled[frame];
    let of_cell = |cell: &ReferenceCell| -> Vec<Tile> {
        let Some(page) = cell.page().map(|p| &filled.pages[usize::from(p)]) else { return vec![] };
        layers(page, cell.depth).into_iter().flat_map(|layer| read(page, layer, cell)).collect()
    };
    filled.cells.iter().flat_map(of_cell).collect()
}

fn layers(page: &TexturePage, depth: f32) -> Vec<u8> {
    let (coarse, fraction) = split_depth(depth, page.dmax());
    if fraction > 0.0 { vec![coarse, coarse + 1] } else { vec![coarse] }
}

/// Returns the tiles of all texels with a weight above 0, texel by texel.
fn read(page: &TexturePage, layer: u8, cell: &ReferenceCell) -> Vec<Tile> {
    let [x, y] = page.taps(layer, page.placed(cell.coordinates, cell.wrap));
    let texels = [[x.first, y.first], [x.second, y.first], [x.first, y.second], [x.second, y.second]];
    texels.map(|texel| (page.texture, page.tile_of(layer, texel))).to_vec()
}

// Claim: defer, modes: All three modes end with the same image, with any lossless encoding and order. `best` loads least.
#[test]
fn all_modes_orders_and_lossless_encodings_end_alike() {
    let [best, progressive, conventional] = modes(&views(&[0.0, 5.0]), &[]);
    assert_eq!(pictures(&best.seen), pictures(&progressive.seen));
    assert_eq!(pictures(&best.seen), pictures(&conventional.seen));
    for more in [("tile.encoding", "png"), ("tile.order", "centre"), ("tile.order", "pixels"), ("defer.depth_pixel", "separate")]
    {
        for other in modes(&views(&[0.0, 5.0]), &[more]) {
            assert_eq!(pictures(&best.seen), pictures(&other.seen), "{more:?}");
        }
    }
}

// Claim: as figures_5a_and_5b_mark_exactly_the_tiles_read.
#[test]
fn best_resolution_acquires_exactly_the_tiles_that_pixels_read() {
    let ran = timed(&views(&[0.0]), &mode("best", &[]));
    let wanted = wanted(&ran.seen, 0);
    assert!(wanted.len() > 20 && ran.seen.count("tiles_synthesized") > 0);
    assert_eq!(ran.seen.acquired(0), wanted, "none missing, none more");
    assert!(wanted.iter().all(|(texture, _)| *texture != 3), "nothing of the hidden picture");
}

// Claim: as all_modes_orders_and_lossless_encodings_end_alike.
#[test]
fn best_resolution_loads_least_and_conventional_most() {
    let [best, progressive, conventional] = modes(&views(&[0.0]), &[]);
    let bytes = |ran: &Ran| ran.seen.count("path_tile_bytes");
    assert!(bytes(&best) <= bytes(&progressive) && bytes(&progressive) < bytes(&conventional));
    assert_eq!(bytes(&conventional), conventional.seen.count("conventional_tile_bytes"));
    assert_eq!(best.seen.count("conventional_tile_bytes"), bytes(&conventional));
    let finest: u32 = [64 * 64, 150 * 40, 37 * 61, 128 * 128, 200 * 200].iter().sum();
    assert_eq!(bytes(&conventional), 3 * u64::from(finest));
    let loaded = conventional.seen.tiles(0, Some(TileOrigin::Loaded));
    let page_of = |texture: u32| conventional.seen.lists.iter().map(|l| &l.0).find(|p| p.texture == texture).unwrap();
    assert!(loaded.iter().all(|(t, tile)| page_of(*t).layer_of(*tile) == page_of(*t).dmax()), "all coarser layers are averaged");
}

/// Returns a view of the hall that declares three more textures. Polygons use only one of them.
fn declaring() -> Vec<Control> {
    let mut list = views(&[0.0]);
    let Some(Control::Frame(frame)) = list.first_mut() else { panic!("a list begins with a frame") };
    let textures = vec![
        texture(7, [40, 30], [WrapMode::Clamp; 2]),
        texture(0, [64, 64], [WrapMode::Repeat; 2]),
        texture(8, [9, 5], [WrapMode::Clamp; 2]),
    ];
    *frame = Arc::new(Frame { textures, ..Frame::clone(frame) });
    list
}

#[test]
fn declared_textures_count_without_polygons_452_471() {
    let (named, declared) = (modes(&views(&[0.0]), &[]), modes(&declaring(), &[]));
    let more = 3 * (40 * 30 + 9 * 5);
    for (named, declared) in named.iter().zip(&declared) {
        assert_eq!(pictures(&named.seen), pictures(&declared.seen));
        assert_eq!(declared.seen.count("textures"), named.seen.count("textures") + 2);
        assert_eq!(declared.seen.count("conventional_tile_bytes"), named.seen.count("conventional_tile_bytes") + more);
        assert_eq!(declared.seen.count("path_texture_size_bytes"), named.seen.count("path_texture_size_bytes") + 2 * 8);
    }
    let bytes = |ran: &Ran| ran.seen.count("path_tile_bytes");
    assert_eq!(bytes(&declared[0]), bytes(&named[0]), "best resolution loads nothing of them");
    assert_eq!(bytes(&declared[2]), bytes(&named[2]) + more, "conventional all of them");
    // 40 x 30 in tiles of 8 x 8: Dmax = 3, the top layer has 5 x 4 texels; 9 x 5: Dmax = 1, 5 x 3 texels.
    assert_eq!(bytes(&declared[1]), bytes(&named[1]) + 3 * (5 * 4 + 5 * 3), "progressive their top tiles");
    let of = |number: u32| declared[1].seen.lists.iter().filter(|l| l.0.texture == number).count();
    assert_eq!([of(0), of(7), of(8)], [1; 3], "one page each");
}

// Claim: as all_modes_orders_and_lossless_encodings_end_alike.
#[test]
fn first_progressive_picture_precedes_best_resolution() {
    let slow = [("path.bits_per_second", "20000000"), ("path.requests", "4")];
    let [best, progressive, conventional] = modes(&views(&[0.0]), &slow);
    assert!(progressive.report.marks[0] < best.report.marks[0] && best.report.marks[0] < conventional.report.marks[0]);
}

/// Asserts properties of the pictures of every frame.
fn progresses(ran: &Ran) {
    let most = ran.seen.lists.iter().map(|(page, _)| u32::from(page.dmax()) + 1).max().unwrap_or(1);
    for last in &ran.seen.finished {
        assert!(last.round < most, "{} pictures, at most Dmax + 1 = {most}", last.round + 1);
        let rounds = ran.seen.rounds.iter().filter(|r| r.index == last.index);
        assert!(rounds.clone().map(|r| r.round).eq(0..last.round));
        assert!(rounds.clone().all(|r| r.covered == last.covered), "every picture is whole");
    }
}

// Claim: defer, modes: `progressive` shows at most Dmax + 1 images, and no pixel becomes coarser.
#[test]
fn progressive_takes_at_most_dmax_plus_1_pictures() {
    let ran = timed(&views(&[0.0, 7.0]), &mode("progressive", &[]));
    assert!(ran.seen.finished[0].round >= 3, "there is something to improve");
    progresses(&ran);
}

// Claim: as progressive_takes_at_most_dmax_plus_1_pictures.
#[test]
fn from_picture_to_picture_no_pixel_becomes_coarser() {
    // Layers cannot be recognized by colour, because colours are averaged. They are derived from the tiles that have arrived, by frame.
    let list = views(&[0.0]);
    let full = timed(&list, &mode("progressive", &[]));
    let mut before: Option<Vec<Vec<u8>>> = None;
    for pictures in 1..=full.seen.finished[0].round + 1 {
        let pictures = pictures.to_string();
        let ran = timed(&list, &mode("progressive", &[("defer.pictures_per_view", &pictures)]));
        let filled = &ran.seen.filled[0];
        let finest = |cell: &ReferenceCell| {
            let page = &filled.pages[usize::from(cell.page()?)];
            let there = ran.seen.acquired(0);
            let wished = *layers(page, cell.depth).last()?;
            (0..=wished).rev().find(|l| read(page, *l, cell).iter().all(|t| there.contains(t)))
        };
        let own: Vec<Vec<u8>> = filled.cells.iter().map(|c| finest(c).into_iter().collect()).collect();
        if let Some(before) = &before {
            assert!(before.iter().zip(&own).all(|(b, o)| b <= o), "picture {pictures}");
            assert_ne!(before, &own, "picture {pictures} is better somewhere");
        }
        before = Some(own);
    }
}

// Claim: as marking_only_changes_n_to_l.
#[test]
fn leaving_early_drops_requests_and_next_view_continues() {
    let early = [("defer.pictures_per_view", "2")];
    let ran = timed(&views(&[0.0, 0.0, 0.0, 0.0]), &mode("progressive", &early));
    let full = timed(&views(&[0.0]), &mode("best", &[]));
    assert!(ran.seen.finished.iter().all(|f| f.round <= 1));
    assert_ne!(ran.seen.finished[0].rgb, full.seen.finished[0].rgb);
    assert_eq!(ran.seen.finished[3].rgb, full.seen.finished[0].rgb);
    assert!(ran.seen.lists.iter().any(|(_, list)| list.states().contains(&basrelief_deferred_renderer::TileState::NotPresent)));
}

// Claim: defer, 481, 482: A new viewpoint fetches only missing tiles.
#[test]
fn new_viewpoint_fetches_only_missing_tiles() {
    for m in ["best", "progressive"] {
        let both = timed(&views(&[12.0, 0.0]), &mode(m, &[])).seen;
        let second = timed(&views(&[0.0]), &mode(m, &[])).seen;
        let (first, new, reused) = (both.acquired(0), both.acquired(1), both.tiles(1, None));
        assert!(!new.is_empty() && !reused.is_empty());
        assert!(first.is_disjoint(&new), "nothing comes twice");
        assert!(reused.is_subset(&first));
        assert!(wanted(&both, 1).is_subset(&(&new | &reused)) && wanted(&both, 1) == wanted(&second, 0));
        assert_eq!(both.finished[1].rgb, second.finished[0].rgb);
        let same = timed(&views(&[3.0, 3.0]), &mode(m, &[])).seen;
        assert!(same.acquired(1).is_empty(), "the same view again loads nothing");
        assert_eq!(same.finished[0].rgb, same.finished[1].rgb);
        assert_eq!(same.count("tiles_reused"), wanted(&same, 1).len() as u64);
    }
}

// Claim: as half_centres_align_layers_integer_centres_shift_them.
#[test]
fn integer_texel_centres_keep_all_modes_equal() {
    let integer = [("defer.texel_centre", "integer")];
    let [best, progressive, conventional] = modes(&views(&[0.0]), &integer);
    assert_eq!(pictures(&best.seen), pictures(&progressive.seen));
    assert_eq!(pictures(&best.seen), pictures(&conventional.seen));
    assert_eq!(best.seen.acquired(0), wanted(&best.seen, 0));
    assert_ne!(pictures(&best.seen), pictures(&timed(&views(&[0.0]), &mode("best", &[])).seen));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 4, ..ProptestConfig::default() })]

    // Claim: as figures_5a_and_5b_mark_exactly_the_tiles_read.
    #[test]
    fn any_scene_ends_alike_in_all_modes(list in display_lists()) {
        let [best, progressive, conventional] = modes(&list, &[]);
        prop_assert_eq!(pictures(&best.seen), pictures(&progressive.seen));
        prop_assert_eq!(pictures(&best.seen), pictures(&conventional.seen));
        progresses(&progressive);
        let mut there = BTreeSet::new();
        for frame in 0..best.seen.filled.len() {
            let wanted = wanted(&best.seen, frame);
            prop_assert_eq!(best.seen.acquired(frame), &wanted - &there);
            there.extend(wanted);
        }
    }
}

#[test]
fn trace_without_textures_warns_that_no_tile_is_needed() {
    let plain = Arc::new(Material::default());
    let list = [vec![frame(0), object(0)], vec![floor(&plain, 3.0), Control::FrameEnd]].concat();
    let ran = timed(&list, &[FAST, SMALL].concat());
    assert_eq!((ran.seen.count("path_tile_bytes"), ran.seen.finished.len()), (0, 1));
    let unlit = warnings(&config(&[FAST, SMALL].concat()), &ran.seen.facts);
    assert!(unlit[0].contains("no pixel has a colour texture") && unlit[0].contains("defer.lighting"), "{unlit:?}");
    let lit = warnings(&config(&[FAST, SMALL, &[("defer.lighting", "gouraud")]].concat()), &ran.seen.facts);
    assert_eq!(lit, ["no pixel has a colour texture, so no tile was needed"]);
    let warned = |more: &[(&str, &str)]| {
        let settings = [FAST, SMALL, more].concat();
        warnings(&config(&settings), &timed(&views(&[0.0]), &settings).seen.facts)
    };
    assert_eq!(warned(&[]), [""; 0]);
    assert_eq!(warned(&[("path.requests", "4"), ("path.tiles_per_request", "4")]), [""; 0]);
    assert_eq!(
        warned(&[("engine.filter_latency", "90"), ("engine.latency", "7"), ("rasterizer.early_z", "false")]),
        [
            "engine.filter_latency = 90 counts as 7, because it is a part of engine.latency = 7",
            "rasterizer.early_z = false has no effect: this machine tests the depth of fragments before it makes cells of them",
        ]
    );
    let narrow = [("cell.coordinate_format", "fixed"), ("cell.coordinate_bits", "12"), ("cell.coordinate_fraction_bits", "7")];
    let clamped = warned(&narrow);
    assert!(
        clamped[0].contains(" cells exceed their fields and are clamped; lower cell.coordinate_fraction_bits"),
        "{clamped:?}"
    );
    assert_eq!(
        warned(&[("path.requests", "4"), ("path.tiles_per_request", "5")]),
        ["fifo.orders.depth = 16 allows 16 tiles in flight; path.requests x path.tiles_per_request are 20"]
    );
}
