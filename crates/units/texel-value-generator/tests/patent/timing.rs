//! Section 5: how long a step keeps its unit.

use crate::chain::{config, span, textured, walk, walk_on};
use basrelief_signals::Wrap;
use basrelief_texel_value_generator::{Method, MipPer, TexelConfig};

const UV: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 0.0]];

#[test]
fn section_5_a_step_takes_a_root_and_the_first_of_a_span_the_division_of_e_by_dw_too() {
    // Behind the control token.
    let kept = |config: &TexelConfig, w| walk(config, span(200, w, UV)).kept.0.split_off(1);
    let rising = kept(&config(0.5), [0.1, 1.0]);
    assert!(rising.len() > 4, "{rising:?}");
    assert_eq!((rising[0], &rising[1..]), (16 + 12, &vec![12; rising.len() - 1][..]));
    let other = TexelConfig { division_cycles: 5, step_table: 64, ..config(0.5) };
    assert_eq!(kept(&other, [0.1, 1.0])[..2], [5 + 2, 2]);
    assert_eq!(kept(&config(0.5), [0.4, 0.4]), [1], "w is constant: neither is needed");
    assert_eq!(kept(&TexelConfig { min_span: 200, ..config(0.5) }, [0.1, 1.0]), [1], "step 430: nothing is subdivided");
    let fixed = TexelConfig { method: Method::Fixed, interval: 100, ..TexelConfig::default() };
    assert_eq!(kept(&fixed, [0.1, 1.0]), [1; 2]);
}

#[test]
fn section_5_the_interpolator_takes_a_pixel_per_cycle_and_a_reciprocal_for_each_where_gradients_are_per_pixel() {
    let span = span(200, [0.1, 1.0], UV);
    // Behind the control token, which takes one.
    let kept = |config: &TexelConfig, gradients| walk_on(config, span, &textured(Wrap::Repeat), gradients).kept.1 - 1;
    for (gradients, cycles) in [(None, 200), (Some(MipPer::Segment), 200), (Some(MipPer::Pixel), 200 * 16)] {
        assert_eq!(kept(&config(0.5), gradients), cycles, "{gradients:?}");
    }
    let exact = TexelConfig { method: Method::Exact, ..TexelConfig::default() };
    assert_eq!((kept(&exact, None), kept(&exact, Some(MipPer::Segment))), (200, 200 * 16), "no segment has a slope");
}
