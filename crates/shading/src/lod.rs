//! Level of detail, and the MIP levels that it selects.

/// MIP levels of the device, 0 (finest) ..= 7 (stated).
pub const LEVELS: usize = 8;

/// Coarsest level of detail (stated: LOD 0..63).
pub const MAX_LOD: u8 = 63;

/// Computes the LOD of a polygon from its areas in texels of level 0 and in pixels, in any common unit: `clamp(round(8 log2 rho),
/// 0, 63)` with rho = square root of their ratio. The LOD is 0 if the ratio is undefined.
#[inline]
pub fn lod(texel_area: f32, pixel_area: f32) -> u8 {
    let ratio = texel_area / pixel_area;
    if ratio.is_finite() && ratio > 0.0 {
        // The square root is half of the logarithm. The conversion clamps below, `min` clamps above.
        ((4.0 * libm::log2f(ratio)).round() as u8).min(MAX_LOD)
    } else {
        0
    }
}

/// MIP levels that a LOD selects, finest first, and their shares of the brightness.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LevelSet {
    /// Levels in use, 1..=8.
    pub count: u8,
    /// Levels, ascending.
    pub level: [u8; LEVELS],
    /// Shares, each > 0. They sum to 1.
    pub weight: [f32; LEVELS],
}

/// Returns the levels for `lod` (0..=63; larger values count as 63) if a sample uses `mode` levels: 1 = nearest, 2 = the two
/// adjacent, n = the n nearest. `levels_of_map` is the number of levels of the normal map. Coarser levels are clamped to its
/// last, and shares of the same level are added.
///
/// Nearest is `min(7, (LOD + 3) / 8)`: a tie goes to the finer level. Otherwise level k weighs `max(0, 1 - |LOD/8 - k| / (n/2))`,
/// normalised. For n = 2 this is the patent's linear interpolation, which pays for one level only if LOD is a multiple of 8 or no
/// coarser level exists. An open interval of width n holds at most n whole numbers, so at most n levels have a weight.
pub fn select_levels(lod: u8, mode: u8, levels_of_map: usize) -> LevelSet {
    let lod = lod.min(MAX_LOD);
    let share: [u32; LEVELS] = if mode <= 1 {
        let nearest = ((usize::from(lod) + 3) / LEVELS).min(LEVELS - 1);
        std::array::from_fn(|k| u32::from(k == nearest))
    } else {
        // The weights times 4n are whole numbers, so nothing is rounded before the last division.
        let reach = 4 * u32::from(mode);
        std::array::from_fn(|k| reach.saturating_sub(u32::from(lod).abs_diff(8 * k as u32)))
    };
    clamp_to_map(&share, levels_of_map.clamp(1, LEVELS) - 1)
}

fn clamp_to_map(share: &[u32; LEVELS], last: usize) -> LevelSet {
    let mut merged = [0; LEVELS];
    for (k, s) in share.iter().enumerate() {
        merged[k.min(last)] += s;
    }
    let total: u32 = share.iter().sum();
    let mut set = LevelSet::default();
    for (k, &s) in merged.iter().enumerate().filter(|(_, s)| **s > 0) {
        let i = usize::from(set.count);
        set.level[i] = k as u8;
        set.weight[i] = s as f32 / total as f32;
        set.count += 1;
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pairs(set: &LevelSet) -> Vec<(u8, f32)> {
        (0..usize::from(set.count)).map(|i| (set.level[i], set.weight[i])).collect()
    }

    #[test]
    fn lod_counts_eighths_of_octaves() {
        assert_eq!(lod(1.0, 1.0), 0);
        assert_eq!(lod(4.0, 1.0), 8);
        assert_eq!(lod(16.0, 1.0), 16);
        assert_eq!(lod(0.25, 1.0), 0);
        assert_eq!(lod(1e30, 1.0), 63);
        assert_eq!(lod(2f32.powf(0.25 * 3.4), 1.0), 3);
        assert_eq!(lod(2f32.powf(0.25 * 3.6), 1.0), 4);
        for (texels, pixels) in [(0.0, 1.0), (1.0, 0.0), (f32::NAN, 1.0), (-1.0, 1.0), (f32::INFINITY, 1.0)] {
            assert_eq!(lod(texels, pixels), 0);
        }
    }

    // Claim: as lod_3_divides_the_difference_of_two_levels_3_to_5.
    #[test]
    fn lod_3_weighs_adjacent_levels_5_to_3() {
        assert_eq!(pairs(&select_levels(3, 2, 8)), [(0, 5.0 / 8.0), (1, 3.0 / 8.0)]);
    }

    #[test]
    fn nearest_tie_selects_finer_level() {
        let nearest = |lod| pairs(&select_levels(lod, 1, 8));
        for (lod, level) in [(0, 0), (4, 0), (5, 1), (12, 1), (13, 2), (56, 7), (63, 7), (255, 7)] {
            assert_eq!(nearest(lod), [(level, 1.0)], "LOD {lod}");
        }
    }

    #[test]
    fn zero_fraction_or_last_level_selects_one_level() {
        for lod in 0..=63 {
            let set = select_levels(lod, 2, 8);
            assert_eq!(set.count == 1, lod % 8 == 0 || lod >= 56, "LOD {lod}");
            assert_eq!(set.level[0], lod / 8);
        }
    }

    #[test]
    fn short_map_is_clamped_to_last_level() {
        assert_eq!(pairs(&select_levels(3, 2, 1)), [(0, 1.0)]);
        assert_eq!(pairs(&select_levels(20, 2, 2)), [(1, 1.0)]);
        assert_eq!(pairs(&select_levels(63, 1, 0)), [(0, 1.0)]);
        assert_eq!(pairs(&select_levels(8, 4, 2)), [(0, 0.25), (1, 0.75)]);
    }

    proptest! {
        #[test]
        fn two_level_weights_are_linear_interpolation(lod in 0u8..=63) {
            let set = select_levels(lod, 2, 8);
            let (k, f) = (lod / 8, f32::from(lod % 8) / 8.0);
            let expected = if f == 0.0 || lod >= 56 { vec![(k, 1.0)] } else { vec![(k, 1.0 - f), (k + 1, f)] };
            prop_assert_eq!(pairs(&set), expected);
        }

        #[test]
        fn level_weights_sum_to_one(lod in 0u8..=63, mode in 0u8.., levels in 0usize..20) {
            let set = select_levels(lod, mode, levels);
            prop_assert!(set.count >= 1 && set.count <= mode.clamp(1, 8));
            let sum: f32 = set.weight.iter().sum();
            prop_assert!((sum - 1.0).abs() < 1e-6);
            prop_assert!(pairs(&set).windows(2).all(|w| w[0].0 < w[1].0));
            prop_assert!(pairs(&set).iter().all(|&(k, w)| w > 0.0 && usize::from(k) < levels.max(1)));
        }

        #[test]
        fn level_weights_fall_with_distance(lod in 0u8..=63, mode in 3u8..=8) {
            let set = select_levels(lod, mode, 8);
            let distance = |k: u8| (f32::from(lod) / 8.0 - f32::from(k)).abs();
            for (a, wa) in pairs(&set) {
                for (b, wb) in pairs(&set) {
                    prop_assert!(distance(a) >= distance(b) || wa > wb);
                }
            }
        }
    }
}
