//! MIP-map selector (320) and claim 9.

use crate::chain::{Walked, bounds, config, spans, textured, walk_on};
use basrelief_kernel::{MemoryPorts, Unit};
use basrelief_signals::{Control, Flow, WrapMode};
use basrelief_texel_value_generator::signals::GradientPacket;
use basrelief_texel_value_generator::{MipConfig, MipMapSelector, MipMode, MipPer};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn levels(mode: MipMode, gradients: &[GradientPacket]) -> Vec<(u16, f32)> {
    let mut unit = MipMapSelector::new(MipConfig { mode, ..MipConfig::default() });
    unit.step(Some(Flow::Control(Control::Polygon(textured(WrapMode::Repeat)))), &mut MemoryPorts::default());
    let mut all = Vec::new();
    for packet in gradients {
        let Some(Flow::Item(levels)) = unit.step(Some(Flow::Item(*packet)), &mut MemoryPorts::default()).out else { panic!() };
        all.extend(packet.packet.positions().map(|i| (packet.packet.x + i as u16, levels.level[i])));
    }
    all
}

proptest! {
    // Claim: texel, 9: The MIP level is constant per segment, follows from its ends, and decides the pixel value.
    #[test]
    fn claim_9_level_is_constant_per_segment(span in spans(), e in bounds()) {
        let walked = walk_on(&config(e), span, &textured(WrapMode::Repeat), Some(MipPer::Segment));
        let levels: BTreeMap<u16, f32> = levels(MipMode::Trilinear, &walked.gradients).into_iter().collect();
        for segment in &walked.segments {
            let [a, b] = [segment.from, segment.to].map(|k| Walked::exact(&span, k));
            let length = f64::from(segment.to - segment.from).max(1.0);
            let texels = (0..2).map(|i| ((b[i] - a[i]) / length).abs() * 64.0).fold(0.0, f64::max);
            let expected = if texels > 1.0 { texels.log2().min(6.0) } else { 0.0 };
            for k in segment.from..segment.from + segment.walk {
                prop_assert!((f64::from(levels[&k]) - expected).abs() < 1e-4, "{k}: {} {expected}", levels[&k]);
            }
        }
    }

    #[test]
    fn level_per_pixel_follows_from_derivative(span in spans(), e in bounds()) {
        let walked = walk_on(&config(e), span, &textured(WrapMode::Repeat), Some(MipPer::Pixel));
        for (texels, packet) in walked.packets.iter().zip(&walked.gradients) {
            // Between division points it is the level of the interpolated u.
            for i in packet.packet.positions().filter(|i| texels.points & 1 << i != 0) {
                let k = packet.packet.x + i as u16;
                let ([_, _, w], [u, _]) = (span.value(k), Walked::exact(&span, k));
                let tiles = 2f64.powi(span.scale[0].into());
                let [ahead, behind] = [tiles * span.step[0] / w, u * span.step[2] / w];
                let got = f64::from(packet.gradient[i][0]);
                // 12 bits of a reciprocal.
                let off = 1e-6 * (ahead.abs() + behind.abs()) + (ahead - behind).abs() / 4096.0 + 1e-30;
                prop_assert!((got - (ahead - behind)).abs() <= off, "{k}: {got} {}", ahead - behind);
            }
        }
        prop_assert_eq!(walked.approximate.state.counters.gradient_reciprocals, u64::from(span.count));
    }
}

#[test]
fn nearest_tie_selects_finer_level_and_off_level_0() {
    let packet = |texels: f32| {
        let mut packet = GradientPacket::default();
        packet.packet.mask = 1;
        packet.gradient[0] = [texels / 64.0, 0.0];
        packet
    };
    let of = |mode, texels: f32| levels(mode, &[packet(texels)])[0].1;
    assert_eq!([2.8, 2.9, 1e6].map(|t| of(MipMode::Nearest, t)), [1.0, 2.0, 6.0]);
    assert_eq!(of(MipMode::Off, 9.0), 0.0);
}
