//! Texture layout and raster order: they change memory traffic, but not pictures.

use crate::bump::runs::{Ran, config, machine, small_demo, timed};
use basrelief_machines::bump::BumpProcessor;
use basrelief_scene::{ViewOptions, demo};
use std::sync::Arc;

/// Raster orders, and layouts of textures.
const ORDERS: [&[(&str, &str)]; 4] =
    [&[], &[("rasterizer.block", "8")], &[("rasterizer.order", "rows")], &[("rasterizer.order", "columns")]];
const LAYOUTS: [&[(&str, &str)]; 5] = [
    &[],
    &[("texture.layout", "linear")],
    &[("texture.block", "2")],
    &[("texture.block", "16")],
    &[("texture.layout", "blocked_6d"), ("texture.superblock", "32")],
];

fn misses(ran: &Ran, cache: &str) -> u64 {
    ran.report.caches.iter().find(|c| c.name == cache).unwrap().counts.misses
}

// Claim: analysis: No image depends on texture layout. Texels have distinct addresses.
#[test]
fn pictures_do_not_depend_on_raster_order_or_layout() {
    for demo in ["mixed", "brick", "coin"] {
        let scene = small_demo(demo, 1);
        let expected = timed(&scene, &[]);
        for settings in ORDERS.iter().chain(&LAYOUTS) {
            let ran = timed(&scene, settings);
            assert!(ran.frames == expected.frames, "{demo}, {settings:?}");
            for figure in ["fragments", "bump_fragments", "normal_texels", "distinct_pseudo_normals", "pixels_textured"] {
                assert_eq!(ran.count(figure), expected.count(figure), "{demo}, {settings:?}, {figure}");
            }
        }
    }
}

// Claim: as pictures_do_not_depend_on_raster_order_or_layout.
#[test]
fn texture_traffic_depends_on_raster_order_and_layout() {
    let options = ViewOptions { size: [320, 240], frames: Some(1), ..ViewOptions::default() };
    let scene = Arc::new(demo("turntable", &options).unwrap());
    // A row of pixels needs more than its 1 KiB, a tile does not.
    let small = [("cache.color_texture.sets", "1"), ("cache.color_texture.ways", "16")];
    let read = |settings: &[(&str, &str)]| misses(&timed(&scene, &[&small, settings].concat()), "color_texture");
    let [tiled, _, rows, columns] = ORDERS.map(read);
    assert!(tiled < rows && tiled < columns, "{tiled}, {rows}, {columns}");
    let [blocked, linear, ..] = LAYOUTS.map(read);
    assert!(blocked < linear, "{blocked}, {linear}");
}

#[test]
fn incompatible_block_sides_are_rejected_with_a_key() {
    let scene = small_demo("brick", 1);
    let refused = |settings: &[(&str, &str)]| {
        let config = config(settings);
        BumpProcessor::new(crate::common::scene_front(&scene, &config), &config).err().unwrap().to_string()
    };
    assert_eq!(refused(&[("texture.block", "6")]), "`texture.block`: is 6, expected a power of two");
    assert_eq!(refused(&[("texture.superblock", "48")]), "`texture.superblock`: is 48, expected a power of two");
    let small = refused(&[("texture.layout", "blocked_6d"), ("texture.block", "16"), ("texture.superblock", "8")]);
    assert_eq!(small, "`texture.superblock`: is 8, but a block has a side of 16; set it to that or more");
    // Valid without superblocks.
    machine(&scene, &config(&[("texture.block", "16"), ("texture.superblock", "8")]));
}
