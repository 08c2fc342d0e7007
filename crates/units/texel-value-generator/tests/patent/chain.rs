//! Runs spans through step calculator, dividers and approximate calculator (310a). Generates random spans.

use basrelief_kernel::{Demand, MemoryPorts, OperatorConfig, Operators, Unit};
use basrelief_signals::{Control, Flow, Image, Material, Polygon, Sampler, Texture, Vertex, WrapMode};
use basrelief_texel_value_generator::signals::{GradientPacket, LineSegment, ScanSpan, TexelPacket, scale_of};
use basrelief_texel_value_generator::{
    ApproximateCalculator, ApproximationConfig, Divider, DividerConfig, MipPer, StepCalculator, StepCalculatorCounters,
    TexelConfig,
};
use proptest::prelude::*;
use std::sync::Arc;

/// Returns operators of 1994.
pub fn operators() -> Operators {
    let (multiply, add) = (OperatorConfig::new(3, 1), OperatorConfig::new(3, 1));
    Operators { multiply, add, divide: OperatorConfig::new(16, 16), ..Operators::default() }
}

/// Creates a span of pixels 0 .. count, with these W, u, v at its ends.
pub fn span(count: u16, w: [f64; 2], uv: [[f64; 2]; 2]) -> ScanSpan {
    let scale = [0, 1].map(|i| scale_of(uv[0][i].abs().max(uv[1][i].abs())));
    let scaled = |i: usize, k: usize| uv[i][k] * w[i] / 2f64.powi(scale[k].into());
    let ends = [0, 1].map(|i| [scaled(i, 0), scaled(i, 1), w[i]]);
    let per_pixel = if count > 1 { 1.0 / f64::from(count - 1) } else { 0.0 };
    let step = std::array::from_fn(|i| (ends[1][i] - ends[0][i]) * per_pixel);
    ScanSpan { y: 3, x: 0, count, textured: true, scale, ends, step, ..ScanSpan::default() }
}

/// Results of a span.
pub struct Walked {
    pub segments: Vec<LineSegment>,
    pub packets: Vec<TexelPacket>,
    pub gradients: Vec<GradientPacket>,
    pub counters: StepCalculatorCounters,
    pub divider: Divider,
    pub approximate: ApproximateCalculator,
    /// Occupancy of the step calculator per step, and total occupancy of the approximate calculator \[cycles\].
    pub kept: (Vec<u64>, u64),
}

impl Walked {
    /// Returns the pixels at which u, v are divided: the ends of all segments.
    pub fn points(&self) -> Vec<u16> {
        let mut all: Vec<u16> = self.segments.iter().flat_map(|s| [s.from, s.to]).collect();
        all.dedup();
        all
    }

    /// Returns the exact u, v of pixel `k` of the span.
    pub fn exact(span: &ScanSpan, k: u16) -> [f64; 2] {
        let value = span.value(k);
        [0, 1].map(|i| value[i] / value[2] * 2f64.powi(span.scale[i].into()))
    }

    /// Returns u, v by column, minus some whole tiles.
    pub fn uv(&self) -> Vec<[f32; 2]> {
        self.packets.iter().flat_map(|s| s.packet.positions().map(|i| s.uv[i])).collect()
    }

    pub fn largest_displacement(&self) -> f64 {
        self.approximate.state.counters.displacements.largest
    }
}

/// Creates a polygon with a texture of these wrap modes, for the values that are constant over it.
pub fn textured(wrap: WrapMode) -> Arc<Polygon> {
    let side = |side: u32| Image { width: side, height: side, texels: vec![[200; 4]; (side * side) as usize] };
    let levels = [64, 32, 16, 8, 4, 2, 1].map(side).to_vec();
    let sampler = Sampler { wrap: [wrap; 2], ..Sampler::default() };
    let texture = Texture { id: 0, name: String::new(), sampler, levels, offset: 0, elsewhere: None };
    let material = Arc::new(Material { color_texture: Some(Arc::new(texture)), ..Material::default() });
    let vertices = vec![Vertex::default(); 3];
    Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 })
}

/// Runs a span through the three units.
pub fn walk(config: &TexelConfig, span: ScanSpan) -> Walked {
    walk_on(config, span, &textured(WrapMode::Repeat), Some(MipPer::Segment))
}

pub fn walk_on(config: &TexelConfig, span: ScanSpan, polygon: &Arc<Polygon>, gradients: Option<MipPer>) -> Walked {
    let mut steps = StepCalculator::new(config.clone(), 2, operators());
    let mut divider = Divider::new(DividerConfig::default(), config.coordinate_bits, operators());
    let mut approximate = ApproximateCalculator::new(ApproximationConfig::default(), config, [2, 24], gradients, operators());
    let (mut segments, mut packets, mut out_gradients) = (Vec::new(), Vec::new(), Vec::new());
    let (mut none, mut kept) = (MemoryPorts::default(), (Vec::new(), 0));
    for token in [Flow::Control(Control::Polygon(Arc::clone(polygon))), Flow::Item(span)] {
        let mut input = Some(token);
        while input.is_some() || steps.demand() == Demand::Nothing {
            let step = steps.step(input.take(), &mut none);
            kept.0.push(step.occupancy);
            let (segment, points) = step.out;
            segments.extend(segment.iter().filter_map(|s| if let Flow::Item(s) = s { Some(*s) } else { None }));
            let quotients = divider.step(points, &mut none).out;
            let mut pair = Some((segment, quotients));
            while pair.is_some() || approximate.demand() == Demand::Nothing {
                let step = approximate.step(pair.take().unwrap_or((None, None)), &mut none);
                kept.1 += step.occupancy;
                let (packet, gradient) = step.out;
                packets.extend(packet.into_iter().filter_map(|s| if let Flow::Item(s) = s { Some(s) } else { None }));
                out_gradients.extend(gradient.into_iter().filter_map(|s| if let Flow::Item(s) = s { Some(s) } else { None }));
            }
        }
    }
    assert!(steps.is_empty() && approximate.is_empty());
    Walked { segments, packets, gradients: out_gradients, counters: steps.state.counters, divider, approximate, kept }
}

/// Generates W at the ends in a ratio of up to 1:1000, in both directions, of every size, and sometimes equal.
fn ends() -> impl Strategy<Value = [f64; 2]> {
    let ratio = prop_oneof![1 => Just(0.0), 6 => -3.0f64..3.0, 2 => -0.1f64..0.1];
    (-6.0f64..6.0, ratio).prop_map(|(size, ratio)| {
        let w = power_of_ten(size);
        if ratio < 0.0 { [w, w / power_of_ten(ratio)].map(f64::abs) } else { [w * power_of_ten(ratio), w] }
    })
}

/// Computes 10^x, for tests only.
fn power_of_ten(x: f64) -> f64 {
    10f64.powf(x)
}

/// Generates spans of 1 to 4,096 pixels, with u and v up to a thousand tiles long and away.
pub fn spans() -> impl Strategy<Value = ScanSpan> {
    let count = prop_oneof![4 => 1u16..64, 3 => 64u16..512, 2 => 512u16..=4096, 1 => Just(4096u16)];
    let uv = prop::array::uniform2(prop::array::uniform2(-1000.0f64..1000.0));
    (count, ends(), uv, any::<bool>()).prop_map(|(count, w, uv, near)| {
        // A thousand tiles, or a few.
        span(count, w, if near { uv.map(|p| p.map(|c| c / 500.0)) } else { uv })
    })
}

/// Generates e from 0.05 to 4.
pub fn bounds() -> impl Strategy<Value = f64> {
    prop_oneof![3 => 0.05f64..4.0, 1 => Just(0.5), 1 => 0.05f64..0.2]
}

/// Largest width of u, v.
const COORDINATE_BITS: u32 = 44;

/// Returns a configuration with segments of any length, and u, v of the most bits.
pub fn config(error_bound: f64) -> TexelConfig {
    TexelConfig {
        error_bound,
        longest_segment: 16_384,
        coordinate_bits: COORDINATE_BITS,
        step_bits: 32,
        ..TexelConfig::default()
    }
}

/// Returns the displacement of a pixel of the span by the width of u, v alone \[pixels\]. U, W, their quotient and the
/// interpolated values are rounded: together less than four units. They count more for a slower coordinate. It is slowest at the
/// end with the larger W: `|du| / length * small W / large W` per pixel.
pub fn rounding(span: &ScanSpan) -> f64 {
    let (a, b) = (span.ends[0], span.ends[1]);
    let change = [0, 1].map(|i| (b[i] / b[2] - a[i] / a[2]).abs()).into_iter().filter(|change| *change > 0.0);
    let slowest = change.reduce(f64::min).unwrap_or(0.0) / f64::from(span.last().max(1)) * a[2].min(b[2]) / a[2].max(b[2]);
    let unit = 0.5f64.powi(COORDINATE_BITS as i32 - 1);
    if slowest == 0.0 { 0.0 } else { 4.0 * unit / slowest }
}
