//! Rasterizer and distributor keep the unit contract.

use basrelief_kernel::{Demand, MemoryPorts, Operators, Unit};
use basrelief_kernel_conformance::unit_contract;
use basrelief_rasterizer::{Distributor, Rasterizer, RasterizerConfig};
use basrelief_signals::{Control, Flow, Fragment, Frame, ObjectInfo, Polygon, Stamp, Vertex};
use std::sync::Arc;

fn polygon(bump: bool, corners: &[[f32; 2]]) -> Control {
    let vertex = |(i, &[x, y]): (usize, &[f32; 2])| Vertex {
        position: [x, y, 0.1 * i as f32, 1.0 / (1.0 + i as f32)],
        ..Vertex::default()
    };
    let vertices = corners.iter().enumerate().map(vertex).collect();
    let material = Arc::default();
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump, arrival: 0 }))
}

/// Returns two frames: a triangle, a pentagon that extends beyond the screen, a polygon without pixels, one without area, a
/// folded one.
fn display_list() -> Vec<Control> {
    let object = ObjectInfo { name: "o".into(), ..ObjectInfo::default() };
    let frame = |index| {
        [
            Control::Frame(Arc::new(Frame { index, width: 20, height: 14, ..Frame::default() })),
            Control::Object(Arc::new(object.clone())),
            polygon(true, &[[1.3, 1.1], [12.6, 2.2], [4.9, 9.7]]),
            polygon(false, &[[10.0, -3.0], [26.0, 1.0], [25.0, 9.0], [14.0, 13.5], [9.0, 5.0]]),
            polygon(true, &[[3.1, 3.1], [3.2, 3.1], [3.2, 3.2]]),
            polygon(false, &[[1.0, 1.0], [5.0, 5.0], [9.0, 9.0]]),
            polygon(false, &[[2.0, 2.0], [9.0, 9.0], [2.0, 9.0], [9.0, 2.0]]),
            polygon(true, &[[0.0, 12.0], [6.0, 12.0], [6.0, 14.0], [0.0, 14.0]]),
            Control::FrameEnd,
        ]
    };
    (0..2).flat_map(frame).collect()
}

unit_contract! {
    name: rasterizer,
    unit: Rasterizer::new(RasterizerConfig::default(), Operators::default()),
    inputs: display_list(),
    state,
}

unit_contract! {
    name: rasterizer_of_single_pixels_and_slow_set_up,
    unit: Rasterizer::new(RasterizerConfig { block: 1, multipliers: 1, ..RasterizerConfig::default() }, Operators::default()),
    inputs: display_list(),
    state,
}

/// Returns the rasterizer's output for the display list.
fn fragments() -> Vec<Flow<Stamp<Fragment>>> {
    let mut unit = Rasterizer::new(RasterizerConfig::default(), Operators::default());
    let mut out = Vec::new();
    for control in display_list() {
        out.extend(unit.step(Some(control), &mut MemoryPorts::default()).out);
        while unit.demand() == Demand::Nothing {
            out.extend(unit.step(None, &mut MemoryPorts::default()).out);
        }
    }
    out
}

unit_contract! {
    name: distributor,
    unit: Distributor::default(),
    inputs: fragments(),
    state,
}
