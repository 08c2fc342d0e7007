//! Section 5: occupancy of a step.

use crate::chain::{config, span, textured, walk, walk_on};
use basrelief_signals::WrapMode;
use basrelief_texel_value_generator::{Method, MipPer, TexelConfig, keeps_bound, largest_displacement};
use proptest::prelude::*;

const UV: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 0.0]];
/// Cycles of a product, and of a sum.
const OPERATION: u64 = 3;

/// Returns the occupancies of the steps behind the control token.
fn kept(config: &TexelConfig, w: [f64; 2]) -> Vec<u64> {
    walk(config, span(200, w, UV)).kept.0.split_off(1)
}

// Claim: texel, timing: A step takes a root, the first of a span also e / abs(dw). The interpolator takes a cycle per pixel, and a
// reciprocal with gradients per pixel. A span without division pays products. A trilinear pixel takes two samples.
#[test]
fn section_5_first_step_takes_division_and_root() {
    for (step_bits, iterations) in [(16, 8), (17, 9), (32, 16)] {
        let rising = kept(&TexelConfig { step_bits, ..config(0.5) }, [0.1, 1.0]);
        assert!(rising.len() > 4, "{rising:?}");
        // Two cycles for the products of the decision, of which the first is also that of the turn.
        assert_eq!(rising[0], 1 + iterations + 2 * OPERATION + iterations);
        assert_eq!(&rising[1..], vec![3 * OPERATION + iterations; rising.len() - 1]);
    }
    let table = kept(&TexelConfig { step_table: 64, step_bits: 16, ..config(0.5) }, [0.1, 1.0]);
    assert_eq!(table[..2], [1 + 8 + 2 * OPERATION + 2, 3 * OPERATION + 2]);
    let fixed = TexelConfig { method: Method::Fixed, interval: 100, ..TexelConfig::default() };
    assert_eq!(kept(&fixed, [0.1, 1.0]), [1; 2]);
}

// Claim: as section_5_first_step_takes_division_and_root.
#[test]
fn section_5_undivided_span_pays_only_its_products() {
    for w in [[0.4, 0.4], [0.4, 0.401], [0.401, 0.4]] {
        for (multipliers, cycles) in [(1, 4), (2, 2), (4, 1)] {
            let config = TexelConfig { multipliers, step_bits: 16, ..config(0.5) };
            assert_eq!(kept(&config, w), [cycles], "{w:?}");
            let walked = walk(&config, span(200, w, UV));
            assert_eq!((walked.counters.step_divisions, walked.counters.roots, walked.counters.free), (0, 0, 1));
        }
    }
    let short = TexelConfig { min_span: 200, ..config(0.5) };
    assert_eq!(kept(&short, [0.1, 1.0]), [1], "step 430: nothing is subdivided, nor decided");
}

proptest! {
    #[test]
    fn section_3_products_decide_like_formula(
        w in prop::array::uniform2(0.001f64..1.0), t in 1u16..4096, e in 0.05f64..4.0,
    ) {
        let (t, [wl, wr]) = (f64::from(t), w);
        let displacement = largest_displacement(wl, wr, t);
        prop_assume!((displacement - e).abs() > 1e-9 * e);
        prop_assert_eq!(keeps_bound(wl, wr, t, e), displacement <= e);
    }
}

// Claim: as section_5_first_step_takes_division_and_root.
#[test]
fn section_5_pixel_gradients_take_a_reciprocal_each() {
    let span = span(200, [0.1, 1.0], UV);
    // Without the control token, which takes one cycle.
    let kept = |config: &TexelConfig, gradients| walk_on(config, span, &textured(WrapMode::Repeat), gradients).kept.1 - 1;
    // Reciprocals of 12 bits take 6 cycles.
    for (gradients, cycles) in [(None, 200), (Some(MipPer::Segment), 200), (Some(MipPer::Pixel), 200 * 6)] {
        assert_eq!(kept(&config(0.5), gradients), cycles, "{gradients:?}");
    }
    let exact = TexelConfig { method: Method::Exact, ..TexelConfig::default() };
    assert_eq!((kept(&exact, None), kept(&exact, Some(MipPer::Segment))), (200, 200 * 6), "no segment has a slope");
}
