//! The brightness fetch unit (112) keeps the unit contract, with CLUTs and without.

use basrelief_brightness::{BrightnessConfig, BrightnessFetch, BrightnessSource};
use basrelief_kernel::Operators;
use basrelief_kernel_conformance::unit_contract;
use basrelief_shading::{LEVELS, ReferenceNormals, TableSet};
use basrelief_signals::{
    Camera, Control, Flow, Fragment, Frame, Light, LightKind, NormalIndexes, ObjectInfo, Polygon, Stamp, StampSample, Vertex,
};
use std::sync::Arc;

fn unit(config: BrightnessConfig) -> BrightnessFetch {
    let tables = TableSet { entries: [40; LEVELS], table: ReferenceNormals::Fibonacci, distinct: true, entry_bits: 16 };
    BrightnessFetch::new(config, tables, 2, &Operators::default())
}

/// Returns a frame with one light.
fn frame() -> Control {
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let lamp = Light { kind: LightKind::Point { position: [0.0, 0.0, 10.0] }, intensity: 1.0 };
    Control::Frame(Arc::new(Frame { width: 6, height: 6, camera, lights: vec![lamp], ..Frame::default() }))
}

fn object(x: f32) -> Control {
    Control::Object(Arc::new(ObjectInfo { name: "ball".into(), centre: [x, 0.0, 0.0], ..ObjectInfo::default() }))
}

fn polygon() -> Control {
    let (vertices, material) = (vec![Vertex::default(); 3], Arc::default());
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: true, arrival: 0 }))
}

fn indexes(i: u16) -> Flow<NormalIndexes> {
    let samples = [(0, i % 40, 0.25), (3, i % 7, 0.75)];
    let samples = samples.map(|(level, index, weight)| StampSample::all(level, weight, index)).into_iter().collect();
    Flow::Item(NormalIndexes { stamp: Stamp::from_iter([Fragment::default()]), samples })
}

/// Returns two objects. The second one's CLUTs are recalculated.
fn two_objects() -> Vec<Flow<NormalIndexes>> {
    let mut run = vec![Flow::Control(frame())];
    for x in [0.0, 9.0] {
        run.extend([object(x), polygon()].map(Flow::Control));
        run.extend((0..40).map(indexes));
    }
    run.push(Flow::Control(Control::FrameEnd));
    run
}

unit_contract! {
    name: cluts,
    unit: unit(BrightnessConfig::default()),
    inputs: two_objects(),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state,
}

unit_contract! {
    name: direct_brightness,
    unit: unit(BrightnessConfig { source: BrightnessSource::Direct, ..BrightnessConfig::default() }),
    inputs: two_objects(),
    clients: [ClientKind::Cache { line_bytes: 64 }, ClientKind::Port],
    state,
}
