//! Contents of a pixel's cell, and the layers that colour it: Figures 3A, 3B, 7A, 7B.

use crate::acquisition::load;
use crate::{page, texture};
use basrelief_deferred_renderer::cell::{layer_depth, split_depth};
use basrelief_deferred_renderer::colour::{best, progressive, sample, shaded};
use basrelief_deferred_renderer::{
    CellConfig, CellFormat, FilledBuffer, NumberFormat, PageTexels, PicturePreview, ReferenceCell, ServedTexture, TileEncoding,
};
use std::sync::Arc;

// Claim: defer, layer depth: D = Dmax - log2(rho), clamped; split into D_L and D_f.
#[test]
fn layer_depth_is_dmax_minus_log2_of_longer_axis() {
    for (rho, depth) in [(1.0, 4.0), (2.0, 3.0), (8.0, 1.0), (0.25, 4.0), (64.0, 0.0), (0.0, 4.0)] {
        assert_eq!(layer_depth(4, rho * rho), depth, "rho {rho}");
    }
    assert_eq!((layer_depth(4, f32::NAN), layer_depth(4, f32::INFINITY)), (4.0, 0.0));
    assert_eq!(
        [split_depth(2.75, 4), split_depth(3.0, 4), split_depth(4.0, 4), split_depth(9.0, 4)],
        [(2, 0.75), (3, 0.0), (4, 0.0), (4, 0.0)]
    );
}

/// Creates the texels of a page of which these layers are present.
fn with_layers(size: [u32; 2], layers: &[u8]) -> PageTexels {
    let page = page(size, [16, 16]);
    let mut served = ServedTexture::new(texture(size));
    let mut texels = PageTexels::new(Arc::clone(&page));
    for tile in (0..page.tiles()).filter(|t| layers.contains(&page.layer_of(*t))) {
        load(&mut served, &mut texels, tile, TileEncoding::Raw);
    }
    texels
}

// Claim: as embodiments_10_and_20_interpolate_once_or_twice_by_depth.
#[test]
fn embodiments_10_and_20_fractional_depth_blends_layers() {
    let texels = with_layers([128, 128], &[0, 1, 2, 3]);
    let at = |depth: f32| {
        let cell = ReferenceCell::textured(0, [40.3, 71.9], depth, [255; 3]);
        let choice = best(&texels, &cell);
        sample(&texels, &choice, texels.page.placed(cell.coordinates, cell.wrap))
    };
    let [one, half, two] = [1.0, 1.5, 2.0].map(at);
    assert_eq!([one, half, two].map(|s| s.read.iter().flatten().count()), [1, 2, 1]);
    for c in 0..3 {
        assert!((half.colour[c] - 0.5 * (one.colour[c] + two.colour[c])).abs() < 1e-4);
    }
    assert_eq!(at(3.0).read[0].map(|r| r.0), Some(3), "D_G beyond Dmax: Dmax alone");
}

// Claim: defer, Figure 7B; [0151], errata: The finest present layer colours, and the next is marked. D_f = 0 starts at D_L. D_G of
// an earlier view stays.
#[test]
fn figure_7b_uses_finest_present_layer_and_marks_next() {
    let choose = |there: &[u8], depth: f32| {
        let texels = with_layers([128, 128], there);
        let cell = ReferenceCell::textured(0, [40.3, 71.9], depth, [255; 3]);
        let placed = texels.page.placed(cell.coordinates, cell.wrap);
        progressive(&texels, &cell, placed, 16).map(|c| (c.lower, c.upper.map(|u| u.0), c.improve))
    };
    assert_eq!(choose(&[], 1.5), None);
    assert_eq!(choose(&[0], 2.5), Some((0, None, Some(1))));
    assert_eq!(choose(&[0, 1, 2], 2.5), Some((2, None, Some(3))));
    assert_eq!(choose(&[0, 1, 2, 3], 2.5), Some((2, Some(3), None)), "erratum [0151]: D_G and D_L, not D_G - 1 of D_L");
    assert_eq!(choose(&[0, 1, 2], 2.0), Some((2, None, None)), "erratum: with D_f = 0 nothing of D_G is fetched");
    assert_eq!(choose(&[0, 3], 2.5), Some((3, None, Some(2))), "D_G of an earlier view: colour from it, fetch D_L");
    assert_eq!(choose(&[0, 1, 2, 3], 3.0), Some((3, None, None)), "magnified: D_L = D_G = Dmax");
}

// Claim: defer, Figures 3A, 3B; [0092]: Fields of the cell round to their format, fixed or floating.
#[test]
fn cell_values_fit_their_fields() {
    let page = page([1024, 1024], [64, 64]);
    let cell =
        |config: &CellConfig| CellFormat::new(config, 1.0).textured(&page, [-5.141_592_7, 1000.123], 2.345_678, [0.5, 1.0, 7.0]);
    let standard = CellConfig::default();
    assert_eq!((standard.bits(), CellFormat::new(&standard, 1.0).bytes), (128, 16));
    let exact = cell(&standard);
    assert_eq!((exact.coordinates, exact.coefficients()), ([-5.141_592_7, 1000.123], [128, 255, 255]));
    assert!((exact.depth - 2.345_678).abs() <= 0.5 / 262_144.0);
    let fixed = CellConfig {
        coordinate_format: NumberFormat::Fixed,
        coordinate_bits: 16,
        coordinate_fraction_bits: 4,
        depth_bits: 10,
        depth_fraction_bits: 4,
        brightness_bits: 4,
        ..CellConfig::default()
    };
    let coarse = cell(&fixed);
    assert_eq!((coarse.coordinates, coarse.depth, coarse.coefficients()), ([-5.125, 1000.125], 2.375, [8, 15, 15]));
    let float = CellConfig { coordinate_bits: 16, ..CellConfig::default() };
    let [s, t] = cell(&float).coordinates;
    assert!((s + 5.141_592_7).abs() <= 8.0 / 256.0 && (t - 1000.123).abs() <= 4.0, "7 bits of fraction: {s} {t}");
    assert_eq!(ReferenceCell::direct([1, 2, 3]).rgb(), [1, 2, 3]);
    assert!(!ReferenceCell::default().is_drawn() && ReferenceCell::direct([0; 3]).page().is_none());
}

// Claim: as cell_values_fit_their_fields.
#[test]
fn cell_formula_reads_brightness_back() {
    let page = page([64, 64], [64, 64]);
    for range in [1.0, 2.0] {
        let format = CellFormat::new(&CellConfig { brightness_bits: 10, ..CellConfig::default() }, range);
        let read = format.brightness(&format.textured(&page, [0.0; 2], 0.0, [0.0, 0.3, 1.0]));
        assert!(read.iter().zip([0.0, 0.3, 1.0]).all(|(a, b)| (a - b).abs() <= range / 2046.0 + 1e-6), "{read:?}");
    }
}

#[test]
fn preview_uses_finest_received_layer_and_averages() {
    let (size, format) = ([64, 64], CellFormat::new(&CellConfig::default(), 1.0));
    let (page, mut served) = (page(size, [16, 16]), ServedTexture::new(texture(size)));
    let cell = ReferenceCell::textured(0, [40.3, 50.9], 1.5, [255; 3]);
    let filled = FilledBuffer { width: 2, height: 1, cells: vec![cell, ReferenceCell::default()], ..FilledBuffer::default() };
    let mut preview = PicturePreview::new(format.clone(), TileEncoding::Raw);
    let mut come = |preview: &mut PicturePreview, layer: u8| {
        for tile in (0..page.tiles()).filter(|tile| page.layer_of(*tile) == layer) {
            let bytes = TileEncoding::Raw.encode(&served.tile(&page, tile), [16, 16], 0).expect("a tile");
            preview.store(&page, tile, &bytes);
        }
        preview.picture(&filled)
    };
    let placed = page.placed(cell.coordinates, cell.wrap);
    let colour = |layers: &[u8]| {
        let texels = with_layers(size, layers);
        let choice = progressive(&texels, &cell, placed, 16).expect("a layer");
        Some(shaded(&format, &cell, sample(&texels, &choice, placed).colour))
    };
    assert_eq!(preview.picture(&filled), [None, None]);
    assert_eq!(come(&mut preview, 0), [colour(&[0]), None]);
    assert_eq!(come(&mut preview, 2), [colour(&[0, 1, 2]), None], "layer 1 is the average of layer 2");
    assert_ne!(colour(&[0, 1, 2]), colour(&[0, 2]));
}
