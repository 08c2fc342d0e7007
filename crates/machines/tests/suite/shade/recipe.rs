//! Generators of small random traces and configurations.

use crate::common::settings::{Axis, Settings, choices, choices_and_fifos};
use crate::common::trace;
pub use crate::common::trace::{frame, object};
use basrelief_signals::{Control, Light, LightKind, Lighting, Material, Polygon, Vertex};
use proptest::prelude::*;
use std::sync::Arc;

pub type V3 = [f32; 3];

pub fn unit(v: V3) -> V3 {
    let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
    v.map(|c| c / length)
}

pub fn sun(to_light: V3, intensity: f32) -> Light {
    trace::sun(unit(to_light), intensity)
}

/// A polygon of points (x, y, depth) with their normals.
pub fn polygon(points: &[V3], normals: &[V3], material: &Arc<Material>) -> Control {
    let vertex = |(&[x, y, z], &normal): (&V3, &V3)| Vertex { position: [x, y, z, 1.0], normal, ..Vertex::default() };
    let vertices = points.iter().zip(normals).map(vertex).collect();
    let material = Arc::clone(material);
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 }))
}

/// The polygon with a red first point.
fn coloured(polygon: &Control) -> Control {
    let Control::Polygon(polygon) = polygon else { unreachable!() };
    let mut polygon = Polygon::clone(polygon);
    polygon.vertices[0].color = [1.0, 0.0, 0.0, 1.0];
    Control::Polygon(Arc::new(polygon))
}

pub fn material(lighting: Lighting) -> Arc<Material> {
    Arc::new(Material { base_color: [0.9, 0.6, 0.3, 1.0], lighting, ..Material::default() })
}

pub fn lighting() -> impl Strategy<Value = Lighting> {
    (0.0f32..0.3, 0.0f32..0.8, 0.0625f32..0.8, 1u32..=200).prop_map(|(ka, kd, ks, n)| Lighting { ka, kd, ks, n: n as f32 })
}

pub fn direction() -> impl Strategy<Value = V3> {
    ([-1f32..1.0, -1f32..1.0, 0.0625f32..1.0]).prop_map(unit)
}

/// Normals that spread about a common direction: not at all, little, or much.
fn normals(count: usize) -> impl Strategy<Value = Vec<V3>> {
    let spread = prop_oneof![2 => Just(0.0f32), 3 => 0.015625f32..0.25, 1 => 0.25f32..2.0];
    let off = prop::collection::vec(prop::array::uniform3(-1f32..1.0), count);
    (direction(), spread, off).prop_map(|(middle, spread, off)| {
        off.into_iter().map(|o| unit([0, 1, 2].map(|i| middle[i] + spread * o[i] + 1e-9))).collect()
    })
}

/// A polygon of three to five points, rarely convex and sometimes degenerate.
fn random_polygon() -> impl Strategy<Value = (Vec<V3>, Vec<V3>, usize)> {
    (3usize..6).prop_flat_map(|count| {
        let points = prop::collection::vec([-6f32..46.0, -6f32..36.0, 0f32..1.0], count);
        (points, normals(count), 0usize..6, 0usize..2).prop_map(|(mut points, mut normals, damage, material)| {
            match damage {
                0 => points[1] = points[0],
                1 => points[2] = [0, 1, 2].map(|i| 2.0 * points[1][i] - points[0][i]),
                2 => normals[0] = [0.0; 3],
                _ => {}
            }
            (points, normals, material)
        })
    })
}

/// Frames of objects of polygons, under one or two lights, with two materials.
pub fn display_lists() -> impl Strategy<Value = Vec<Control>> {
    let frame_of = (prop::collection::vec(random_polygon(), 0..8), prop::collection::vec(direction(), 1..3), any::<bool>());
    (prop::collection::vec(frame_of, 1..3), [lighting(), lighting()]).prop_map(|(frames, lightings)| {
        let materials = lightings.map(material);
        let mut list = Vec::new();
        for ((polygons, lights, at_a_point), index) in frames.into_iter().zip(0..) {
            let mut lights: Vec<Light> = lights.into_iter().map(|l| sun(l, 0.7)).collect();
            if at_a_point {
                lights[0].kind = LightKind::Point { position: [3.0, 2.0, 9.0] };
            }
            list.push(frame(index, [40, 30], lights));
            for (i, (points, normals, which)) in polygons.into_iter().enumerate() {
                if i % 3 == 0 {
                    list.push(object(i as u32 / 3));
                }
                let polygon = polygon(&points, &normals, &materials[which]);
                list.push(if points.len() == 5 { coloured(&polygon) } else { polygon });
            }
            list.push(Control::FrameEnd);
        }
        list
    })
}

/// Parameters that change the work.
const MEANING: &[Axis] = &[
    &[&[], &[("shade.mode", "brightness")], &[("shade.mode", "polyhedron")]],
    &[&[], &[("shade.mode", "brightness"), ("shade.flat_in_brightness_mode", "true")]],
    &[&[], &[("shade.clamp", "none")]],
    &[&[], &[("shade.renormalise", "true")]],
    &[&[], &[("shade.specular_skip", "gate")]],
    &[&[], &[("shortcut.specular_negligible.enabled", "false")], &[("shortcut.specular_negligible.threshold", "0.2")]],
    &[&[], &[("shortcut.flatness.enabled", "false")], &[("shortcut.flatness.tolerance", "0.5")]],
    &[&[], &[("shortcut.same_plane.enabled", "false")]],
    &[&[], &[("normal_interpolation.power", "table"), ("normal_interpolation.table_entries", "64")]],
    &[&[], &[("scan.block", "1"), ("scan.z_bits", "16"), ("scan.subpixel_bits", "4")]],
    &[&[], &[("frame_memory.depth_test", "false")]],
    &[&[], &[("shade.ia", "0.5"), ("shade.is", "1.5")]],
];

/// Parameters that change only the timing. They must not change a picture.
const TIMING: &[Axis] = &[
    &[&[], &[("host.buffers", "2")]],
    &[&[], &[("host.bytes_per_cycle", "64"), ("host.latency", "0")], &[("host.bytes_per_cycle", "1"), ("host.latency", "50")]],
    &[&[], &[("cpu.scale", "7")], &[("cpu.store", "0"), ("cpu.integer", "0")]],
    &[
        &[],
        &[
            ("cpu.add", "0"),
            ("cpu.multiply", "0"),
            ("cpu.divide", "0"),
            ("cpu.square_root", "0"),
            ("cpu.compare", "0"),
            ("cpu.load", "0"),
        ],
    ],
    &[&[], &[("interpolation.initiation_interval", "5"), ("operators.divide.latency", "1")]],
    &[&[], &[("normal_interpolation.pipelined", "true")], &[("operators.multiply.latency", "9")]],
    &[&[], &[("operators.multiply.interval", "3"), ("operators.square_root.interval", "40")]],
    &[&[], &[("memory.local.part", "fpm-80")], &[("memory.local.part", "ideal")], &[("memory.local.outstanding", "11")]],
    &[&[], &[("gate.latency", "7"), ("adder.latency", "0"), ("selector_53.latency", "3"), ("selector_28.latency", "0")]],
    &[&[], &[("gate.initiation_interval", "3"), ("adder.initiation_interval", "2"), ("selector_28.initiation_interval", "4")]],
    &[
        &[],
        &[("memory.frame.part", "ideal")],
        &[("memory.frame.part", "edram-ps2"), ("memory.frame.channels", "3"), ("memory.frame.window", "2")],
        &[("memory.frame.part", "gddr3-1400"), ("memory.frame.cap", "0"), ("memory.frame.refi", "200")],
    ],
    &[
        &[],
        &[("memory.frame.outstanding", "1"), ("memory.frame.cl", "30"), ("cache.depth.sets", "1"), ("cache.depth.ways", "1")],
        &[("cache.depth.line_bytes", "32"), ("depth.clear_flags", "false"), ("frame_buffer.clear_flags", "false")],
    ],
    &[&[], &[("frame_buffer.write_lines", "2"), ("depth.write_lines", "1")], &[("depth.write_lines", "64")]],
    &[
        &[],
        &[("display.enabled", "false")],
        &[("display.pixel_hz", "4000000"), ("display.burst_bytes", "100")],
        &[("display.mode", "fifo"), ("display.pixel_hz", "9000000"), ("display.refresh_hz", "9000"), ("display.buffers", "3")],
    ],
];

/// FIFOs of the machine, except `draws` and the feedback FIFO, whose depth depends on `host.buffers`.
const FIFOS: [&str; 15] = [
    "polygons",
    "transfers",
    "figures",
    "selections",
    "normals",
    "flat_dots",
    "constant_dots",
    "interpolated",
    "brightness_dots",
    "highlights",
    "gated",
    "sums",
    "selected",
    "pixels",
    "tested_pixels",
];

/// Random settings that change the work.
pub fn meanings() -> impl Strategy<Value = Settings> {
    choices(MEANING)
}

/// Random settings that change only the timing: operators, memories, and FIFOs from 1 slot.
pub fn timings() -> impl Strategy<Value = Settings> {
    choices_and_fifos(TIMING, &FIFOS)
}
