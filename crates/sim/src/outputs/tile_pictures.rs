//! Pictures of machine `defer`: layer depth and tile load lists.

use super::heat_map::{ColourScale, heat_map};
use super::lettering::{ADVANCE, LINE, set, write};
use basrelief_deferred_renderer::{FilledBuffer, PyramidLayer, ReferenceCell, TexturePage, TileList, TileState};
use basrelief_reference::RgbPicture;
use std::sync::Arc;

/// Colour of pixels without a texture.
const DIRECT: [u8; 3] = [128; 3];

/// Draws the layer depth of each pixel as a heat map, from layer 0 to the finest layer of the scene. Pixels without a texture are grey.
pub(super) fn layer_depth_picture(filled: &FilledBuffer) -> RgbPicture {
    let deepest = filled.pages.iter().map(|p| p.dmax()).max().unwrap_or(0).max(1);
    let depth = |cell: &ReferenceCell| if cell.page().is_some() { cell.depth } else { f32::NAN };
    let depths: Vec<f32> = filled.cells.iter().map(depth).collect();
    let between: Vec<f64> = (1..deepest).map(f64::from).collect();
    let title = "layer of the pyramid, 0 is the coarsest, grey: no texture";
    let scale = ColourScale { marks: &between, ..ColourScale::new(title, deepest.into()) };
    let mut picture = heat_map(filled.width, &depths, &scale);
    for (at, _) in filled.cells.iter().enumerate().filter(|(_, cell)| cell.is_drawn() && cell.page().is_none()) {
        picture.rgb[at] = DIRECT;
        picture.covered[at] = true;
    }
    picture
}

/// Side of a tile in the map, with the gap to the next tile \[pixels\].
const TILE_SIDE: u32 = 6;
/// Gap between textures, and between layers \[pixels\].
const GAP: u32 = 10;
/// Maximum width and height of the map \[pixels\].
const MAX_SIDE: u32 = 8192;

const STATES: [TileState; 3] = [TileState::NotPresent, TileState::Load, TileState::Exists];

fn colour_of(state: TileState) -> [u8; 3] {
    match state {
        TileState::NotPresent => [70, 70, 78],
        TileState::Load => [240, 200, 40],
        TileState::Exists => [60, 180, 90],
    }
}

/// Returns the width of a layer in the map \[pixels\].
fn width_of(layer: &PyramidLayer) -> u32 {
    layer.pitch.saturating_mul(TILE_SIDE)
}

fn title_of(page: &TexturePage) -> String {
    let name: String = page.name.chars().take(24).collect();
    let [width, height] = page.texture_size;
    format!("{}: {name} {width}x{height}", page.texture)
}

/// Returns the size of a texture in the map, with gaps \[pixels\].
fn size_of(page: &TexturePage) -> [u32; 2] {
    let layers = page.layers.iter().fold(0, |sum: u32, l| sum.saturating_add(width_of(l)).saturating_add(GAP));
    let title = title_of(page).chars().count() as u32 * ADVANCE + 2 * GAP;
    let rows = page.layers.last().map_or(0, |l| l.rows);
    [layers.max(title), rows.saturating_mul(TILE_SIDE).saturating_add(2 * LINE + GAP)]
}

/// Places textures of these sizes in rows, and returns their places and the size of the map. Without gaps, a row is twice as long as the
/// map is high, so that the map fits on a screen.
fn arrange(sizes: &[[u32; 2]]) -> (Vec<[u32; 2]>, [u32; 2]) {
    let area: f64 = sizes.iter().map(|[w, h]| f64::from(*w) * f64::from(*h)).sum();
    let widest = sizes.iter().map(|s| s[0]).max().unwrap_or(1);
    let line = ((area * 2.0).sqrt() as u32).max(widest);
    let ([mut left, mut top], mut height, mut width) = ([0_u32; 2], 0, 0);
    let place = |[w, h]: &[u32; 2]| {
        if left.saturating_add(*w) > line {
            [left, top, height] = [0, top.saturating_add(height), 0];
        }
        let place = [left, top];
        (left, height) = (left.saturating_add(*w), height.max(*h));
        width = width.max(left);
        place
    };
    let places = sizes.iter().map(place).collect();
    (places, [width, top.saturating_add(height)])
}

/// Draws the tile load lists (136) at the end of a run. Each texture has a title with number, name and size, and its numbered layers from
/// the coarsest on the left to the finest. Grey is N, yellow is L, green is E. Tiles beyond the maximum size are omitted.
pub(super) fn tile_map_picture(lists: &[(Arc<TexturePage>, TileList)]) -> RgbPicture {
    let sizes: Vec<_> = lists.iter().map(|(page, _)| size_of(page)).collect();
    let (places, [width, height]) = arrange(&sizes);
    // Legend below the map.
    let least = 3 * (TILE_SIDE + 3 * ADVANCE) + GAP;
    let size = [width.max(least).saturating_add(GAP), height.saturating_add(GAP + LINE)].map(|n| n.min(MAX_SIDE));
    let mut picture = RgbPicture::new(size[0], size[1]);
    picture.rgb.fill([32; 3]);
    picture.covered.fill(true);
    for ((page, list), [left, top]) in lists.iter().zip(places) {
        draw(&mut picture, page, list, [left.saturating_add(GAP), top.saturating_add(GAP)]);
    }
    for (n, state) in (0..).zip(STATES) {
        let (left, top) = (GAP + n * (TILE_SIDE + 3 * ADVANCE), size[1] - LINE);
        fill(&mut picture, [left, top + 2], colour_of(state));
        write(&mut picture, left + ADVANCE, top, &state.letter().to_string());
    }
    picture
}

/// Draws a texture.
fn draw(picture: &mut RgbPicture, page: &TexturePage, list: &TileList, [left, top]: [u32; 2]) {
    if top >= picture.height {
        return;
    }
    write(picture, left, top, &title_of(page));
    let (mut left, top) = (left, top + LINE);
    for (depth, layer) in page.layers.iter().enumerate() {
        write(picture, left, top, &depth.to_string());
        for (number, state) in (0..layer.pitch * layer.rows).zip(&list.states()[layer.base as usize..]) {
            let [column, row] = [number % layer.pitch, number / layer.pitch];
            fill(picture, [left + column * TILE_SIDE, top + LINE + row * TILE_SIDE], colour_of(*state));
        }
        left = left.saturating_add(width_of(layer) + GAP);
    }
}

/// Draws a tile of the map.
fn fill(picture: &mut RgbPicture, [left, top]: [u32; 2], colour: [u8; 3]) {
    if left < picture.width && top < picture.height {
        let side = 0..TILE_SIDE - 1;
        side.clone().flat_map(|y| side.clone().map(move |x| (x, y))).for_each(|(x, y)| set(picture, left + x, top + y, colour));
    }
}

#[cfg(test)]
mod tests {
    use super::super::heat_map::BAR_HEIGHT;
    use super::*;
    use basrelief_deferred_renderer::PyramidCut;
    use basrelief_signals::{Image, Sampler, Texture};

    fn page([width, height]: [u32; 2]) -> Arc<TexturePage> {
        let levels = vec![Image { width, height, texels: vec![] }];
        let texture = Texture { id: 5, name: "t".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None };
        Arc::new(TexturePage::new(0, &texture, PyramidCut::default(), 0))
    }

    // Claim: as defer_writes_round_images_maps_and_dumps.
    #[test]
    fn layer_depth_has_a_scale_and_direct_colours_are_grey() {
        let mut cells = vec![ReferenceCell::default(); 200];
        cells[0] = ReferenceCell::textured(0, [1.5, 2.25], 0.0, [255; 3]);
        cells[1] = ReferenceCell::textured(0, [1.5, 2.25], 2.0, [255; 3]);
        cells[2] = ReferenceCell::direct([1, 2, 3]);
        let pages = vec![page([200, 60])];
        let picture = layer_depth_picture(&FilledBuffer { frame: 0, width: 100, height: 2, pages, cells });
        assert_eq!(picture.covered[..4], [true, true, true, false]);
        assert_eq!(picture.rgb[2], DIRECT);
        // The bar runs from the colour of layer 0 to that of Dmax = 2, with a tick for layer 1 in its middle.
        let top = (picture.height - BAR_HEIGHT) as usize;
        let bar: Vec<_> = (0..100).map(|x| picture.rgb[(top + 6) * 100 + x]).collect();
        assert_eq!((bar[6], picture.rgb[1]), (picture.rgb[0], [252, 250, 180]));
        let ticks: Vec<usize> = (0..100).filter(|x| picture.rgb[(top + 13) * 100 + x] == [255; 3]).collect();
        assert_eq!(ticks, [6, 49, 93]);
    }

    // Claim: as defer_writes_round_images_maps_and_dumps.
    #[test]
    fn map_has_a_coloured_square_for_every_tile() {
        let page = page([100, 60]);
        let mut list = TileList::new(page.tiles());
        list.mark(1);
        list.acquire(&page);
        list.mark(2);
        let picture = tile_map_picture(&[(Arc::clone(&page), list.clone()), (page, list)]);
        let count = |colour| picture.rgb.iter().filter(|c| **c == colour).count();
        // One of each state in each texture, and one in the legend.
        assert_eq!(STATES.map(|s| count(colour_of(s))), [3 * 25; 3]);
        assert!(count([255; 3]) > 100, "names and numbers");
    }

    #[test]
    fn textures_are_placed_in_rows_without_overlap() {
        let sizes = [[300, 200], [300, 200], [200, 40], [600, 10], [10, 10], [300, 200]];
        let (places, [width, height]) = arrange(&sizes);
        assert_eq!(places, [[0, 0], [300, 0], [0, 200], [0, 240], [600, 240], [0, 250]]);
        assert_eq!((width, height), (610, 450));
    }

    #[test]
    fn map_is_clipped_at_its_maximum_size() {
        let page = page([1 << 17, 1 << 18]);
        let list = TileList::new(page.tiles());
        let picture = tile_map_picture(&[(page, list)]);
        assert_eq!((picture.width, picture.height), (MAX_SIDE, MAX_SIDE));
        assert_eq!((tile_map_picture(&[]).width, tile_map_picture(&[]).height), (110, 24), "no texture: the legend alone");
    }
}
