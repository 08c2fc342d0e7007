//! Sample traces and random ones.

use basrelief_input::MemoryPool;
use basrelief_signals::{
    Camera, Control, Frame, Image, Light, LightKind, Lighting, Material, MeshInfo, ObjectInfo, Polygon, Sampler, ShadingMode,
    ShadingSettings, TexelFilter, Texture, Vertex, WrapMode,
};
use basrelief_trace::{
    BeginCommand, CanonicalHash, Digest, NoFiles, TraceError, TraceForm, TraceRecorder, TraceResolver, TraceWriter, open,
};
use proptest::prelude::*;
use std::sync::Arc;

/// A small trace with every command, canonical.
pub const SAMPLE: &str = include_str!("../../data/sample.dl.jsonl");

pub fn resolve(bytes: &[u8]) -> Result<Vec<Control>, TraceError> {
    TraceResolver::new(bytes, NoFiles, &MemoryPool::default())?.map(|item| item.map(|(control, _)| control)).collect()
}

pub fn record(controls: &[Control], form: TraceForm) -> Result<Vec<u8>, TraceError> {
    let mut recorder = TraceRecorder::new(Vec::new(), form, BeginCommand::new(64, 48))?;
    controls.iter().try_for_each(|control| recorder.record(control))?;
    recorder.finish(Vec::new())
}

pub fn hash(controls: &[Control]) -> Digest {
    let mut hash = CanonicalHash::new(&BeginCommand::new(64, 48));
    controls.iter().try_for_each(|control| hash.update(control)).unwrap();
    hash.finish()
}

/// The sample in another form.
pub fn sample_as(form: TraceForm) -> Vec<u8> {
    let mut writer = TraceWriter::new(Vec::new(), form).unwrap();
    for command in open(SAMPLE.as_bytes(), &MemoryPool::default()).unwrap() {
        writer.write(&command.unwrap()).unwrap();
    }
    writer.finish().unwrap()
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![any::<f32>().prop_filter("finite", |x| x.is_finite()), Just(0.0), Just(-0.0), Just(1.0), -1.0f32..1.0]
}

fn array<const N: usize>() -> impl Strategy<Value = [f32; N]> {
    proptest::collection::vec(number(), N).prop_map(|values| std::array::from_fn(|i| values[i]))
}

fn vertex() -> impl Strategy<Value = Vertex> {
    let position = (-524288.0f32..=524288.0, -524288.0f32..=524288.0, 0.0f32..=1.0, 1e-6f32..1e6);
    let full = (position, array(), array(), array(), array(), array(), array()).prop_map(
        |((x, y, z, w), normal, tangent, uv, uv_normal, color, brightness)| Vertex {
            position: [x, y, z, w],
            normal,
            tangent,
            uv,
            uv_normal,
            color,
            brightness,
        },
    );
    prop_oneof![full, array().prop_map(|uv| Vertex { uv, ..Vertex::default() })]
}

pub fn texture(id: u32, normal: bool) -> impl Strategy<Value = Arc<Texture>> {
    let sampler = (0..3usize, 0..3usize, any::<bool>()).prop_map(|(u, v, nearest)| {
        let wrap = |i| [WrapMode::Repeat, WrapMode::Mirror, WrapMode::Clamp][i];
        let filter = if nearest { TexelFilter::Nearest } else { TexelFilter::Bilinear };
        Sampler { wrap: [wrap(u), wrap(v)], filter }
    });
    (1u32..9, 1u32..9, any::<u8>(), any::<u64>(), sampler).prop_map(move |(width, height, count, seed, sampler)| {
        let most = width.max(height).ilog2() + 1;
        let level = |k: u32| {
            let (width, height) = ((width >> k).max(1), (height >> k).max(1));
            let texel = |i: u32| {
                let [r, g, b, a, ..] = (seed ^ u64::from(i)).wrapping_mul(0x9e37_79b9_7f4a_7c15).to_le_bytes();
                [r, g, b, if normal { 255 } else { a }]
            };
            Image { width, height, texels: (0..width * height).map(texel).collect() }
        };
        let levels = (0..=u32::from(count) % most).map(level).collect();
        let offset = (seed % (1 << 36)) * 16;
        Arc::new(Texture { id, name: format!("texture \"{id}\" ä"), sampler, levels, offset, elsewhere: None })
    })
}

fn material(id: u32) -> impl Strategy<Value = Arc<Material>> {
    let textures = (proptest::option::of(texture(2 * id, false)), proptest::option::of(texture(2 * id + 1, true)), any::<bool>());
    (textures, std::array::from_fn(|_| 0.0f32..=1.0), number(), 0.0f32..=1.0, 1.0f32..=1000.0).prop_map(
        move |((color_texture, normal_map, double_sided), base_color, normal_scale, k, n)| {
            Arc::new(Material {
                id,
                name: format!("material {id}\n"),
                base_color,
                color_texture,
                normal_map,
                normal_scale,
                lighting: Lighting { ka: k, kd: 1.0 - k, ks: k * k, n },
                double_sided,
            })
        },
    )
}

fn shading() -> impl Strategy<Value = ShadingSettings> {
    let mode = proptest::sample::select(vec![ShadingMode::Normal, ShadingMode::Brightness, ShadingMode::Polyhedron]);
    let intensity = || proptest::option::of(0.0f32..=16.0);
    let some = (proptest::option::of(mode), intensity(), intensity()).prop_map(|(mode, ia, is)| ShadingSettings { mode, ia, is });
    prop_oneof![Just(ShadingSettings::default()), some]
}

type Shape = (Vec<Vertex>, usize, u8, bool, u64);

fn shape() -> impl Strategy<Value = Shape> {
    (proptest::collection::vec(vertex(), 3..9), 0..3usize, 0..64u8, any::<bool>(), 0..1u64 << 30)
}

fn frame_data() -> impl Strategy<Value = (Camera, Vec<Light>)> {
    let real = || any::<f64>().prop_filter("finite and not 0", |x| x.is_finite() && *x != 0.0);
    let light = (any::<bool>(), array(), 0.0..f32::MAX).prop_map(|(point, at, intensity)| {
        let at = if at == [0.0; 3] { [0.0, 0.0, 1.0] } else { at };
        let kind = if point { LightKind::Point { position: at } } else { LightKind::Directional { to_light: at } };
        Light { kind, intensity }
    });
    (proptest::collection::vec(real(), 22), proptest::collection::vec(light, 1..4)).prop_map(|(v, lights)| {
        let camera = Camera {
            view_projection: std::array::from_fn(|i| v[i]),
            to_light: std::array::from_fn(|i| v[16 + i]),
            to_viewer: std::array::from_fn(|i| v[19 + i]),
        };
        (camera, lights)
    })
}

/// Possible output of a geometry processor: frames of objects of polygons.
pub fn controls() -> impl Strategy<Value = Vec<Control>> {
    let object = (array(), proptest::option::of(1..65_537u32), shading(), proptest::collection::vec(shape(), 0..4));
    let frame = (frame_data(), shading(), proptest::collection::vec(object, 0..4));
    let materials = (material(0), material(1), material(7));
    (materials, proptest::collection::vec(frame, 1..4)).prop_map(|((a, b, c), frames)| {
        let materials = [a, b, c];
        let mut controls = Vec::new();
        let mut cycle = 0;
        for (index, ((camera, lights), shading, objects)) in frames.into_iter().enumerate() {
            controls.push(Control::Frame(Arc::new(Frame {
                index: index as u32,
                width: 64,
                height: 48,
                camera,
                lights,
                textures: Vec::new(),
                shading,
            })));
            for (id, (centre, entries, shading, shapes)) in objects.into_iter().enumerate() {
                let object = id as u32;
                let name = format!("object {id}");
                let mesh = entries.map(|n| MeshInfo {
                    vertices: n,
                    indices: 3 * n,
                    uv: n % 2 == 0,
                    colors: n % 3 == 0,
                    digest: u64::from(n),
                });
                controls.push(Control::Object(Arc::new(ObjectInfo {
                    id: object,
                    name,
                    centre,
                    entries,
                    bias: (id % 3 == 1).then_some(id as u8 % 8),
                    shading,
                    mesh,
                })));
                if entries.is_some() {
                    controls.push(Control::Criterion(0.001 + f64::from(object)));
                }
                controls.extend(shapes.into_iter().map(|(vertices, which, lod, bump, wait)| {
                    cycle += wait;
                    let material = Arc::clone(&materials[which]);
                    Control::Polygon(Arc::new(Polygon { vertices, material, object, lod, bump, arrival: cycle }))
                }));
            }
            controls.push(Control::FrameEnd);
        }
        controls
    })
}
