//! Pages, tiles, marking and acquisition, against tables and filters made without them.

use basrelief_deferred_renderer::acquisition::TileState;
use basrelief_deferred_renderer::cell::{layer_depth, split_depth};
use basrelief_deferred_renderer::colour::{best, progressive, sample};
use basrelief_deferred_renderer::{
    Cell, CellConfig, CellFormat, Cut, How, NumberFormat, Page, PageTexels, ServedTexture, TexelCentre, TileEncoding, TileList,
};
use basrelief_signals::{Image, Sampler, Texture, Wrap};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A texture of noise.
fn texture(size: [u32; 2]) -> Arc<Texture> {
    let mut state = 0x9e37_79b9_u32 ^ (size[0] << 16 | size[1]);
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let texels = (0..size[0] * size[1]).map(|_| [byte(), byte(), byte(), 255]).collect();
    let levels = vec![Image { width: size[0], height: size[1], texels }];
    Arc::new(Texture { id: 7, name: "noise".into(), sampler: Sampler::default(), levels, offset: 0 })
}

fn page_of(size: [u32; 2], wrap: [Wrap; 2], cut: Cut) -> Arc<Page> {
    Arc::new(Page::new(0, &texture(size), wrap, cut, 0))
}

fn page(size: [u32; 2], tile: [u32; 2]) -> Arc<Page> {
    page_of(size, [Wrap::Repeat; 2], Cut { tile, centre: TexelCentre::Half })
}

/// Sizes of layers from coarsest to finest, by halving until one fits into a tile.
fn halved(size: [u32; 2], tile: [u32; 2]) -> Vec<[u32; 2]> {
    let mut all = vec![size];
    while all[0][0] > tile[0] || all[0][1] > tile[1] {
        all.insert(0, all[0].map(|n| n / 2 + n % 2));
    }
    all
}

/// Numbers every texel of every layer with its tile, by walking over tiles.
fn numbered(size: [u32; 2], tile: [u32; 2]) -> Vec<Vec<Vec<u32>>> {
    let mut number = 0;
    let layer = |[width, height]: [u32; 2]| {
        let mut table = vec![vec![u32::MAX; width as usize]; height as usize];
        for top in (0..height).step_by(tile[1] as usize) {
            for left in (0..width).step_by(tile[0] as usize) {
                for row in table.iter_mut().skip(top as usize).take(tile[1] as usize) {
                    row.iter_mut().skip(left as usize).take(tile[0] as usize).for_each(|n| *n = number);
                }
                number += 1;
            }
        }
        table
    };
    halved(size, tile).into_iter().map(layer).collect()
}

const SIZES: [[u32; 2]; 12] =
    [[1, 1], [64, 64], [65, 64], [256, 256], [256, 64], [64, 512], [700, 300], [127, 129], [33, 1], [1, 200], [63, 65], [513, 3]];

#[test]
fn tile_numbers_pitch_and_base_are_those_of_a_table_made_by_walking_over_tiles() {
    for tile in [[64, 64], [16, 16], [8, 32]] {
        for size in SIZES {
            let page = page(size, tile);
            let table = numbered(size, tile);
            assert_eq!(page.layers.len(), table.len(), "{size:?}");
            for (depth, (layer, rows)) in page.layers.iter().zip(&table).enumerate() {
                assert_eq!(layer.size, [rows[0].len() as u32, rows.len() as u32]);
                let distinct = |numbers: Vec<u32>| numbers.into_iter().collect::<BTreeSet<_>>().len() as u32;
                assert_eq!(layer.base, rows[0][0], "tile base of {size:?}, layer {depth}");
                assert_eq!(layer.pitch, distinct(rows[0].clone()), "tile pitch of {size:?}, layer {depth}");
                assert_eq!(layer.rows, distinct(rows.iter().map(|r| r[0]).collect()));
                for (y, row) in rows.iter().enumerate() {
                    for (x, &number) in row.iter().enumerate() {
                        assert_eq!(page.tile_of(depth as u8, [x as u32, y as u32]), number);
                        let (first, end) = page.texels_of(number);
                        assert!((first[0]..end[0]).contains(&(x as u32)) && (first[1]..end[1]).contains(&(y as u32)));
                        assert_eq!(usize::from(page.layer_of(number)), depth);
                    }
                }
            }
            let last = table.last().and_then(|rows| rows.last()?.last()).copied();
            assert_eq!(Some(page.tiles() - 1), last, "the extra entry of the tile base array");
        }
    }
}

#[test]
fn layers_of_700_by_300_are_as_the_specification_counts_them() {
    let page = page([700, 300], [64, 64]);
    assert_eq!(page.layers.iter().map(|l| l.size).collect::<Vec<_>>(), [[44, 19], [88, 38], [175, 75], [350, 150], [700, 300]]);
    assert_eq!(page.layers.iter().map(|l| l.pitch).collect::<Vec<_>>(), [1, 2, 3, 6, 11]);
}

#[test]
fn erratum_0063_the_tile_pitch_of_a_square_texture_is_2_to_the_d() {
    let page = page([1024, 1024], [64, 64]);
    assert_eq!(page.layers.iter().map(|l| l.pitch).collect::<Vec<_>>(), [1, 2, 4, 8, 16]);
    assert_eq!(page.layers.iter().map(|l| l.base).collect::<Vec<_>>(), [0, 1, 5, 21, 85], "sums of 4^k");
    assert_eq!(page.tiles(), 341);
}

/// Texel of a filter that stands outside, mapped back.
fn inside(index: i64, size: i64, wrap: Wrap) -> i64 {
    if wrap == Wrap::Repeat { index.rem_euclid(size) } else { index.clamp(0, size - 1) }
}

/// The texels that a bilinear filter reads along one axis, from the definition: coordinates wrapped in the finest layer,
/// scaled, and every texel that weighs anything.
fn read(s: f64, finest: u32, layer: u32, shift: u32, wrap: Wrap, centre: TexelCentre) -> BTreeSet<i64> {
    let size = f64::from(finest);
    let placed = match wrap {
        Wrap::Repeat => s.rem_euclid(size),
        Wrap::Clamp => s.clamp(0.0, size),
        Wrap::Mirror => {
            let folded = s.rem_euclid(2.0 * size);
            if folded > size { 2.0 * size - folded } else { folded }
        }
    };
    let x = placed / f64::from(1u32 << shift) - if centre == TexelCentre::Half { 0.5 } else { 0.0 };
    let weight = |i: i64| 1.0 - (x - i as f64).abs();
    let near = x.floor() as i64 - 1..=x.floor() as i64 + 2;
    near.filter(|i| weight(*i) > 0.0).map(|i| inside(i, layer.into(), wrap)).collect()
}

fn wraps() -> impl Strategy<Value = Wrap> {
    prop_oneof![Just(Wrap::Repeat), Just(Wrap::Clamp), Just(Wrap::Mirror)]
}

fn centres() -> impl Strategy<Value = TexelCentre> {
    prop_oneof![Just(TexelCentre::Half), Just(TexelCentre::Integer)]
}

/// Coordinates in steps of 1 / 64, so that single precision is exact; often at borders and corners.
fn coordinate(size: u32) -> impl Strategy<Value = f32> {
    let all = -(2 * size as i32) * 64..3 * size as i32 * 64;
    let border = (-(size as i32) / 4 - 1..size as i32 / 2 + 2, -2i32..3).prop_map(|(tile, off)| 8 * 64 * tile + 32 * off);
    prop_oneof![all, border].prop_map(|steps| steps as f32 / 64.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn figures_5a_and_5b_mark_exactly_the_tiles_whose_texels_the_filter_reads(
        (size, s, t) in (1u32..80, 1u32..80).prop_flat_map(|(w, h)| (Just([w, h]), coordinate(w), coordinate(h))),
        wrap in [wraps(), wraps()], centre in centres(),
    ) {
        let page = page_of(size, wrap, Cut { tile: [8, 8], centre });
        let placed = page.placed([s, t]);
        for (depth, layer) in page.layers.iter().enumerate() {
            let shift = page.dmax() as u32 - depth as u32;
            let axis = |i: usize, c: f32| read(f64::from(c), size[i], layer.size[i], shift, wrap[i], centre);
            let (columns, rows) = (axis(0, s), axis(1, t));
            let tiles: BTreeSet<u32> = columns.iter()
                .flat_map(|x| rows.iter().map(|y| page.tile_of(depth as u8, [*x as u32, *y as u32])))
                .collect();
            let marked = page.marked(depth as u8, placed);
            let distinct: BTreeSet<u32> = marked.iter().copied().collect();
            prop_assert_eq!(distinct.len(), marked.len(), "each once");
            prop_assert_eq!(distinct, tiles, "none missing, none more");
        }
    }

    #[test]
    fn taps_are_the_texels_of_the_filter_and_their_shares(
        (size, s) in (1u32..80).prop_flat_map(|w| (Just(w), coordinate(w))), wrap in wraps(), centre in centres(),
    ) {
        let page = page_of([size, 1], [wrap; 2], Cut { tile: [8, 8], centre });
        for (depth, layer) in page.layers.iter().enumerate() {
            let [tap, _] = page.taps(depth as u8, page.placed([s, 0.0]));
            let expected = read(f64::from(s), size, layer.size[0], page.dmax() as u32 - depth as u32, wrap, centre);
            let used: BTreeSet<i64> = [i64::from(tap.first), i64::from(tap.second)].into();
            prop_assert_eq!(used, expected);
            prop_assert!((0.0..1.0).contains(&tap.fraction));
        }
    }

    #[test]
    fn coordinates_that_are_no_numbers_or_far_away_stay_inside(
        s in any::<f32>(), t in any::<f32>(), wrap in [wraps(), wraps()], centre in centres(),
    ) {
        let page = page_of([37, 50], wrap, Cut { tile: [8, 8], centre });
        let placed = page.placed([s, t]);
        for depth in 0..=page.dmax() {
            let [x, y] = page.taps(depth, placed);
            let size = page.layers[usize::from(depth)].size;
            prop_assert!(x.first.max(x.second) < size[0] && y.first.max(y.second) < size[1]);
            prop_assert!(page.marked(depth, placed).iter().all(|tile| page.layer_of(*tile) == depth));
        }
    }
}

#[test]
fn erratum_5b_the_last_column_and_row_mark_no_tile_of_the_next_row_or_layer() {
    for (wrap, right, below) in [(Wrap::Clamp, None, None), (Wrap::Mirror, None, None), (Wrap::Repeat, Some(0), Some(0))] {
        let page = page_of([128, 128], [wrap; 2], Cut::default());
        let finest = page.layers[1];
        // Beyond the middle of the last texel.
        let placed = page.placed([127.75, 32.5]);
        let own = finest.base + 1;
        let expected: Vec<u32> = std::iter::once(own).chain(right.map(|column: u32| finest.base + column)).collect();
        assert_eq!(page.marked(1, placed).as_slice(), expected, "{wrap:?}");
        let placed = page.placed([32.5, 127.75]);
        let own = finest.base + finest.pitch;
        let expected: Vec<u32> = std::iter::once(own).chain(below.map(|row: u32| finest.base + row)).collect();
        assert_eq!(page.marked(1, placed).as_slice(), expected, "{wrap:?}");
        assert!(page.marked(1, page.placed([127.9, 127.9])).iter().all(|t| *t < page.tiles()), "past the end of the list");
    }
}

#[test]
fn erratum_0104_the_finer_layer_has_twice_the_coordinates_of_the_coarser() {
    let page = page_of([256, 256], [Wrap::Clamp; 2], Cut { tile: [64, 64], centre: TexelCentre::Integer });
    let placed = page.placed([100.0, 60.0]);
    for depth in 0..=page.dmax() {
        let shift = page.dmax() - depth;
        let [x, y] = page.taps(depth, placed);
        assert_eq!((x.first, y.first), (100 >> shift, 60 >> shift), "layer {depth}");
    }
}

#[test]
fn coarse_layers_lie_on_top_of_fine_ones_with_centres_at_halves_and_are_shifted_with_centres_at_integers() {
    for (centre, shift) in [(TexelCentre::Half, 0.0), (TexelCentre::Integer, 1.5)] {
        let page = page_of([256, 256], [Wrap::Clamp; 2], Cut { tile: [64, 64], centre });
        let middle = |depth: u8, s: f32| {
            let [x, _] = page.taps(depth, page.placed([s, 0.0]));
            let texels = f32::from(1u8 << (page.dmax() - depth));
            // Middle of the covered finest texels, weighted, counted from the middle of texel 0.
            (x.first as f32 + x.fraction) * texels + 0.5 * (texels - 1.0)
        };
        assert_eq!(middle(2, 100.25), if centre == TexelCentre::Half { 99.75 } else { 100.25 });
        assert_eq!(middle(0, 100.25) - middle(2, 100.25), shift);
    }
}

#[test]
fn marking_changes_n_to_l_only() {
    let page = page([128, 128], [64, 64]);
    let mut list = TileList::new(page.tiles());
    assert!(list.mark(3) && !list.mark(3));
    assert_eq!(list.acquire(&page).len(), 1);
    assert!(!list.mark(3), "erratum [0100], [0148]: E is not overwritten");
    assert_eq!(list.states()[3], TileState::Exists);
    assert!(list.acquire(&page).is_empty());
    list.mark(2);
    list.forget();
    let letters: String = list.states().iter().map(|s| s.letter()).collect();
    assert_eq!(letters, "NNNEN", "a new viewpoint resets L to N and keeps E");
}

#[test]
fn figure_6_synthesizes_where_all_sources_exist_and_erratum_0127_ends_a_layer_in_front_of_the_next() {
    let page = page([256, 256], [64, 64]);
    // All of the finest layer but one tile, and all above.
    let mut list = TileList::new(page.tiles());
    let missing = page.layers[2].base;
    (0..page.tiles()).filter(|t| *t != missing).for_each(|t| {
        list.mark(t);
    });
    let acquired = list.acquire(&page);
    let how = |tile: u32| acquired.iter().find(|a| a.tile == tile).map(|a| a.how);
    assert_eq!(how(1), Some(How::Loaded), "one of its four sources is missing");
    assert!([0, 2, 3, 4].iter().all(|t| how(*t) == Some(How::Synthesized)));
    assert!((page.layers[2].base + 1..page.tiles()).all(|t| how(t) == Some(How::Loaded)));
    assert_eq!(how(missing), None);
    assert_eq!(acquired.len() as u32, page.tiles() - 1, "each once: the layer ends in front of the next finer one");
    let place = |tile: u32| acquired.iter().position(|a| a.tile == tile);
    assert!(
        acquired
            .iter()
            .filter(|a| a.how == How::Synthesized)
            .all(|a| { page.sources(a.tile).iter().all(|source| place(*source) < place(a.tile)) })
    );
}

#[test]
fn the_sources_of_a_tile_cover_it_and_nothing_else() {
    for size in SIZES {
        let page = page(size, [8, 8]);
        for tile in 0..page.tiles() {
            let depth = page.layer_of(tile);
            let sources: BTreeSet<u32> = page.sources(tile).into_iter().collect();
            if depth == page.dmax() {
                assert!(sources.is_empty());
                continue;
            }
            let finer = page.layers[usize::from(depth) + 1].size;
            let (first, end) = page.texels_of(tile);
            let covered = (first[1]..end[1]).flat_map(|y| (first[0]..end[0]).map(move |x| [2 * x, 2 * y]));
            let all = covered.flat_map(|[x, y]| [[x, y], [(x + 1).min(finer[0] - 1), (y + 1).min(finer[1] - 1)]]);
            assert_eq!(sources, all.map(|texel| page.tile_of(depth + 1, texel)).collect(), "{size:?}, tile {tile}");
        }
    }
}

/// Stores these tiles as they come from the server, in this encoding.
fn load(served: &mut ServedTexture, texels: &mut PageTexels, tile: u32, encoding: TileEncoding) {
    let page = Arc::clone(&texels.page);
    let (first, end) = page.texels_of(tile);
    let size = [end[0] - first[0], end[1] - first[1]];
    let bytes = encoding.encode(&served.tile(&page, tile), size, 90).unwrap();
    texels.store(tile, &encoding.decode(&bytes, size).unwrap(), 1);
}

#[test]
fn a_synthesized_tile_is_the_loaded_one_bit_for_bit() {
    for encoding in [TileEncoding::Raw, TileEncoding::Png] {
        for size in SIZES {
            let texture = texture(size);
            let page = page(size, [16, 8]);
            let mut served = ServedTexture::new(Arc::clone(&texture));
            let mut loaded = PageTexels::new(Arc::clone(&page));
            (0..page.tiles()).for_each(|tile| load(&mut served, &mut loaded, tile, encoding));
            let mut averaged = PageTexels::new(Arc::clone(&page));
            let finest = page.layers[usize::from(page.dmax())].base;
            (finest..page.tiles()).for_each(|tile| load(&mut served, &mut averaged, tile, encoding));
            (0..finest).rev().for_each(|tile| averaged.synthesize(tile, 1));
            let colours = |texels: &PageTexels, depth: u8| {
                texels.layer(depth).texels.iter().map(|t| [t[0], t[1], t[2]]).collect::<Vec<_>>()
            };
            for depth in 0..=page.dmax() {
                assert_eq!(colours(&loaded, depth), colours(&averaged, depth), "{size:?}, layer {depth}");
            }
        }
    }
}

#[test]
fn an_odd_edge_repeats_its_last_texel_and_averages_round_half_up() {
    let levels = vec![Image { width: 3, height: 1, texels: vec![[1, 0, 0, 255], [2, 1, 0, 255], [9, 255, 0, 255]] }];
    let texture = Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0 });
    let page = Arc::new(Page::new(0, &texture, [Wrap::Clamp; 2], Cut { tile: [2, 1], centre: TexelCentre::Half }, 0));
    let top = ServedTexture::new(texture).tile(&page, 0);
    // (1 + 2 + 1 + 2 + 2) >> 2 = 2, (0 + 1 + 0 + 1 + 2) >> 2 = 1; the third texel stands for itself.
    assert_eq!(top.iter().map(|t| [t[0], t[1], t[2]]).collect::<Vec<_>>(), [[2, 1, 0], [9, 255, 0]]);
}

#[test]
fn tiles_that_are_damaged_are_refused() {
    let texels = vec![[1, 2, 3, 255]; 12];
    for encoding in [TileEncoding::Raw, TileEncoding::Png, TileEncoding::Jpeg] {
        let bytes = encoding.encode(&texels, [4, 3], 80).unwrap();
        assert_eq!(encoding.decode(&bytes, [4, 3]).unwrap().len(), 12);
        assert!(encoding.decode(&bytes[..bytes.len() / 2], [4, 3]).is_err(), "{encoding:?}: truncated");
        assert!(encoding.decode(&bytes, [3, 3]).is_err(), "{encoding:?}: another size");
        assert!(encoding.decode(&[], [4, 3]).is_err());
    }
}

#[test]
fn layer_depth_is_dmax_less_log2_of_the_longer_axis() {
    for (rho, depth) in [(1.0, 4.0), (2.0, 3.0), (8.0, 1.0), (0.25, 4.0), (64.0, 0.0), (0.0, 4.0)] {
        assert_eq!(layer_depth(4, rho * rho), depth, "rho {rho}");
    }
    assert_eq!((layer_depth(4, f32::NAN), layer_depth(4, f32::INFINITY)), (4.0, 0.0));
    assert_eq!(
        [split_depth(2.75, 4), split_depth(3.0, 4), split_depth(4.0, 4), split_depth(9.0, 4)],
        [(2, 0.75), (3, 0.0), (4, 0.0), (4, 0.0)]
    );
}

/// Texels of a page of which these layers are there.
fn with_layers(size: [u32; 2], layers: &[u8]) -> PageTexels {
    let page = page(size, [16, 16]);
    let mut served = ServedTexture::new(texture(size));
    let mut texels = PageTexels::new(Arc::clone(&page));
    for tile in (0..page.tiles()).filter(|t| layers.contains(&page.layer_of(*t))) {
        load(&mut served, &mut texels, tile, TileEncoding::Raw);
    }
    texels
}

#[test]
fn embodiment_10_and_20_an_integer_depth_takes_one_interpolation_a_fraction_two_and_one_between() {
    let texels = with_layers([128, 128], &[0, 1, 2, 3]);
    let at = |depth: f32| {
        let cell = Cell::textured(0, [40.3, 71.9], depth, [255; 3]);
        let choice = best(&texels, &cell);
        sample(&texels, &choice, texels.page.placed(cell.coordinates))
    };
    let [one, half, two] = [1.0, 1.5, 2.0].map(at);
    assert_eq!([one, half, two].map(|s| s.read.iter().flatten().count()), [1, 2, 1]);
    for c in 0..3 {
        assert!((half.colour[c] - 0.5 * (one.colour[c] + two.colour[c])).abs() < 1e-4);
    }
    assert_eq!(at(3.0).read[0].map(|r| r.0), Some(3), "D_G beyond Dmax: Dmax alone");
}

#[test]
fn figure_7b_colours_from_the_finest_layer_that_is_there_and_marks_the_next() {
    let choose = |there: &[u8], depth: f32| {
        let texels = with_layers([128, 128], there);
        let cell = Cell::textured(0, [40.3, 71.9], depth, [255; 3]);
        let placed = texels.page.placed(cell.coordinates);
        progressive(&texels, &cell, placed).map(|c| (c.lower, c.upper.map(|u| u.0), c.improve))
    };
    assert_eq!(choose(&[], 1.5), None);
    assert_eq!(choose(&[0], 2.5), Some((0, None, Some(1))));
    assert_eq!(choose(&[0, 1, 2], 2.5), Some((2, None, Some(3))));
    assert_eq!(choose(&[0, 1, 2, 3], 2.5), Some((2, Some(3), None)), "erratum [0151]: D_G and D_L, not D_G - 1 of D_L");
    assert_eq!(choose(&[0, 1, 2], 2.0), Some((2, None, None)), "erratum: with D_f = 0 nothing of D_G is fetched");
    assert_eq!(choose(&[0, 3], 2.5), Some((3, None, Some(2))), "D_G of an earlier view: colour from it, fetch D_L");
    assert_eq!(choose(&[0, 1, 2, 3], 3.0), Some((3, None, None)), "magnified: D_L = D_G = Dmax");
}

#[test]
fn cells_hold_what_their_fields_can() {
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
    assert_eq!(Cell::direct([1, 2, 3]).rgb(), [1, 2, 3]);
    assert!(!Cell::default().is_drawn() && Cell::direct([0; 3]).page().is_none());
}

#[test]
fn the_formula_of_the_cell_reads_brightness_back() {
    let page = page([64, 64], [64, 64]);
    for range in [1.0, 2.0] {
        let format = CellFormat::new(&CellConfig { brightness_bits: 10, ..CellConfig::default() }, range);
        let read = format.brightness(&format.textured(&page, [0.0; 2], 0.0, [0.0, 0.3, 1.0]));
        assert!(read.iter().zip([0.0, 0.3, 1.0]).all(|(a, b)| (a - b).abs() <= range / 2046.0 + 1e-6), "{read:?}");
    }
}
