//! Depth of layers, tile pitch, tile base, tile numbers.

use crate::{SIZES, page, page_of, texture};
use basrelief_deferred_renderer::{PyramidCut, ServedTexture, TexelArea, TexturePage};
use basrelief_signals::WrapMode;
use std::collections::BTreeSet;

/// Returns the sizes of layers from coarsest to finest, by halving until one fits into a tile.
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

// Claim: defer, [0029-0037]: Layers, tile numbers, pitch (138) and base (140) equal a table from a walk over all tiles of square,
// non-square and odd sizes.
#[test]
fn tile_numbers_pitch_and_base_match_walked_table() {
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
                        let TexelArea { first, end } = page.texels_of(number);
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

// Claim: as tile_numbers_pitch_and_base_match_walked_table.
#[test]
fn layers_of_700_by_300_match_specification() {
    let page = page([700, 300], [64, 64]);
    assert_eq!(page.layers.iter().map(|l| l.size).collect::<Vec<_>>(), [[44, 19], [88, 38], [175, 75], [350, 150], [700, 300]]);
    assert_eq!(page.layers.iter().map(|l| l.pitch).collect::<Vec<_>>(), [1, 2, 3, 6, 11]);
}

// Claim: defer, [0063], erratum: The tile pitch of a square texture is 2^D; the tile base is the sum of 4^k.
#[test]
fn erratum_0063_tile_pitch_of_square_texture_is_2_to_d() {
    let page = page([1024, 1024], [64, 64]);
    assert_eq!(page.layers.iter().map(|l| l.pitch).collect::<Vec<_>>(), [1, 2, 4, 8, 16]);
    assert_eq!(page.layers.iter().map(|l| l.base).collect::<Vec<_>>(), [0, 1, 5, 21, 85], "sums of 4^k");
    assert_eq!(page.tiles(), 341);
}

// Claim: defer, depth of layers, [0033]: A cap on Dmax removes the finest layers only. The image equals that of halved textures, in
// every mode.
#[test]
fn dmax_cap_0033_drops_only_the_finest_layers() {
    for (size, cap) in SIZES.into_iter().flat_map(|size| [0, 1, 3, 31].map(|cap| (size, cap))) {
        let all = page(size, [16, 16]);
        let capped = page_of(size, PyramidCut { tile: [16, 16], most_depth: cap, ..PyramidCut::default() });
        assert_eq!(capped.dmax(), all.dmax().min(cap), "{size:?}");
        assert_eq!(capped.left_out, all.dmax() - capped.dmax());
        assert_eq!(capped.texture_size, size);
        let mut served = ServedTexture::new(texture(size));
        for (depth, (layer, kept)) in (0..).zip(all.layers.iter().zip(&capped.layers)) {
            assert_eq!((layer.size, layer.pitch, layer.rows, layer.base), (kept.size, kept.pitch, kept.rows, kept.base));
            for tile in layer.base..layer.base + layer.pitch * layer.rows {
                assert_eq!(served.tile(&all, tile), served.tile(&capped, tile), "{size:?}, cap {cap}, tile {tile}");
            }
            for u in [-1.3, 0.0, 0.372, 0.999, 1.0, 2.45] {
                let placed = |page: &TexturePage| page.placed(page.size().map(|n| u * n), [WrapMode::Repeat; 2]);
                let of_all = all.taps(depth, placed(&all));
                assert_eq!(of_all, capped.taps(depth, placed(&capped)), "{size:?}, layer {depth}, {u}");
            }
        }
        let kept = capped.layers.last().unwrap();
        assert_eq!(capped.tiles(), kept.base + kept.pitch * kept.rows, "the extra entry of the tile base array");
        assert_eq!(capped.cut.finest(size), kept.size);
    }
}
