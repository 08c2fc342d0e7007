//! Every unit keeps the unit contract. Also tests the adder's faults.

use crate::chain::{Config, feed, frame, operators, polygon, sun};
use basrelief_figure_shading::{
    Adder, BrightnessInterpolation, CircuitConfig, FigureFlow, FinishedPolygon, Gate, HostConfig, HostInterface,
    InterpolationConfig, Microcomputer, NormalInterpolationConfig, NormalLoad, PowerMethod, RegisterBank, RegisterOrder,
    Selector28, Selector53, ShadedDot, ShadingMode, SpecularDot, SpecularFlow, SpecularSkip,
};
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_kernel_conformance::unit_contract;
use basrelief_signals::{Control, Flow, Lighting, ObjectInfo, Pixel, Stamp};
use glam::Vec3;
use std::sync::Arc;

/// Returns two frames of polygons for every route, and degenerate ones.
fn display_list() -> Vec<Control> {
    let shiny = Lighting { n: 30.0, ..Lighting::default() };
    let triangle = [[1.0, 2.0], [14.0, 3.0], [5.0, 12.0]];
    let curved = [Vec3::Z, Vec3::new(0.2, 0.0, 1.0).normalize(), Vec3::new(0.0, -0.3, 1.0).normalize()];
    let dark = curved.map(|n| Vec3::new(n.z, n.y, -n.x));
    let object = Control::Object(Arc::new(ObjectInfo { ..ObjectInfo::default() }));
    let frame = [
        frame(vec![sun(Vec3::new(0.1, 0.2, 1.0)), sun(Vec3::Z)]),
        object,
        polygon(&triangle, &curved, shiny),
        polygon(&triangle, &[Vec3::Z; 3], shiny),
        polygon(&[[3.0, 3.0], [9.0, 3.0], [9.0, 8.0], [3.0, 8.0]], &[Vec3::Z; 4], shiny),
        polygon(&[[1.0, 1.0], [5.0, 5.0], [9.0, 9.0]], &curved, shiny),
        polygon(&triangle, &dark, Lighting { n: 31.5, ..shiny }),
        polygon(&[[1.0, 1.0], [1.0, 1.0], [9.0, 9.0]], &[Vec3::Z; 3], shiny),
        polygon(&[[0.0, 0.0], [9.0, 9.0], [0.0, 9.0], [9.0, 0.0]], &[curved[0], curved[1], curved[2], curved[0]], shiny),
        Control::FrameEnd,
    ];
    [frame.clone(), frame].concat()
}

fn config(mode: ShadingMode) -> Config {
    let mut config = Config::default();
    config.shading.mode = mode;
    config.shading.specular_skip = SpecularSkip::Gate;
    config
}

/// Tokens of the microcomputer and the circuits on each wire.
struct Wires {
    figures: Vec<RegisterOrder>,
    selections: Vec<FigureFlow>,
    normals: Vec<Arc<NormalLoad>>,
    flat_dots: Vec<FigureFlow>,
    constant_dots: Vec<FigureFlow>,
    interpolated: Vec<FigureFlow>,
    brightness_dots: Vec<FigureFlow>,
    highlights: Vec<SpecularFlow>,
    gated: Vec<SpecularFlow>,
    sums: Vec<FigureFlow>,
}

/// Steps a unit of two inputs until both are empty.
fn join<A, B, T>(unit: &mut impl Unit<In = (Option<A>, Option<B>), Out = Option<T>>, a: Vec<A>, b: Vec<B>) -> Vec<T> {
    let (mut a, mut b, mut out) = (a.into_iter(), b.into_iter(), Vec::new());
    loop {
        let demand = unit.demand();
        let first = if demand.takes(0) { a.next() } else { None };
        let second = if demand.takes(1) { b.next() } else { None };
        if first.is_none() && second.is_none() {
            return out;
        }
        out.extend(unit.step((first, second), &mut MemoryPorts::default()).out);
    }
}

fn wires(mode: ShadingMode) -> Wires {
    let config = config(mode);
    let (mut figures, mut normals, mut flat_dots, mut constant_dots) = (vec![], vec![], vec![], vec![]);
    for (figure, load, flat, constant) in feed(&mut config.microcomputer(), display_list()) {
        figures.extend(figure);
        normals.extend(load);
        flat_dots.extend(flat);
        constant_dots.extend(constant);
    }
    let selections: Vec<FigureFlow> = feed(&mut RegisterBank::default(), figures.clone()).into_iter().flatten().collect();
    let linear = feed(&mut BrightnessInterpolation::new(InterpolationConfig::default(), operators()), selections.clone());
    let (interpolated, brightness_dots): (Vec<_>, Vec<_>) = linear.into_iter().unzip();
    let [interpolated, brightness_dots] = [interpolated, brightness_dots].map(|wire| wire.into_iter().flatten().collect());
    let highlights: Vec<_> = feed(&mut config.circuit_50(), normals.clone()).into_iter().flatten().collect();
    let gated: Vec<_> = feed(&mut Gate::default(), highlights.clone()).into_iter().flatten().collect();
    let interpolated: Vec<FigureFlow> = interpolated;
    let sums = join(&mut Adder::default(), interpolated.clone(), gated.clone());
    Wires { figures, selections, normals, flat_dots, constant_dots, interpolated, brightness_dots, highlights, gated, sums }
}

fn selected(mode: ShadingMode) -> Vec<FigureFlow> {
    let wires = wires(mode);
    join(&mut Selector53::default(), wires.sums, wires.flat_dots)
}

#[test]
fn contract_tokens_have_attributions() {
    let normal = wires(ShadingMode::Normal);
    let open = normal.highlights.iter().filter(|h| matches!(h, SpecularFlow::Start { open: true })).count();
    let closed = normal.highlights.iter().filter(|h| matches!(h, SpecularFlow::Start { open: false })).count();
    assert!(open > 0 && closed > 0 && normal.flat_dots.len() > 20 && normal.gated.len() > 20);
    assert!(wires(ShadingMode::Brightness).brightness_dots.len() > 20 && wires(ShadingMode::Polyhedron).constant_dots.len() > 20);
}

/// The microcomputer with its four outputs on one wire, because the contract supports at most two.
#[derive(Clone)]
struct OneWire(Microcomputer);

impl Unit for OneWire {
    type In = Option<Control>;
    type Out = Option<<Microcomputer as Unit>::Out>;

    fn demand(&self) -> Demand {
        self.0.demand()
    }

    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        self.0.step(input, traffic).map(|out| {
            let is_something = out.0.is_some() || out.1.is_some() || out.2.is_some() || out.3.is_some();
            is_something.then_some(out)
        })
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn largest_step(&self, client: usize) -> u32 {
        self.0.largest_step(client)
    }
}

/// Selector (28) with two of its three inputs connected, as a mode uses them.
#[derive(Clone)]
struct TwoWays {
    unit: Selector28,
    second: usize,
}

impl Unit for TwoWays {
    type In = (Option<FigureFlow>, Option<FigureFlow>);
    type Out = (Option<Flow<Stamp<Pixel>>>, Option<FinishedPolygon>);

    fn demand(&self) -> Demand {
        if self.unit.demand() == Demand::Only(0) { Demand::Only(0) } else { Demand::Only(1) }
    }

    fn step(&mut self, (first, second): Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let input = if self.second == 1 { (first, second, None) } else { (first, None, second) };
        self.unit.step(input, traffic)
    }

    fn is_empty(&self) -> bool {
        self.unit.is_empty()
    }
}

unit_contract! {
    name: contract_of_the_host_interface,
    unit: HostInterface::new(HostConfig { buffers: 2, ..HostConfig::default() }),
    inputs: (display_list(), vec![FinishedPolygon; 14]),
    clients: [ClientKind::Port],
    state,
}

unit_contract! {
    name: contract_of_the_microcomputer,
    unit: OneWire(config(ShadingMode::Normal).microcomputer()),
    inputs: display_list(),
    clients: [ClientKind::Port],
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}

unit_contract! {
    name: contract_of_the_microcomputer_in_polyhedron_mode,
    unit: OneWire(config(ShadingMode::Polyhedron).microcomputer()),
    inputs: display_list(),
    clients: [ClientKind::Port],
    state: |unit| unit.0.state.clone() => |unit, state| unit.0.state = state,
}

unit_contract! {
    name: contract_of_the_registers,
    unit: RegisterBank::default(),
    inputs: wires(ShadingMode::Normal).figures,
    state,
}

unit_contract! {
    name: contract_of_circuit_21,
    unit: BrightnessInterpolation::new(InterpolationConfig::default(), operators()),
    inputs: wires(ShadingMode::Normal).selections,
    state,
}

unit_contract! {
    name: contract_of_circuit_21_in_brightness_mode,
    unit: BrightnessInterpolation::new(InterpolationConfig { initiation_interval: 3 }, operators()),
    inputs: wires(ShadingMode::Brightness).selections,
    state,
}

unit_contract! {
    name: contract_of_circuit_50,
    unit: config(ShadingMode::Normal).circuit_50(),
    inputs: wires(ShadingMode::Normal).normals,
    state,
}

unit_contract! {
    name: contract_of_circuit_50_with_a_table,
    unit: basrelief_figure_shading::NormalInterpolation::new(
        NormalInterpolationConfig { power: PowerMethod::Table, table_entries: 64, ..NormalInterpolationConfig::default() }, true, operators(),
    ),
    inputs: wires(ShadingMode::Normal).normals,
    state,
}

unit_contract! {
    name: contract_of_the_gate,
    unit: Gate::new(CircuitConfig::default()),
    inputs: wires(ShadingMode::Normal).highlights,
    state,
}

unit_contract! {
    name: contract_of_the_adder,
    unit: Adder::new(CircuitConfig { latency: 3, ..CircuitConfig::default() }, operators()),
    inputs: (wires(ShadingMode::Normal).interpolated, wires(ShadingMode::Normal).gated),
    state,
}

unit_contract! {
    name: contract_of_selector_53,
    unit: Selector53::new(CircuitConfig::default()),
    inputs: (wires(ShadingMode::Normal).sums, wires(ShadingMode::Normal).flat_dots),
    state,
}

unit_contract! {
    name: contract_of_selector_28_in_brightness_mode,
    unit: TwoWays { unit: Selector28::new(CircuitConfig::default()), second: 1 },
    inputs: (selected(ShadingMode::Brightness), wires(ShadingMode::Brightness).brightness_dots),
    state: |unit| unit.unit.state => |unit, state| unit.unit.state = state,
}

unit_contract! {
    name: contract_of_selector_28_in_polyhedron_mode,
    unit: TwoWays { unit: Selector28::new(CircuitConfig::default()), second: 2 },
    inputs: (selected(ShadingMode::Polyhedron), wires(ShadingMode::Polyhedron).constant_dots),
    state: |unit| unit.unit.state => |unit, state| unit.unit.state = state,
}

unit_contract! {
    name: contract_of_selector_28_in_normal_mode,
    unit: TwoWays { unit: Selector28::new(CircuitConfig::default()), second: 1 },
    inputs: (selected(ShadingMode::Normal), vec![]),
    state: |unit| unit.unit.state => |unit, state| unit.unit.state = state,
}

/// Returns the adder's fault message for a dot and a highlight.
fn message(signal: FigureFlow, highlight: SpecularFlow) -> String {
    let mut adder = Adder::default();
    adder.state.joins = true;
    let mut traffic = MemoryPorts::default();
    adder.step((Some(signal), Some(highlight)), &mut traffic);
    format!("{traffic:?}")
}

// Claim: shade, protocol: The adder (52) asserts equal addresses.
#[test]
fn section_4_adder_rejects_different_addresses() {
    let dot = |x, y| FigureFlow::Dot(ShadedDot { x, y, ..ShadedDot::default() });
    let highlight = |x, y| SpecularFlow::Dot(SpecularDot { x, y, brightness: 0.5 });
    assert!(message(dot(3, 4), highlight(3, 4)).contains("fault: None"));
    assert!(message(dot(3, 4), highlight(4, 4)).contains("circuit (21) is at dot 3, 4 and circuit (50) at 4, 4"));
    assert!(message(dot(3, 4), highlight(3, 5)).contains("circuit (50) at 3, 5"));
    assert!(message(dot(3, 4), SpecularFlow::End).contains("fewer dots"));
    assert!(message(FigureFlow::End, highlight(3, 4)).contains("more dots"));
    assert!(message(FigureFlow::End, SpecularFlow::End).contains("fault: None"));
}

// Claim: as section_2_ambient_counts_once_other_terms_per_light.
#[test]
fn section_2_only_the_output_saturates() {
    let mut adder = Adder::default();
    adder.state.joins = true;
    let dot = FigureFlow::Dot(ShadedDot { brightness: [0.9, -0.2, 0.1], ..ShadedDot::default() });
    let highlight = SpecularFlow::Dot(SpecularDot { brightness: 0.5, ..SpecularDot::default() });
    let sum = adder.step((Some(dot), Some(highlight)), &mut MemoryPorts::default()).out;
    let Some(FigureFlow::Dot(sum)) = sum else { panic!("{sum:?}") };
    assert!((sum.brightness[0] - 1.4).abs() < 1e-6 && (sum.brightness[1] - 0.3).abs() < 1e-6);
    let (pixel, _) = Selector28::default().step((Some(FigureFlow::Dot(sum)), None, None), &mut MemoryPorts::default()).out;
    let Some(Flow::Item(pixel)) = pixel else { panic!("{pixel:?}") };
    assert_eq!(pixel[0].rgb, [255, 77, 153]);
}
