//! Runs polygons through microcomputer and circuits, step by step, without time.

use basrelief_figure_shading::{
    Adder, BrightnessInterpolation, CircuitConfig, CpuConfig, FigureFlow, HostConfig, InterpolationConfig, Microcomputer,
    NormalInterpolation, NormalInterpolationConfig, NormalLoad, PolygonFigure, RegisterBank, RegisterOrder, ScanConfig,
    ShadedDot, ShadingConfig, ShortCutConfigs, SpecularDot, SpecularFlow,
};
use basrelief_kernel::{Demand, MemoryPorts, OperatorConfig, Operators, Unit};
use basrelief_signals::{Camera, Control, Frame, Light, LightKind, Lighting, Material, Polygon, Vertex};
use glam::Vec3;
use proptest::prelude::*;
use std::sync::Arc;

/// Side of the picture \[pixels\].
pub const SIDE: u32 = 32;

/// Parameters that affect the picture.
#[derive(Clone, Debug, Default)]
pub struct Config {
    pub shading: ShadingConfig,
    pub short_cuts: ShortCutConfigs,
    pub scan: ScanConfig,
    pub circuit_50: NormalInterpolationConfig,
    pub cpu: CpuConfig,
}

impl Config {
    pub fn microcomputer(&self) -> Microcomputer {
        let Self { shading, short_cuts, scan, circuit_50, cpu } = self.clone();
        Microcomputer::new(cpu, &HostConfig::default(), shading, short_cuts, scan, &circuit_50, &operators())
    }

    pub fn circuit_50(&self) -> NormalInterpolation {
        NormalInterpolation::new(self.circuit_50.clone(), self.shading.renormalise, operators())
    }

    /// Returns the configuration without short cuts.
    pub fn plain(mut self) -> Self {
        self.short_cuts.specular_negligible.enabled = false;
        self.short_cuts.flatness.enabled = false;
        self
    }
}

/// Returns the default operators of the machine.
pub fn operators() -> Operators {
    let pipelined = OperatorConfig::new(2, 1);
    Operators {
        multiply: pipelined.clone(),
        add: pipelined,
        divide: OperatorConfig::new(8, 8),
        square_root: OperatorConfig::new(11, 11),
        power: OperatorConfig::new(1, 1),
        ..Operators::default()
    }
}

/// Tokens of a polygon on each wire.
#[derive(Clone, Debug, Default)]
pub struct ShadedFragment {
    pub figure: Option<Arc<PolygonFigure>>,
    pub load: Option<Arc<NormalLoad>>,
    /// Dots of circuit (21).
    pub linear: Vec<ShadedDot>,
    /// Highlights of circuit (50).
    pub highlights: Vec<SpecularDot>,
    /// Dots of process 24.
    pub mean: Vec<ShadedDot>,
    /// Selected dots, behind the adder (52).
    pub dots: Vec<ShadedDot>,
}

/// Steps a unit until it requests input.
pub fn drain<U: Unit>(unit: &mut U, nothing: impl Fn() -> U::In) -> Vec<U::Out> {
    let mut out = Vec::new();
    while unit.demand() == Demand::Nothing {
        out.push(unit.step(nothing(), &mut MemoryPorts::default()).out);
    }
    out
}

/// Feeds a unit of one input, and collects its output.
pub fn feed<T, U: Unit<In = Option<T>>>(unit: &mut U, tokens: impl IntoIterator<Item = T>) -> Vec<U::Out> {
    let mut out = Vec::new();
    for token in tokens {
        out.push(unit.step(Some(token), &mut MemoryPorts::default()).out);
        out.extend(drain(unit, || None));
    }
    out
}

fn dots(signals: impl IntoIterator<Item = FigureFlow>) -> Vec<ShadedDot> {
    signals.into_iter().filter_map(|s| if let FigureFlow::Dot(dot) = s { Some(dot) } else { None }).collect()
}

/// Runs one polygon through a microcomputer that has its frame, and through the circuits.
pub fn shade(unit: &mut Microcomputer, config: &Config, polygon: Control) -> ShadedFragment {
    let mut shaded = ShadedFragment::default();
    let (mut mean, mut figures) = (Vec::new(), Vec::new());
    for (figure, load, flat, constant) in feed(unit, [polygon]) {
        shaded.load = shaded.load.or(load);
        mean.extend(flat.into_iter().chain(constant));
        figures.extend(figure);
    }
    shaded.mean = dots(mean);
    let mut linear = Vec::new();
    let mut registers = RegisterBank::default();
    let mode = RegisterOrder::Write(basrelief_figure_shading::RegisterWrite::Mode(config.shading.mode));
    for signal in feed(&mut registers, [mode].into_iter().chain(figures)).into_iter().flatten() {
        if let FigureFlow::Figure(figure) = &signal {
            shaded.figure = Some(Arc::clone(figure));
        }
        let out = feed(&mut BrightnessInterpolation::new(InterpolationConfig::default(), operators()), [signal]);
        linear.extend(out.into_iter().flat_map(|(a, b)| a.into_iter().chain(b)));
    }
    let highlights: Vec<SpecularFlow> =
        feed(&mut config.circuit_50(), shaded.load.clone()).into_iter().flatten().skip(1).collect();
    shaded.highlights =
        highlights.iter().filter_map(|h| if let SpecularFlow::Dot(dot) = h { Some(*dot) } else { None }).collect();
    shaded.linear = dots(linear.clone());
    let is_open = shaded.load.as_ref().is_some_and(|load| load.open);
    let added = add(linear, if is_open { highlights } else { Vec::new() });
    shaded.dots = if shaded.mean.is_empty() { dots(added) } else { shaded.mean.clone() };
    shaded
}

/// Runs tokens through the adder (52).
fn add(linear: Vec<FigureFlow>, highlights: Vec<SpecularFlow>) -> Vec<FigureFlow> {
    let mut adder = Adder::new(CircuitConfig::default(), operators());
    let (mut highlights, mut out) = (highlights.into_iter(), Vec::new());
    for signal in linear {
        let highlight = if adder.demand() == Demand::All { highlights.next() } else { None };
        let mut traffic = MemoryPorts::default();
        out.extend(adder.step((Some(signal), highlight), &mut traffic).out);
        assert!(format!("{traffic:?}").contains("fault: None"), "{traffic:?}");
    }
    assert_eq!(highlights.next(), None);
    out
}

/// Draws one polygon under these lights.
pub fn draw(config: &Config, lights: Vec<Light>, polygon: Control) -> ShadedFragment {
    let mut unit = config.microcomputer();
    feed(&mut unit, [frame(lights)]);
    shade(&mut unit, config, polygon)
}

pub fn frame(lights: Vec<Light>) -> Control {
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    Control::Frame(Arc::new(Frame { width: SIDE, height: SIDE, camera, lights, ..Frame::default() }))
}

pub fn sun(to_light: Vec3) -> Light {
    Light { kind: LightKind::Directional { to_light: to_light.normalize().to_array() }, intensity: 1.0 }
}

// Ranges of random floats begin at fractions of a power of two, because proptest 1.12 can assert on others in debug builds.

/// Creates a white polygon of points (x, y) with their normals.
pub fn polygon(points: &[[f32; 2]], normals: &[Vec3], lighting: Lighting) -> Control {
    let vertex = |(&[x, y], normal): (&[f32; 2], &Vec3)| Vertex {
        position: [x, y, 0.5, 1.0],
        normal: normal.to_array(),
        ..Vertex::default()
    };
    let vertices = points.iter().zip(normals).map(vertex).collect();
    let material = Arc::new(Material { lighting, ..Material::default() });
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 }))
}

pub fn direction() -> impl Strategy<Value = Vec3> {
    [-1f32..1.0, -1f32..1.0, -1f32..1.0]
        .prop_map(Vec3::from)
        .prop_filter("long enough", |v| v.length() > 0.1)
        .prop_map(Vec3::normalize)
}

pub fn lighting() -> impl Strategy<Value = Lighting> {
    (0f32..0.3, 0f32..0.8, 0.0625f32..0.8, 1u32..=200).prop_map(|(ka, kd, ks, n)| Lighting { ka, kd, ks, n: n as f32 })
}

/// Generates a triangle on a grid of 1/16 pixel, which snapping does not move.
pub fn triangle() -> impl Strategy<Value = [[f32; 2]; 3]> {
    prop::array::uniform3([0u32..SIDE * 16, 0u32..SIDE * 16]).prop_map(|t| t.map(|p| p.map(|c| c as f32 / 16.0)))
}

/// Returns the weights of the three corners at the centre of a dot, in double precision.
pub fn weights(t: &[[f32; 2]; 3], dot: (u16, u16)) -> [f64; 3] {
    let p = [f64::from(dot.0) + 0.5, f64::from(dot.1) + 0.5];
    let [a, b, c] = t.map(|p| p.map(f64::from));
    let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let whole = area(a, b, c);
    [area(p, b, c) / whole, area(a, p, c) / whole, area(a, b, p) / whole]
}
