//! Exhibits as lines of JSON and as pictures.

use basrelief_deferred_renderer::{Cell, FilledBuffer, How, Page, TileList, TileRecord, TileState};
use basrelief_reference::Picture;
use serde::Serialize;
use std::io::{self, Write};
use std::sync::Arc;

/// A textured pixel of the reference buffer (126).
#[derive(Serialize)]
struct PixelLine {
    /// Left out for the first frame.
    #[serde(skip_serializing_if = "is_zero")]
    frame: u32,
    x: u32,
    y: u32,
    texture: u32,
    s: f32,
    t: f32,
    depth: f32,
}

/// A tile that a frame has acquired, or used again.
#[derive(Serialize)]
struct TileLine {
    /// Left out for the first frame.
    #[serde(skip_serializing_if = "is_zero")]
    frame: u32,
    texture: u32,
    width: u32,
    height: u32,
    layer: u8,
    tile: u32,
    state: &'static str,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands references")]
fn is_zero(frame: &u32) -> bool {
    *frame == 0
}

fn line(out: &mut dyn Write, line: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *out, line)?;
    out.write_all(b"\n")
}

/// Writes one line per textured pixel: `{"x", "y", "texture", "s", "t", "depth"}`, texture coordinates in texels of the finest
/// layer, without a half-texel offset; with `"frame"` in front for all frames but the first.
///
/// # Errors
/// What the writer says.
pub fn write_reference_buffer(filled: &FilledBuffer, out: &mut dyn Write) -> io::Result<()> {
    for (i, cell) in (0..).zip(&filled.cells) {
        let Some(page) = cell.page().and_then(|p| filled.pages.get(usize::from(p))) else { continue };
        let [s, t] = cell.coordinates;
        let (x, y) = (i % filled.width, i / filled.width);
        line(out, &PixelLine { frame: filled.frame, x, y, texture: page.texture, s, t, depth: cell.depth })?;
    }
    Ok(())
}

/// Writes one line per tile of frame `frame`: `{"texture", "width", "height", "layer", "tile", "state"}`, the size that of the
/// texture, the state `loaded`, `synthesized` or `reused`; with `"frame"` in front for all frames but the first.
///
/// # Errors
/// What the writer says.
pub fn write_tiles(frame: u32, tiles: &[TileRecord], out: &mut dyn Write) -> io::Result<()> {
    for TileRecord { page, tile, acquired } in tiles {
        let [width, height] = page.texture_size;
        let state = match acquired {
            Some(How::Loaded) => "loaded",
            Some(How::Synthesized) => "synthesized",
            None => "reused",
        };
        let layer = page.layer_of(*tile);
        line(out, &TileLine { frame, texture: page.texture, width, height, layer, tile: *tile, state })?;
    }
    Ok(())
}

/// Colours from coarse to fine: dark blue, cyan, yellow, red.
const HEAT: [[f32; 3]; 4] = [[20.0, 20.0, 120.0], [0.0, 190.0, 220.0], [250.0, 220.0, 40.0], [200.0, 20.0, 20.0]];

/// A colour of the heat map, 0..=1.
fn heat(value: f32) -> [u8; 3] {
    let at = value.clamp(0.0, 1.0) * (HEAT.len() - 1) as f32;
    let first = (at as usize).min(HEAT.len() - 2);
    let share = at - first as f32;
    [0, 1, 2].map(|c| (HEAT[first][c] + (HEAT[first + 1][c] - HEAT[first][c]) * share + 0.5) as u8)
}

/// Direct colour: no texture, no layer.
const DIRECT: [u8; 3] = [128; 3];

/// Layer depth per pixel as a heat map: blue is layer 0, red the finest layer of the scene; pixels of direct colour are grey.
pub fn layer_depth(filled: &FilledBuffer) -> Picture {
    let deepest = filled.pages.iter().map(|p| p.dmax()).max().unwrap_or(0).max(1);
    let colour = |cell: &Cell| if cell.page().is_some() { heat(cell.depth / f32::from(deepest)) } else { DIRECT };
    let mut picture = Picture::new(filled.width, filled.height);
    for (at, cell) in filled.cells.iter().enumerate().filter(|(_, cell)| cell.is_drawn()) {
        picture.rgb[at] = colour(cell);
        picture.covered[at] = true;
    }
    picture
}

/// Side of a tile in the map, with the gap to the next \[pixels\].
const TILE_SIDE: u32 = 6;
/// Between textures, and between layers \[pixels\].
const GAP: u32 = 10;
/// Highest and widest map \[pixels\].
const MOST: u32 = 8192;

fn colour_of(state: TileState) -> [u8; 3] {
    match state {
        TileState::NotPresent => [70, 70, 78],
        TileState::Load => [240, 200, 40],
        TileState::Exists => [60, 180, 90],
    }
}

/// Tile load lists (136) at the end of a run: a row per texture, its layers from the coarsest on the left to the finest; grey is
/// N, yellow L, green E. What does not fit is left out.
pub fn tile_map(lists: &[(Arc<Page>, TileList)]) -> Picture {
    let row = |page: &Page| {
        let width = page.layers.iter().fold(GAP, |sum, l| sum + l.pitch * TILE_SIDE + GAP);
        (width, page.layers.last().map_or(0, |l| l.rows) * TILE_SIDE + GAP)
    };
    let (width, height) = lists
        .iter()
        .map(|(page, _)| row(page))
        .fold((1, GAP), |(w, h), (width, height)| (w.max(width), h.saturating_add(height)));
    let mut picture = Picture::new(width.min(MOST), height.min(MOST));
    let mut top = GAP;
    for (page, list) in lists {
        let mut left = GAP;
        for layer in &page.layers {
            for (number, state) in (0..layer.pitch * layer.rows).zip(&list.states()[layer.base as usize..]) {
                let place = [left + number % layer.pitch * TILE_SIDE, top + number / layer.pitch * TILE_SIDE];
                fill(&mut picture, place, colour_of(*state));
            }
            left += layer.pitch * TILE_SIDE + GAP;
        }
        top = top.saturating_add(row(page).1);
    }
    picture
}

/// Draws a tile of the map.
fn fill(picture: &mut Picture, [left, top]: [u32; 2], colour: [u8; 3]) {
    let (right, bottom) = ((left + TILE_SIDE - 1).min(picture.width), top.saturating_add(TILE_SIDE - 1).min(picture.height));
    for y in top..bottom {
        for x in left..right {
            let at = (y * picture.width + x) as usize;
            picture.rgb[at] = colour;
            picture.covered[at] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_deferred_renderer::Cut;
    use basrelief_signals::{Image, Sampler, Texture, Wrap};

    fn page() -> Arc<Page> {
        let levels = vec![Image { width: 100, height: 60, texels: vec![] }];
        let texture = Texture { id: 5, name: "t".into(), sampler: Sampler::default(), levels, offset: 0 };
        Arc::new(Page::new(0, &texture, [Wrap::Repeat; 2], Cut::default(), 0))
    }

    fn buffer(frame: u32) -> FilledBuffer {
        let cells = vec![Cell::textured(0, [1.5, 2.25], 0.5, [255; 3]), Cell::direct([1, 2, 3]), Cell::default()];
        FilledBuffer { frame, width: 3, height: 1, pages: vec![page()], cells }
    }

    fn text(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn a_textured_pixel_is_a_line() {
        let first = text(|out| write_reference_buffer(&buffer(0), out));
        assert_eq!(first, "{\"x\":0,\"y\":0,\"texture\":5,\"s\":1.5,\"t\":2.25,\"depth\":0.5}\n");
        assert!(text(|out| write_reference_buffer(&buffer(2), out)).starts_with("{\"frame\":2,\"x\":0,"));
    }

    #[test]
    fn a_tile_is_a_line() {
        let record = |tile, acquired| TileRecord { page: page(), tile, acquired };
        let all = [record(0, Some(How::Synthesized)), record(1, Some(How::Loaded)), record(2, None)];
        let lines = text(|out| write_tiles(0, &all, out));
        let states: Vec<&str> = lines.lines().map(|l| l.rsplit('"').nth(1).unwrap()).collect();
        assert_eq!(states, ["synthesized", "loaded", "reused"]);
        let second = "{\"texture\":5,\"width\":100,\"height\":60,\"layer\":1,\"tile\":1,\"state\":\"loaded\"}";
        assert_eq!(lines.lines().nth(1), Some(second));
        assert!(text(|out| write_tiles(3, &all, out)).starts_with("{\"frame\":3,\"texture\":5,"));
    }

    #[test]
    fn the_heat_map_runs_from_blue_to_red_and_shows_direct_colours_grey() {
        let picture = layer_depth(&buffer(0));
        assert_eq!(picture.covered, [true, true, false]);
        assert_eq!(picture.rgb[1], DIRECT);
        assert_eq!((heat(0.0), heat(1.0), heat(9.0)), ([20, 20, 120], [200, 20, 20], [200, 20, 20]));
        assert!(heat(0.33)[2] > heat(0.9)[2]);
    }

    #[test]
    fn the_map_has_a_square_for_every_tile_in_the_colour_of_its_state() {
        let page = page();
        let mut list = TileList::new(page.tiles());
        list.mark(1);
        list.acquire(&page);
        list.mark(2);
        let picture = tile_map(&[(Arc::clone(&page), list.clone()), (page, list)]);
        assert_eq!((picture.width, picture.height), (10 + 16 + 22, 10 + 2 * 16));
        let count = |colour| picture.rgb.iter().filter(|c| **c == colour).count();
        assert_eq!([TileState::NotPresent, TileState::Load, TileState::Exists].map(|s| count(colour_of(s))), [2 * 25; 3]);
    }
}
