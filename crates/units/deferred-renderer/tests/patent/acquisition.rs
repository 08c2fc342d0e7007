//! Acquisition of tiles: Figure 6, averaging, encodings.

use crate::{SIZES, page, texture};
use basrelief_deferred_renderer::{
    PageTexels, PyramidCut, ServedTexture, TexelArea, TexturePage, TileEncoding, TileList, TileOrigin,
};
use basrelief_signals::{Image, Sampler, Texture};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::collections::BTreeSet;
use std::sync::Arc;

// Claim: defer, Figure 6; [0127], erratum: From Dmax down, tiles are synthesized if all sources exist, else loaded. A layer ends
// before the next.
#[test]
fn figure_6_synthesizes_from_sources_with_erratum_0127() {
    let page = page([256, 256], [64, 64]);
    // All of the finest layer but one tile, and all above.
    let mut list = TileList::new(page.tiles());
    let missing = page.layers[2].base;
    (0..page.tiles()).filter(|t| *t != missing).for_each(|t| {
        list.mark(t);
    });
    let acquired = list.acquire(&page);
    let how = |tile: u32| acquired.iter().find(|a| a.tile == tile).map(|a| a.how);
    assert_eq!(how(1), Some(TileOrigin::Loaded), "one of its four sources is missing");
    assert!([0, 2, 3, 4].iter().all(|t| how(*t) == Some(TileOrigin::Synthesized)));
    assert!((page.layers[2].base + 1..page.tiles()).all(|t| how(t) == Some(TileOrigin::Loaded)));
    assert_eq!(how(missing), None);
    assert_eq!(acquired.len() as u32, page.tiles() - 1, "each once: the layer ends in front of the next finer one");
    let place = |tile: u32| acquired.iter().position(|a| a.tile == tile);
    assert!(
        acquired
            .iter()
            .filter(|a| a.how == TileOrigin::Synthesized)
            .all(|a| { page.sources(a.tile).iter().all(|source| place(*source) < place(a.tile)) })
    );
}

// Claim: as figure_6_synthesizes_from_sources_with_erratum_0127.
#[test]
fn tile_sources_cover_exactly_the_tile() {
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
            let TexelArea { first, end } = page.texels_of(tile);
            let covered = (first[1]..end[1]).flat_map(|y| (first[0]..end[0]).map(move |x| [2 * x, 2 * y]));
            let all = covered.flat_map(|[x, y]| [[x, y], [(x + 1).min(finer[0] - 1), (y + 1).min(finer[1] - 1)]]);
            assert_eq!(sources, all.map(|texel| page.tile_of(depth + 1, texel)).collect(), "{size:?}, tile {tile}");
        }
    }
}

/// Stores these tiles as received from the server, in this encoding.
pub fn load(served: &mut ServedTexture, texels: &mut PageTexels, tile: u32, encoding: TileEncoding) {
    let page = Arc::clone(&texels.page);
    let size = page.texels_of(tile).size();
    let bytes = encoding.encode(&served.tile(&page, tile), size, 90).unwrap();
    texels.store(tile, &encoding.decode(&bytes, size).unwrap(), 1);
}

// Claim: defer, Figure 6: A synthesized tile is the loaded one, bit for bit (raw and png); odd edges repeat their last texel.
#[test]
fn synthesized_tile_equals_loaded_tile() {
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

// Claim: as synthesized_tile_equals_loaded_tile.
#[test]
fn odd_edge_repeats_texel_and_average_rounds_half_up() {
    let levels = vec![Image { width: 3, height: 1, texels: vec![[1, 0, 0, 255], [2, 1, 0, 255], [9, 255, 0, 255]] }];
    let texture =
        Arc::new(Texture { id: 0, name: String::new(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None });
    let page = Arc::new(TexturePage::new(0, &texture, PyramidCut { tile: [2, 1], ..PyramidCut::default() }, 0));
    let top = ServedTexture::new(texture).tile(&page, 0);
    // (1 + 2 + 1 + 2 + 2) >> 2 = 2, (0 + 1 + 0 + 1 + 2) >> 2 = 1. The third texel is repeated.
    assert_eq!(top.iter().map(|t| [t[0], t[1], t[2]]).collect::<Vec<_>>(), [[2, 1, 0], [9, 255, 0]]);
}

// Claim: as double_rate_halves_the_time_of_a_path_bound_run.
#[test]
fn damaged_tile_is_an_error() {
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
fn tile_metadata_takes_no_memory() {
    let with_profile = |bytes: u32| {
        let mut tile = Vec::new();
        let mut encoder = PngEncoder::new(&mut tile);
        // Noise cannot be compressed, so the decoder meets it at its full length.
        let noise = (0..bytes).map(|n| (n.wrapping_mul(0x9e37_79b9) >> 13) as u8 ^ (n.wrapping_mul(n) >> 7) as u8).collect();
        encoder.set_icc_profile(noise).unwrap();
        encoder.write_image(&[7; 3 * 12], 4, 3, ExtendedColorType::Rgb8).unwrap();
        TileEncoding::Png.decode(&tile, [4, 3])
    };
    assert_eq!(with_profile(3000).unwrap(), [[7, 7, 7, 255]; 12], "a usual profile does no harm");
    assert!(with_profile(1 << 20).is_err());
}
