//! Generators of small random traces and configurations.

use crate::common::settings::{Axis, Settings, choices, choices_and_fifos};
pub use crate::common::trace::object;
use crate::common::trace::{self, sun};
use basrelief_signals::{Control, Image, Material, Polygon, Sampler, TexelFilter, Texture, Vertex, WrapMode};
use proptest::prelude::*;
use std::sync::Arc;

pub fn frame(index: u32, size: [u32; 2]) -> Control {
    trace::frame(index, size, vec![sun([0.36, 0.48, 0.8], 1.0)])
}

/// A texture of noise, 16 x 8 texels and all levels, somewhat transparent.
pub fn texture(wrap: WrapMode) -> Arc<Texture> {
    let level = |k: u32| {
        let (width, height) = ((16u32 >> k).max(1), (8u32 >> k).max(1));
        let texel = |i: u32| [i * 37 + k, i * 91 + 5 * k, i * 13, 255 - i].map(|c| c as u8);
        Image { width, height, texels: (0..width * height).map(texel).collect() }
    };
    let sampler = Sampler { wrap: [wrap, WrapMode::Repeat], filter: TexelFilter::Bilinear };
    Arc::new(Texture { id: 0, name: "noise".into(), sampler, levels: (0..5).map(level).collect(), offset: 32, elsewhere: None })
}

pub fn material(texture: Option<Arc<Texture>>) -> Arc<Material> {
    Arc::new(Material { base_color: [0.9, 0.7, 1.0, 0.6], color_texture: texture, ..Material::default() })
}

/// A polygon of corners (x, y, depth, 1 / w) with their u, v.
pub fn polygon(corners: &[[f32; 4]], uv: &[[f32; 2]], material: &Arc<Material>, bump: bool) -> Control {
    let vertex = |(i, (&position, &uv)): (usize, (&[f32; 4], &[f32; 2]))| {
        let brightness = [0.3 + 0.1 * i as f32, 0.05 * i as f32];
        Vertex { position, uv, brightness, color: [1.0, 0.5 + 0.1 * i as f32, 1.0, 1.0], ..Vertex::default() }
    };
    let vertices = corners.iter().zip(uv).enumerate().map(vertex).collect();
    Control::Polygon(Arc::new(Polygon { vertices, material: Arc::clone(material), object: 0, lod: 0, bump, arrival: 0 }))
}

/// A polygon of three to five points, rarely convex and sometimes degenerate.
fn random_polygon() -> impl Strategy<Value = (Vec<[f32; 4]>, Vec<[f32; 2]>, usize, bool)> {
    (3usize..6).prop_flat_map(|count| {
        let corners = prop::collection::vec([-6f32..90.0, -6f32..36.0, 0f32..1.0, 0.01f32..1.0], count);
        let uv = prop::collection::vec(prop::array::uniform2(-40f32..40.0), count);
        (corners, uv, 0usize..3, any::<bool>(), 0usize..8).prop_map(|(mut corners, mut uv, material, bump, damage)| {
            match damage {
                0 => corners[1] = corners[0],
                1 => corners.iter_mut().for_each(|c| c[3] = 0.5),
                2 => uv.iter_mut().for_each(|c| *c = [c[0] / 40.0, 900.0]),
                _ => {}
            }
            (corners, uv, material, bump)
        })
    })
}

/// Frames of objects of polygons with three materials: two textures and none.
pub fn display_lists() -> impl Strategy<Value = Vec<Control>> {
    prop::collection::vec(prop::collection::vec(random_polygon(), 0..7), 1..3).prop_map(|frames| {
        let materials = [Some(texture(WrapMode::Repeat)), Some(texture(WrapMode::Clamp)), None].map(material);
        let mut list = Vec::new();
        for (polygons, index) in frames.into_iter().zip(0..) {
            list.push(frame(index, [80, 30]));
            for (i, (corners, uv, which, bump)) in polygons.into_iter().enumerate() {
                if i % 3 == 0 {
                    list.push(object(i as u32 / 3));
                }
                if i % 4 == 1 {
                    list.push(Control::Criterion(0.1 * (i + 1) as f64));
                }
                list.push(polygon(&corners, &uv, &materials[which], bump));
            }
            list.push(Control::FrameEnd);
        }
        list
    })
}

/// Parameters that change the work.
const MEANING: &[Axis] = &[
    &[
        &[],
        &[],
        &[("texel.method", "exact")],
        &[("texel.method", "fixed"), ("texel.interval", "5")],
        &[("texel.method", "fixed"), ("texel.points", "3")],
        &[("texel.method", "subpolygon"), ("texel.interval", "9")],
    ],
    &[&[], &[("texel.error_bound", "0.05")], &[("texel.error_bound", "4")]],
    &[&[], &[("texel.step_form", "approximate")], &[("texel.step_table", "32")]],
    &[&[], &[("texel.min_span", "9")], &[("texel.longest_segment", "16")]],
    &[&[], &[("texel.coordinate_bits", "16"), ("texel.step_bits", "8"), ("approximation.reciprocal_bits", "6")]],
    &[&[], &[("texel.snap", "round")], &[("texel.snap", "floor")]],
    &[&[], &[("texel.march", "right_to_left")]],
    &[&[], &[("divider.division", "reciprocal")]],
    &[&[], &[("mip.mode", "nearest")], &[("mip.mode", "trilinear")], &[("mip.mode", "trilinear"), ("mip.per", "pixel")]],
    &[&[], &[("look_up.filter", "nearest")]],
    &[&[], &[("illuminance.mode", "off")]],
    &[&[], &[("combiner.mode", "modulate")], &[("combiner.mode", "blend")]],
    &[&[], &[("pixel_value_buffer.depth_test", "false")]],
    &[&[], &[("scan.z_bits", "16"), ("scan.subpixel_bits", "4")]],
];

/// Parameters that change only the timing. They must not change a picture.
const TIMING: &[Axis] = &[
    &[&[], &[("texture.layout", "linear")], &[("texture.layout", "blocked_6d"), ("texture.superblock", "8")]],
    &[&[], &[("divider.count", "1")], &[("divider.count", "5"), ("divider.bits_per_cycle", "1")]],
    &[&[], &[("divider.pipelined", "true")], &[("operators.multiply.latency", "1"), ("operators.add.latency", "40")]],
    &[&[], &[("texel.multipliers", "1")], &[("operators.divide.interval", "40"), ("texel.table_cycles", "9")]],
    &[&[], &[("scan.dividers", "1"), ("scan.adders", "13")], &[("scan.adders", "1"), ("scan.latency", "0")]],
    &[&[], &[("approximation.initiation_interval", "3")]],
    &[&[], &[("mip.latency", "20"), ("look_up.samples_per_cycle", "2"), ("look_up.latency", "0")]],
    &[&[], &[("illuminance.initiation_interval", "3"), ("illuminance.latency", "9"), ("illuminance.multipliers", "1")]],
    &[&[], &[("combiner.initiation_interval", "2"), ("combiner.latency", "0")]],
    &[
        &[],
        &[("memory.pixel.part", "ideal")],
        &[("memory.pixel.part", "ddr2-667"), ("memory.pixel.channels", "3"), ("memory.pixel.window", "2")],
        &[("memory.pixel.part", "gddr3-1400"), ("memory.pixel.cap", "0"), ("memory.pixel.refi", "200")],
    ],
    &[&[], &[("memory.texture.cl", "40"), ("cache.texture.sets", "1"), ("cache.texture.ways", "1")]],
    &[&[], &[("cache.texture.line_bytes", "16"), ("cache.texture.lookups_per_cycle", "1")], &[("look_up.texel_bytes", "6")]],
    &[&[], &[("memory.pixel.outstanding", "1"), ("memory.depth.outstanding", "1"), ("memory.pixel.cl", "30")]],
    &[
        &[],
        &[("frame_buffer.write_lines", "1"), ("depth.clear_flags", "false"), ("frame_buffer.clear_flags", "false")],
        &[("depth.write_lines", "2")],
    ],
    &[
        &[],
        &[("display.enabled", "false")],
        &[("display.pixel_hz", "4000000"), ("display.burst_bytes", "100")],
        &[("display.mode", "fifo"), ("display.pixel_hz", "9000000"), ("display.refresh_hz", "9000"), ("display.buffers", "3")],
    ],
];

/// FIFOs of the machine, except `draws`.
const FIFOS: [&str; 13] = [
    "polygons",
    "spans",
    "lit_spans",
    "points",
    "segments",
    "quotients",
    "texels",
    "gradients",
    "tested_texels",
    "levels",
    "texture_values",
    "illuminances",
    "pixels",
];

/// Random settings that change the work.
pub fn meanings() -> impl Strategy<Value = Settings> {
    choices(MEANING)
}

/// Random settings that change only the timing: operators, memories, and FIFOs from 1 slot.
pub fn timings() -> impl Strategy<Value = Settings> {
    choices_and_fifos(TIMING, &FIFOS)
}
