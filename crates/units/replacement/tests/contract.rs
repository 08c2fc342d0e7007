//! The replacement unit (110) keeps the unit contract, with fixed tables and with code books.

use basrelief_kernel::Operators;
use basrelief_kernel_conformance::unit_contract;
use basrelief_replacement::{CodeBookMode, PerLevel, Replacement, ReplacementConfig};
use basrelief_signals::{Control, Flow, Fragment, ObjectInfo, Polygon, PseudoNormals, Stamp, StampSample, Vertex};
use std::sync::Arc;

fn object(id: u32) -> Control {
    Control::Object(Arc::new(ObjectInfo { id, name: format!("object {id}"), ..ObjectInfo::default() }))
}

fn polygon() -> Control {
    let (vertices, material) = (vec![Vertex::default(); 3], Arc::default());
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: true, arrival: 0 }))
}

fn normals(i: i16) -> Flow<PseudoNormals> {
    let samples = [(0, [i * 300, 100, 7]), (1, [100, -i, 90])];
    let samples = samples.map(|(level, normal)| StampSample::all(level, 0.5, normal)).into_iter().collect();
    Flow::Item(PseudoNormals { stamp: Stamp::from_iter([Fragment { x: i as u16, ..Fragment::default() }]), samples })
}

/// Returns two objects with three polygons each, one of them empty.
fn two_objects() -> Vec<Flow<PseudoNormals>> {
    let mut run = Vec::new();
    for id in 0..2 {
        run.extend([object(id), polygon()].map(Flow::Control));
        run.extend((0..12).map(normals));
        run.extend([polygon(), polygon()].map(Flow::Control));
        run.extend((12..20).map(normals));
    }
    run.push(Flow::Control(Control::FrameEnd));
    run
}

fn unit(codebook: CodeBookMode) -> Replacement {
    let entries = PerLevel::Levels(vec![16, 8]);
    let config = ReplacementConfig { entries, codebook, resident_tables: 1, ..ReplacementConfig::default() };
    Replacement::new(config, 16, &Operators::default()).expect("tables of such sizes")
}

unit_contract! {
    name: fixed_tables,
    unit: unit(CodeBookMode::Fixed),
    inputs: two_objects(),
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

unit_contract! {
    name: code_books_per_polygon,
    unit: unit(CodeBookMode::PerPolygon),
    inputs: two_objects(),
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

unit_contract! {
    name: code_books_per_object,
    unit: unit(CodeBookMode::PerObject),
    inputs: two_objects(),
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}
