//! Traces of textured and plain polygons, with generators of small random ones.

use crate::common::settings::{Axis, Settings, choices};
pub use crate::common::trace::object;
use crate::common::trace::{self, sun};
use basrelief_signals::{Control, Image, Material, Polygon, Sampler, Texture, Vertex, WrapMode};
use proptest::prelude::*;
use std::sync::Arc;

/// Size of the pictures.
pub const SIZE: [u32; 2] = [40, 30];

pub fn frame(index: u32) -> Control {
    trace::frame(index, SIZE, vec![sun([0.0, 0.0, 1.0], 1.0)])
}

/// A texture of noise, its only level the finest.
pub fn texture(id: u32, size: [u32; 2], wrap: [WrapMode; 2]) -> Arc<Texture> {
    let mut state = id.wrapping_mul(0x9e37_79b9) ^ size[0];
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let texels = (0..size[0] * size[1]).map(|_| [byte(), byte(), byte(), 255]).collect();
    let sampler = Sampler { wrap, ..Sampler::default() };
    let levels = vec![Image { width: size[0], height: size[1], texels }];
    Arc::new(Texture { id, name: format!("texture {id}"), sampler, levels, offset: 0, elsewhere: None })
}

pub fn textured(texture: &Arc<Texture>) -> Arc<Material> {
    Arc::new(Material { id: texture.id, color_texture: Some(Arc::clone(texture)), ..Material::default() })
}

/// A corner: x, y, depth, 1 / w, u, v.
pub type Corner = [f32; 6];

pub fn polygon(corners: &[Corner], material: &Arc<Material>) -> Control {
    let vertex = |&[x, y, z, q, u, v]: &Corner| Vertex { position: [x, y, z, q], uv: [u, v], ..Vertex::default() };
    let vertices = corners.iter().map(vertex).collect();
    let material = Arc::clone(material);
    Control::Polygon(Arc::new(Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 }))
}

/// A rectangle at this depth over the whole of a texture.
pub fn rectangle([left, top, right, bottom]: [f32; 4], depth: f32, material: &Arc<Material>) -> Control {
    let corner = |x, y, u, v| [x, y, depth, 1.0, u, v];
    let corners = [
        corner(left, top, 0.0, 0.0),
        corner(right, top, 1.0, 0.0),
        corner(right, bottom, 1.0, 1.0),
        corner(left, bottom, 0.0, 1.0),
    ];
    polygon(&corners, material)
}

/// A floor that runs to the horizon, its texture repeated.
pub fn floor(material: &Arc<Material>, repeats: f32) -> Control {
    let (near, far) = (1.0, 0.02);
    let corners = [
        [-20.0, 30.0, 0.1, near, 0.0, 0.0],
        [60.0, 30.0, 0.1, near, repeats, 0.0],
        [60.0, 10.0, 0.9, far, repeats, repeats],
        [-20.0, 10.0, 0.9, far, 0.0, repeats],
    ];
    polygon(&corners, material)
}

/// A scene with non-square, odd and large textures, all wrap modes, a hidden picture, and direct colours.
pub fn hall() -> Vec<Control> {
    use WrapMode::{Clamp, Mirror, Repeat};
    let ground = textured(&texture(0, [64, 64], [Repeat; 2]));
    let wide = textured(&texture(1, [150, 40], [Clamp; 2]));
    let odd = textured(&texture(2, [37, 61], [Mirror, Repeat]));
    let hidden = textured(&texture(3, [128, 128], [Repeat; 2]));
    let far = textured(&texture(4, [200, 200], [Clamp; 2]));
    let plain = Arc::new(Material { id: 9, base_color: [0.8, 0.3, 0.1, 1.0], ..Material::default() });
    vec![
        object(0),
        rectangle([2.0, 1.0, 20.0, 9.0], 0.8, &hidden),
        floor(&ground, 6.0),
        rectangle([1.0, 0.0, 22.0, 10.0], 0.5, &wide),
        object(1),
        polygon(&[[24.0, 2.0, 0.4, 1.0, -0.5, -0.7], [38.0, 1.0, 0.4, 0.3, 1.6, -0.7], [36.0, 14.0, 0.4, 0.4, 1.6, 2.2]], &odd),
        rectangle([26.0, 18.0, 33.0, 24.0], 0.05, &far),
        polygon(&[[5.0, 12.0, 0.1, 1.0, 0.0, 0.0], [12.0, 14.0, 0.1, 1.0, 0.0, 0.0], [8.0, 22.0, 0.1, 1.0, 0.0, 0.0]], &plain),
    ]
}

/// Views of the hall: the same polygons, moved to the left by some pixels in each.
pub fn views(moves: &[f32]) -> Vec<Control> {
    let mut list = Vec::new();
    for (index, by) in (0..).zip(moves) {
        list.push(frame(index));
        list.extend(hall().iter().map(|control| moved(control, *by)));
        list.push(Control::FrameEnd);
    }
    list
}

fn moved(control: &Control, by: f32) -> Control {
    let Control::Polygon(polygon) = control else { return control.clone() };
    let mut polygon = Polygon::clone(polygon);
    polygon.vertices.iter_mut().for_each(|v| v.position[0] -= by);
    Control::Polygon(Arc::new(polygon))
}

/// Polygons of three or four corners, near and far, with textures of several sizes and wrap modes, and without.
fn random_polygon() -> impl Strategy<Value = (Vec<Corner>, usize)> {
    let corner = (-10f32..50.0, -10f32..40.0, 0f32..1.0, 0.01f32..1.0, -3f32..3.0, -3f32..3.0);
    let corners = prop::collection::vec(corner.prop_map(|(x, y, z, q, u, v)| [x, y, z, q, u, v]), 3..5);
    (corners, 0usize..5)
}

/// Frames of polygons that share materials.
pub fn display_lists() -> impl Strategy<Value = Vec<Control>> {
    let wrap = || prop_oneof![Just(WrapMode::Repeat), Just(WrapMode::Mirror), Just(WrapMode::Clamp)];
    let textures = prop::collection::vec(((1u32..70, 1u32..70), wrap(), wrap()), 4);
    let frames = prop::collection::vec(prop::collection::vec(random_polygon(), 0..6), 1..4);
    (textures, frames).prop_map(|(textures, frames)| {
        let numbered = (0..).zip(textures);
        let mut materials: Vec<_> = numbered.map(|(id, ((w, h), s, t))| textured(&texture(id, [w, h], [s, t]))).collect();
        materials.push(Arc::new(Material { id: 99, base_color: [0.2, 0.9, 0.4, 1.0], ..Material::default() }));
        let mut list = Vec::new();
        for (index, polygons) in (0..).zip(frames) {
            list.extend([frame(index), object(0)]);
            list.extend(polygons.iter().map(|(corners, which)| polygon(corners, &materials[*which])));
            list.push(Control::FrameEnd);
        }
        list
    })
}

/// Parameters that change the work.
const MEANING: &[Axis] = &[
    &[&[], &[("defer.mode", "progressive")], &[("defer.mode", "conventional")]],
    &[&[], &[("defer.texel_centre", "integer")]],
    &[&[], &[("defer.lighting", "gouraud")]],
    &[&[], &[("defer.wrap", "clamp")], &[("defer.wrap", "mirror")]],
    &[&[], &[("defer.dmax", "1")]],
    &[&[], &[("tile.encoding", "png")], &[("tile.encoding", "jpeg"), ("tile.jpeg_quality", "50")]],
    &[&[("tile.width", "16"), ("tile.height", "16")], &[("tile.width", "8"), ("tile.height", "32")], &[]],
    &[&[], &[("tile.order", "centre")], &[("tile.order", "pixels")]],
    &[&[], &[("defer.mode", "progressive"), ("defer.pictures_per_view", "2")]],
    &[
        &[],
        &[
            ("cell.coordinate_format", "fixed"),
            ("cell.coordinate_bits", "20"),
            ("cell.depth_bits", "12"),
            ("cell.depth_fraction_bits", "6"),
        ],
    ],
    &[&[], &[("rasterizer.z_bits", "16"), ("rasterizer.block", "1"), ("rasterizer.stamp", "1")]],
];

const FAST_PATH: (&str, &str) = ("path.bits_per_second", "30000000000");
const FAST_PIXELS: (&str, &str) = ("display.pixel_hz", "9000000");
const FAST_REFRESH: (&str, &str) = ("display.refresh_hz", "9000");

/// Parameters that change only the timing. They must not change a picture.
const TIMING: &[Axis] = &[
    &[&[FAST_PATH], &[("path.bits_per_second", "2000000000")], &[("path.bits_per_second", "777777777777")]],
    &[&[("path.latency_us", "0")], &[("path.latency_us", "3")]],
    &[&[], &[("path.requests", "1")], &[("path.requests", "40")]],
    &[&[], &[("path.number_bytes", "0"), ("path.texture_size_bytes", "4")], &[("path.head_bytes", "99")]],
    &[&[], &[("defer.depth_pixel", "separate")]],
    &[
        &[],
        &[("engine.latency", "0"), ("engine.scan_rate", "16"), ("engine.fill_rate", "3")],
        &[("engine.latency", "40"), ("engine.list_rate", "1")],
    ],
    &[&[], &[("engine.interpolation_rate", "8"), ("engine.average_rate", "7")]],
    &[&[], &[("tile.expand_rate", "5")]],
    &[
        &[],
        &[("memory.pixel_depth.part", "ideal")],
        &[("memory.pixel_depth.part", "edram-ps2"), ("memory.pixel_depth.channels", "3"), ("memory.pixel_depth.window", "2")],
        &[("memory.pixel_depth.part", "gddr3-1400"), ("memory.pixel_depth.cap", "0"), ("memory.pixel_depth.refi", "200")],
    ],
    &[
        &[],
        &[("memory.texture.outstanding", "128"), ("memory.texture.cl", "40")],
        &[("cache.texel.sets", "1"), ("cache.texel.ways", "1")],
    ],
    &[
        &[],
        &[("memory.reference.outstanding", "1")],
        &[("memory.pixel_depth.outstanding", "2"), ("memory.pixel_depth.banks", "1")],
    ],
    &[
        &[],
        &[
            ("fifo.parcels.depth", "1"),
            ("fifo.mesh.depth", "1"),
            ("fifo.expanded.depth", "1"),
            ("fifo.fragments.depth", "1"),
            ("fifo.tested_fragments.depth", "1"),
            ("fifo.cells.depth", "1"),
            ("fifo.marking.depth", "1"),
            ("fifo.colouring.depth", "1"),
            ("fifo.marks.depth", "1"),
            ("fifo.improvements.depth", "1"),
            ("fifo.requests.depth", "1"),
            ("fifo.orders.depth", "1"),
            ("fifo.rounds.depth", "1"),
            ("fifo.pixels.depth", "1"),
            ("fifo.shown.depth", "1"),
        ],
        &[
            ("fifo.requests.latency", "9"),
            ("fifo.orders.latency", "5"),
            ("fifo.rounds.latency", "7"),
            ("fifo.shown.latency", "6"),
        ],
    ],
    &[
        &[],
        &[("engine.write_lines", "1"), ("depth.write_lines", "64"), ("engine.flags", "7")],
        &[("depth.write_lines", "1"), ("depth.clear_flags", "false"), ("engine.clear_flags", "false")],
    ],
    &[
        &[FAST_PIXELS, FAST_REFRESH],
        &[("display.enabled", "false")],
        &[("display.mode", "fifo"), FAST_PIXELS, FAST_REFRESH, ("display.buffers", "3")],
    ],
];

pub fn meanings() -> impl Strategy<Value = Settings> {
    choices(MEANING)
}

pub fn timings() -> impl Strategy<Value = Settings> {
    choices(TIMING)
}

/// A path and a display fast enough for the ticked engine, which visits every unit in every cycle.
pub const FAST: &[(&str, &str)] = &[FAST_PATH, ("path.latency_us", "0"), FAST_PIXELS, FAST_REFRESH];
/// Small tiles, so that small textures have several.
pub const SMALL: &[(&str, &str)] = &[("tile.width", "8"), ("tile.height", "8")];
