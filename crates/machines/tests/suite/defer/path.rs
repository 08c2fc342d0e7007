//! The path: rate, latency, requests in flight, and errors.

use crate::defer::recipe::{FAST, SMALL, views};
use crate::defer::runs::{Tile, config, replay, timed};
use basrelief_deferred_renderer::identification::layers_of;
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{
    FilledBuffer, PyramidCut, ReferenceCell, TextureMemory, TexturePage, TileEncoding, TileOrigin, TileSource,
};
use basrelief_kernel::{Engine, Outcome};
use basrelief_machines::defer::DeferredRenderer;
use basrelief_machines::{MachineEngines as _, PictureMachine};
use basrelief_signals::Texture;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// Returns the render cycles.
fn render_cycles(more: &[(&str, &str)]) -> u64 {
    timed(&views(&[0.0]), &[FAST, SMALL, more].concat()).report.marked_cycles()
}

// Claim: defer, path (104, 106, 108): Rate, latency, requests in flight, bytes and order of tiles. Errors name damaged or lost
// tiles.
#[test]
fn double_rate_halves_the_time_of_a_path_bound_run() {
    let [slow, fast] = ["1000000", "2000000"].map(|rate| render_cycles(&[("path.bits_per_second", rate)]));
    let ratio = slow as f64 / fast as f64;
    assert!((1.99..2.01).contains(&ratio), "{ratio}");
}

// Claim: as double_rate_halves_the_time_of_a_path_bound_run.
#[test]
fn requests_in_flight_hide_the_latency_of_the_path() {
    let slow = |requests: &str| render_cycles(&[("path.latency_us", "200"), ("path.requests", requests)]);
    let loaded = timed(&views(&[0.0]), &[FAST, SMALL].concat()).seen.count("tiles_loaded");
    let (one, four, many) = (slow("1"), slow("4"), slow("4096"));
    // The polygons wait for one latency, then each tile waits for one.
    let latency = config(&[]).clock.hz / 5_000;
    assert!((loaded * latency..(loaded + 3) * latency).contains(&one), "{loaded} tiles, {one} cycles");
    assert!(four < one / 3 && many < four);
    assert!((2 * latency..4 * latency).contains(&many), "all in flight: {many}");
}

// Claim: as double_rate_halves_the_time_of_a_path_bound_run.
#[test]
fn transferred_bytes_equal_counted_bytes() {
    let ran = timed(&views(&[0.0, 2.0]), &[FAST, SMALL].concat());
    let seen = &ran.seen;
    // Polygons of 4, 4, 4, 3 and 4 corners with textures and one of 3 without, in objects without a mesh: sent only in the first frame.
    assert_eq!(seen.count("path_polygon_bytes"), 4 * (5 * (4 * 4 + 3) + 3 * 3));
    assert_eq!(seen.count("path_command_bytes"), 2 * 4 * (21 + 5 + 2 * 13), "a frame with a light, and two objects: in both");
    assert_eq!(seen.count("path_texture_size_bytes"), 8 * 5);
    let texels = |frame: usize| -> u64 {
        let loaded = seen.tiles[frame].iter().filter(|r| r.acquired == Some(TileOrigin::Loaded));
        loaded.map(|r| r.page.texels_in(r.tile)).sum()
    };
    assert_eq!(seen.count("path_tile_bytes"), 3 * (texels(0) + texels(1)));
}

#[test]
fn response_has_one_head_and_tiles_of_one_acquisition() {
    let heads = |most: &str, bytes: &str| {
        let settings = [("path.tiles_per_request", most), ("path.head_bytes", bytes)];
        timed(&views(&[0.0]), &[FAST, SMALL, &settings].concat()).seen
    };
    let (none, one, some, all) = (heads("1", "0"), heads("1", "100"), heads("3", "100"), heads("64", "100"));
    assert_eq!(one.count("path_head_bytes"), 100 * one.count("tiles_loaded"), "each tile by itself");
    let mut pictures = BTreeMap::<u32, u64>::new();
    for record in all.tiles[0].iter().filter(|record| matches!(record.acquired, Some(TileOrigin::Loaded))) {
        *pictures.entry(record.page.texture).or_default() += 1;
    }
    assert_eq!(all.count("path_head_bytes"), 100 * pictures.len() as u64, "one acquisition: an answer for each picture");
    assert_eq!(some.count("path_head_bytes"), 100 * pictures.values().map(|tiles| tiles.div_ceil(3)).sum::<u64>());
    for seen in [&one, &some, &all] {
        assert_eq!(seen.count("path_bytes"), none.count("path_bytes") + seen.count("path_head_bytes"));
    }
}

/// Server that damages all tiles after the third.
#[derive(Debug)]
struct Damaged {
    good: TextureMemory,
    left: u32,
    lost: bool,
}

impl TileSource for Damaged {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.good.offer(texture);
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        let bytes = self.good.tile(page, tile)?;
        if self.left > 0 {
            self.left -= 1;
            return Ok(bytes);
        }
        if self.lost { Err(format!("{}: the server is gone", place_of(page, tile))) } else { Ok(bytes[..bytes.len() / 2].into()) }
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.good.finest_bytes(texture, cut)
    }
}

// Claim: as double_rate_halves_the_time_of_a_path_bound_run.
#[test]
fn missing_or_truncated_tile_is_an_error_with_its_name() {
    for lost in [true, false] {
        let config = config(&[FAST, SMALL].concat());
        let source = Damaged { good: TextureMemory::new(TileEncoding::Raw, 85), left: 3, lost };
        let mut machine = DeferredRenderer::with_source(replay(&views(&[0.0]), &config), &config, Box::new(source)).unwrap();
        let text = match machine.run(Engine::Timed).outcome {
            Outcome::Fault(text) => text,
            outcome => machine.lost().unwrap_or_else(|| panic!("{outcome:?}")).to_owned(),
        };
        assert!(text.contains("texture ") && text.contains("layer ") && text.contains("tile "), "{text}");
        assert!(text.contains(if lost { "the server is gone" } else { "expected" }), "{text}");
    }
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn lost_tile_keeps_complete_pictures_on_every_engine() {
    let settings = [FAST, SMALL, &[("defer.mode", "progressive")]].concat();
    let whole = timed(&views(&[0.0]), &settings).seen;
    let config = config(&settings);
    let machine = |left: u32| {
        let source = Damaged { good: TextureMemory::new(TileEncoding::Raw, 85), left, lost: true };
        let mut machine = DeferredRenderer::with_source(replay(&views(&[0.0]), &config), &config, Box::new(source)).unwrap();
        machine.keep();
        machine
    };
    let loaded = whole.count("tiles_loaded") as u32;
    let pictures_of = |mut machine: DeferredRenderer| {
        assert!(machine.lost().is_some_and(|lost| lost.contains("the server is gone")));
        let pictures = machine.drain_rounds().into_iter().chain(machine.drain_finished());
        pictures.map(|shown| shown.rgb).collect::<Vec<_>>()
    };
    let mut counts = vec![];
    for left in [loaded / 3, 2 * loaded / 3, loaded - 1] {
        let [timed, ticked] = [Engine::Timed, Engine::Ticked].map(|engine| {
            let mut machine = machine(left);
            assert!(matches!(machine.run(engine).outcome, Outcome::Deadlock(_)));
            pictures_of(machine)
        });
        let mut functional = machine(left);
        functional.run_functional(&mut |_| true).unwrap();
        let functional = pictures_of(functional);
        assert!(timed == ticked && timed == functional, "{left}");
        counts.push(timed.len());
    }
    assert!(counts.is_sorted() && counts[2] > counts[0], "{counts:?} of {loaded} tiles");
}

/// Server that logs its requests: texture and tile.
#[derive(Debug)]
struct Recording {
    good: TextureMemory,
    asked: Rc<RefCell<Vec<Tile>>>,
    announced: Rc<RefCell<Vec<Tile>>>,
}

impl TileSource for Recording {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.good.offer(texture);
    }

    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        self.announced.borrow_mut().extend(tiles.iter().map(|(page, tile)| (page.texture, *tile)));
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        self.asked.borrow_mut().push((page.texture, tile));
        self.good.tile(page, tile)
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.good.finest_bytes(texture, cut)
    }
}

/// Returns the requests in order, and the tiles that the pixels read.
fn asked(order: &str) -> (Vec<Tile>, Vec<(Tile, [u32; 2])>) {
    let config = config(&[FAST, SMALL, &[("tile.order", order)]].concat());
    let (asked, announced) = (Rc::default(), Rc::default());
    let good = TextureMemory::new(TileEncoding::Raw, 85);
    let source = Recording { good, asked: Rc::clone(&asked), announced: Rc::clone(&announced) };
    let mut machine = DeferredRenderer::with_source(replay(&views(&[0.0]), &config), &config, Box::new(source)).unwrap();
    machine.keep();
    assert_eq!(machine.run(Engine::Timed).outcome, Outcome::Complete);
    assert_eq!(*asked.borrow(), *announced.borrow(), "{order}: a server that looks ahead is told the order");
    let filled = machine.drain_filled().remove(0);
    let reads = (0..).zip(&filled.cells).flat_map(|(i, cell)| {
        let at = [i % filled.width, i / filled.width];
        reads_of(cell, &filled).into_iter().map(move |tile| (tile, at)).collect::<Vec<_>>()
    });
    (asked.take(), reads.collect())
}

fn reads_of(cell: &ReferenceCell, filled: &FilledBuffer) -> Vec<Tile> {
    let Some(page) = cell.page().map(|p| &filled.pages[usize::from(p)]) else { return vec![] };
    let (coarse, _, fine) = layers_of(page, cell);
    let placed = page.placed(cell.coordinates, cell.wrap);
    let tiles = [Some(coarse), fine].into_iter().flatten().flat_map(|layer| page.marked(layer, placed));
    tiles.map(|tile| (page.texture, tile)).collect()
}

// Claim: as double_rate_halves_the_time_of_a_path_bound_run.
#[test]
fn tiles_are_requested_in_the_configured_order() {
    let (listed, _) = asked("listed");
    let texture_order: Vec<u32> = listed.iter().map(|t| t.0).collect();
    let mut textures = texture_order.clone();
    textures.dedup();
    assert!(textures.len() == 4 && texture_order.iter().filter(|t| **t == textures[0]).count() > 1, "page by page");

    let (by_pixels, reads) = asked("pixels");
    let pixels = |tile: &Tile| reads.iter().filter(|r| r.0 == *tile).count();
    assert!(by_pixels.windows(2).all(|w| pixels(&w[0]) >= pixels(&w[1])), "most pixels first");
    assert!(pixels(&by_pixels[0]) > pixels(&by_pixels[by_pixels.len() - 1]));

    let (by_centre, reads) = asked("centre");
    let distance = |tile: &Tile| {
        let blocks = reads.iter().filter(|r| r.0 == *tile).map(|r| r.1.map(|c| c / 4 * 4 + 2));
        blocks.map(|[x, y]| x.abs_diff(20).pow(2) + y.abs_diff(15).pow(2)).min()
    };
    assert!(by_centre.windows(2).all(|w| distance(&w[0]) <= distance(&w[1])), "nearest to the centre first");
    let sorted = |mut tiles: Vec<Tile>| {
        tiles.sort_unstable();
        tiles
    };
    assert_eq!(sorted(listed.clone()), sorted(by_pixels));
    assert_ne!(listed, by_centre);
}
