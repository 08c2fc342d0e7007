//! Every unit keeps the unit contract.

use crate::chain::{operators, textured};
use crate::figures::{frame, polygon};
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_kernel_conformance::unit_contract;
use basrelief_signals::{Control, Flow, ObjectInfo, Polygon, WrapMode};
use basrelief_texel_value_generator::signals::{
    DivisionPoints, GradientPacket, IlluminancePacket, LevelPacket, LineSegment, LitSpan, Quotients, ScanSpan, TexelPacket,
    TexturePacket,
};
use basrelief_texel_value_generator::*;
use std::sync::Arc;

/// Returns two frames of polygons, with and without texture, some without spans.
fn display_list() -> Vec<Control> {
    let object = ObjectInfo { name: "o".into(), ..ObjectInfo::default() };
    let plain = Polygon { material: Arc::default(), ..Polygon::clone(&textured(WrapMode::Repeat)) };
    let Control::Polygon(shape) = polygon(&[[30.0, 2.0, 1.0], [50.0, 9.0, 1.0], [33.0, 20.0, 1.0]]) else { unreachable!() };
    let plain = Control::Polygon(Arc::new(Polygon { vertices: shape.vertices.clone(), ..plain }));
    let one = [
        frame(64, 64),
        Control::Criterion(0.25),
        Control::Object(Arc::new(object)),
        polygon(&[[1.3, 1.1, 1.0], [60.6, 2.2, 0.1], [14.9, 29.7, 0.3]]),
        plain,
        polygon(&[[3.1, 3.1, 1.0], [3.2, 3.1, 1.0], [3.2, 3.2, 1.0]]),
        polygon(&[[2.0, 2.0, 1.0], [39.0, 19.0, 0.5], [2.0, 19.0, 0.5], [39.0, 2.0, 1.0]]),
        Control::FrameEnd,
    ];
    [one.clone(), one].concat()
}

/// Steps a unit of one input and two outputs until its input is empty.
fn fork<I, A, B>(unit: &mut impl Unit<In = Option<I>, Out = (Option<A>, Option<B>)>, tokens: Vec<I>) -> (Vec<A>, Vec<B>) {
    let (mut first, mut second, mut tokens) = (Vec::new(), Vec::new(), tokens.into_iter());
    loop {
        let input = if unit.demand() == Demand::All { tokens.next() } else { None };
        if input.is_none() && unit.demand() == Demand::All {
            return (first, second);
        }
        let (a, b) = unit.step(input, &mut MemoryPorts::default()).out;
        first.extend(a);
        second.extend(b);
    }
}

/// Steps a unit of one input and one output until its input is empty.
fn chain<I, A>(unit: &mut impl Unit<In = Option<I>, Out = Option<A>>, tokens: Vec<I>) -> Vec<A> {
    let (mut out, mut tokens) = (Vec::new(), tokens.into_iter());
    loop {
        let input = if unit.demand() == Demand::All { tokens.next() } else { None };
        if input.is_none() && unit.demand() == Demand::All {
            return out;
        }
        out.extend(unit.step(input, &mut MemoryPorts::default()).out);
    }
}

struct Wires {
    spans: Vec<Flow<ScanSpan>>,
    lit_spans: Vec<Flow<LitSpan>>,
    segments: Vec<Flow<LineSegment>>,
    points: Vec<Flow<DivisionPoints>>,
    quotients: Vec<Flow<Quotients>>,
    texels: Vec<Flow<TexelPacket>>,
    gradients: Vec<Flow<GradientPacket>>,
    levels: Vec<Flow<LevelPacket>>,
    texture_values: Vec<Flow<TexturePacket>>,
    illuminances: Vec<Flow<IlluminancePacket>>,
}

fn texel(method: Method) -> TexelConfig {
    TexelConfig { method, interval: 7, ..TexelConfig::default() }
}

fn approximate(method: Method) -> ApproximateCalculator {
    ApproximateCalculator::new(ApproximationConfig::default(), &texel(method), [2, 24], Some(MipPer::Segment), operators())
}

fn steps(method: Method) -> StepCalculator {
    StepCalculator::new(texel(method), 2, operators())
}

fn divider() -> Divider {
    Divider::new(DividerConfig::default(), 32, operators())
}

fn selector() -> MipMapSelector {
    MipMapSelector::new(MipConfig { mode: MipMode::Trilinear, ..MipConfig::default() })
}

fn look_up() -> TextureLookUpTable {
    TextureLookUpTable::new(LookUpConfig::default(), true, 64)
}

fn blend() -> Combiner {
    Combiner::new(
        CombinerConfig { mode: CombineMode::Blend, ..CombinerConfig::default() },
        4,
        PixelValueBuffer { buffers: 2, pixel_bytes: 4, flags: 5, per_cycle: 2 },
        operators(),
    )
}

fn wires(method: Method) -> Wires {
    let (spans, lit_spans) = fork(&mut ScanConverter::default(), display_list());
    let (segments, points) = fork(&mut steps(method), spans.clone());
    let quotients = chain(&mut divider(), points.clone());
    let mut unit = approximate(method);
    let mut pairs = segments.clone().into_iter().zip(quotients.clone());
    let (mut texels, mut gradients) = (Vec::new(), Vec::new());
    loop {
        let pair = if unit.demand() == Demand::All { pairs.next() } else { None };
        if pair.is_none() && unit.demand() == Demand::All {
            break;
        }
        let (a, b) = unit.step(pair.map_or((None, None), |(a, b)| (Some(a), Some(b))), &mut MemoryPorts::default()).out;
        texels.extend(a);
        gradients.extend(b);
    }
    let levels = chain(&mut selector(), gradients.clone());
    let mut unit = look_up();
    let pairs = texels.clone().into_iter().zip(levels.clone());
    let step = |(a, b)| unit.step((Some(a), Some(b)), &mut MemoryPorts::default()).out;
    let texture_values = pairs.filter_map(step).collect();
    let illuminances = chain(&mut IlluminanceValueGenerator::default(), lit_spans.clone());
    Wires { spans, lit_spans, segments, points, quotients, texels, gradients, levels, texture_values, illuminances }
}

#[test]
fn contract_tokens_have_attributions() {
    for method in [Method::Adaptive, Method::Exact, Method::Subpolygon] {
        let wires = wires(method);
        assert!(wires.segments.len() > 100 && wires.texels.len() > 100, "{method:?}");
        assert_eq!((wires.segments.len(), wires.texels.len()), (wires.quotients.len(), wires.levels.len()));
        assert_eq!(wires.texture_values.len(), wires.illuminances.len());
        for (a, b) in wires.texture_values.iter().zip(&wires.illuminances) {
            if let (Flow::Item(a), Flow::Item(b)) = (a, b) {
                assert_eq!(a.packet, b.packet, "nothing is hidden here: both ways cut alike");
            }
        }
    }
}

#[test]
fn mismatched_inputs_are_a_fault() {
    let mut traffic = MemoryPorts::default();
    look_up().step((Some(Flow::Control(Control::FrameEnd)), Some(Flow::Item(LevelPacket::default()))), &mut traffic);
    assert!(format!("{traffic:?}").contains("texture look-up table: its two inputs"));
    let mut traffic = MemoryPorts::default();
    blend().step((Some(Flow::Control(Control::FrameEnd)), Some(Flow::Control(frame(8, 8)))), &mut traffic);
    assert!(format!("{traffic:?}").contains("combiner: its two inputs"));
}

#[test]
fn filter_begins_with_its_texels() {
    let mut texels = TexelPacket::default();
    texels.packet.mask = 1;
    let input = (Some(Flow::Item(texels)), Some(Flow::Item(LevelPacket::default())));
    let step = look_up().step(input, &mut MemoryPorts::default());
    assert_eq!((step.after_data, step.latency), (4, 6), "addressing takes the other two cycles");
}

unit_contract! {
    name: scan_converter,
    unit: ScanConverter::default(),
    inputs: display_list(),
    state,
}

unit_contract! {
    name: step_calculator,
    unit: steps(Method::Adaptive),
    inputs: wires(Method::Adaptive).spans,
    state,
}

unit_contract! {
    name: step_calculator_of_child_polygons,
    unit: steps(Method::Subpolygon),
    inputs: wires(Method::Adaptive).spans,
    state,
}

unit_contract! {
    name: divider,
    unit: divider(),
    inputs: wires(Method::Adaptive).points,
    state,
}

unit_contract! {
    name: approximate_calculator,
    unit: approximate(Method::Adaptive),
    inputs: { let w = wires(Method::Adaptive); (w.segments, w.quotients) },
    state,
}

unit_contract! {
    name: approximate_calculator_of_exact_pixels,
    unit: approximate(Method::Exact),
    inputs: { let w = wires(Method::Exact); (w.segments, w.quotients) },
    state,
}

unit_contract! {
    name: mip_map_selector,
    unit: selector(),
    inputs: wires(Method::Adaptive).gradients,
    state,
}

unit_contract! {
    name: texture_look_up_table,
    unit: look_up(),
    inputs: { let w = wires(Method::Adaptive); (w.texels, w.levels) },
    clients: [ClientKind::Cache { line_bytes: 64 }],
    state,
}

unit_contract! {
    name: illuminance_value_generator,
    unit: IlluminanceValueGenerator::default(),
    inputs: wires(Method::Adaptive).lit_spans,
    state,
}

unit_contract! {
    name: combiner,
    unit: blend(),
    inputs: { let w = wires(Method::Adaptive); (w.texture_values, w.illuminances) },
    clients: [ClientKind::Port],
    state,
}
