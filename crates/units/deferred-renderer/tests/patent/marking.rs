//! Tiles that a pixel needs: Figures 5A and 5B.

use crate::{page, page_of};
use basrelief_deferred_renderer::{PyramidCut, TexelCentre, TileList, TileState};
use basrelief_signals::WrapMode;
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Maps a filter texel outside the texture back into it.
fn inside(index: i64, size: i64, wrap: WrapMode) -> i64 {
    if wrap == WrapMode::Repeat { index.rem_euclid(size) } else { index.clamp(0, size - 1) }
}

/// Returns the texels that a bilinear filter reads along one axis, by definition: coordinates wrapped in the finest layer,
/// scaled, and every texel with a weight.
fn read(s: f64, finest: u32, layer: u32, shift: u32, wrap: WrapMode, centre: TexelCentre) -> BTreeSet<i64> {
    let size = f64::from(finest);
    let placed = match wrap {
        WrapMode::Repeat => s.rem_euclid(size),
        WrapMode::Clamp => s.clamp(0.0, size),
        WrapMode::Mirror => {
            let folded = s.rem_euclid(2.0 * size);
            if folded > size { 2.0 * size - folded } else { folded }
        }
    };
    let x = placed / f64::from(1u32 << shift) - if centre == TexelCentre::Half { 0.5 } else { 0.0 };
    let weight = |i: i64| 1.0 - (x - i as f64).abs();
    let near = x.floor() as i64 - 1..=x.floor() as i64 + 2;
    near.filter(|i| weight(*i) > 0.0).map(|i| inside(i, layer.into(), wrap)).collect()
}

fn wraps() -> impl Strategy<Value = WrapMode> {
    prop_oneof![Just(WrapMode::Repeat), Just(WrapMode::Clamp), Just(WrapMode::Mirror)]
}

fn centres() -> impl Strategy<Value = TexelCentre> {
    prop_oneof![Just(TexelCentre::Half), Just(TexelCentre::Integer)]
}

/// Generates coordinates in steps of 1 / 64, so that single precision is exact, often at borders and corners.
fn coordinate(size: u32) -> impl Strategy<Value = f32> {
    let all = -(2 * size as i32) * 64..3 * size as i32 * 64;
    let border = (-(size as i32) / 4 - 1..size as i32 / 2 + 2, -2i32..3).prop_map(|(tile, off)| 8 * 64 * tile + 32 * off);
    prop_oneof![all, border].prop_map(|steps| steps as f32 / 64.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    // Claim: defer, Figures 5A, 5B: The marked tiles are exactly those of the bilinear filter for every wrap mode, border, corner
    // and texel centre, on random coordinates and whole images.
    #[test]
    fn figures_5a_and_5b_mark_exactly_the_tiles_read(
        (size, s, t) in (1u32..80, 1u32..80).prop_flat_map(|(w, h)| (Just([w, h]), coordinate(w), coordinate(h))),
        wrap in [wraps(), wraps()], centre in centres(),
    ) {
        let page = page_of(size, PyramidCut { tile: [8, 8], centre, ..PyramidCut::default() });
        let placed = page.placed([s, t], wrap);
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

    // Claim: as figures_5a_and_5b_mark_exactly_the_tiles_read.
    #[test]
    fn taps_are_filter_texels_with_shares(
        (size, s) in (1u32..80).prop_flat_map(|w| (Just(w), coordinate(w))), wrap in wraps(), centre in centres(),
    ) {
        let page = page_of([size, 1], PyramidCut { tile: [8, 8], centre, ..PyramidCut::default() });
        for (depth, layer) in page.layers.iter().enumerate() {
            let [tap, _] = page.taps(depth as u8, page.placed([s, 0.0], [wrap; 2]));
            let expected = read(f64::from(s), size, layer.size[0], page.dmax() as u32 - depth as u32, wrap, centre);
            let used: BTreeSet<i64> = [i64::from(tap.first), i64::from(tap.second)].into();
            prop_assert_eq!(used, expected);
            prop_assert!((0.0..1.0).contains(&tap.fraction));
        }
    }

    // Claim: as figures_5a_and_5b_mark_exactly_the_tiles_read.
    #[test]
    fn nan_and_huge_coordinates_stay_inside(
        s in any::<f32>(), t in any::<f32>(), wrap in [wraps(), wraps()], centre in centres(),
    ) {
        let page = page_of([37, 50], PyramidCut { tile: [8, 8], centre, ..PyramidCut::default() });
        let placed = page.placed([s, t], wrap);
        for depth in 0..=page.dmax() {
            let [x, y] = page.taps(depth, placed);
            let size = page.layers[usize::from(depth)].size;
            prop_assert!(x.first.max(x.second) < size[0] && y.first.max(y.second) < size[1]);
            prop_assert!(page.marked(depth, placed).iter().all(|tile| page.layer_of(*tile) == depth));
        }
    }
}

// Claim: defer, Figure 5B, erratum: The last column and row mark no tile of the next row or layer.
#[test]
fn erratum_5b_last_column_and_row_mark_no_next_tile() {
    for (wrap, right, below) in
        [(WrapMode::Clamp, None, None), (WrapMode::Mirror, None, None), (WrapMode::Repeat, Some(0), Some(0))]
    {
        let page = page_of([128, 128], PyramidCut::default());
        let finest = page.layers[1];
        // Beyond the middle of the last texel.
        let placed = page.placed([127.75, 32.5], [wrap; 2]);
        let own = finest.base + 1;
        let expected: Vec<u32> = std::iter::once(own).chain(right.map(|column: u32| finest.base + column)).collect();
        assert_eq!(page.marked(1, placed).as_slice(), expected, "{wrap:?}");
        let placed = page.placed([32.5, 127.75], [wrap; 2]);
        let own = finest.base + finest.pitch;
        let expected: Vec<u32> = std::iter::once(own).chain(below.map(|row: u32| finest.base + row)).collect();
        assert_eq!(page.marked(1, placed).as_slice(), expected, "{wrap:?}");
        assert!(
            page.marked(1, page.placed([127.9, 127.9], [wrap; 2])).iter().all(|t| *t < page.tiles()),
            "past the end of the list"
        );
    }
}

// Claim: defer, [0104], erratum: (S,T) of the finer layer is twice that of the coarser.
#[test]
fn erratum_0104_finer_layer_doubles_coordinates() {
    let page = page_of([256, 256], PyramidCut { tile: [64, 64], centre: TexelCentre::Integer, ..PyramidCut::default() });
    let placed = page.placed([100.0, 60.0], [WrapMode::Clamp; 2]);
    for depth in 0..=page.dmax() {
        let shift = page.dmax() - depth;
        let [x, y] = page.taps(depth, placed);
        assert_eq!((x.first, y.first), (100 >> shift, 60 >> shift), "layer {depth}");
    }
}

// Claim: defer, texel centres: With centres at halves, layers coincide; at integers, coarse layers shift.
#[test]
fn half_centres_align_layers_integer_centres_shift_them() {
    for (centre, shift) in [(TexelCentre::Half, 0.0), (TexelCentre::Integer, 1.5)] {
        let page = page_of([256, 256], PyramidCut { tile: [64, 64], centre, ..PyramidCut::default() });
        let middle = |depth: u8, s: f32| {
            let [x, _] = page.taps(depth, page.placed([s, 0.0], [WrapMode::Clamp; 2]));
            let texels = f32::from(1u8 << (page.dmax() - depth));
            // Middle of the covered finest texels, weighted, counted from the middle of texel 0.
            (x.first as f32 + x.fraction) * texels + 0.5 * (texels - 1.0)
        };
        assert_eq!(middle(2, 100.25), if centre == TexelCentre::Half { 99.75 } else { 100.25 });
        assert_eq!(middle(0, 100.25) - middle(2, 100.25), shift);
    }
}

// Claim: defer, [0100], [0148], errata: Marking changes N to L only; a new viewpoint resets L to N.
#[test]
fn marking_only_changes_n_to_l() {
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
