//! Scene import, and the reference image. The model is the sphere of W1, written as GLB and as OBJ.

use crate::machines::demo_scene;
use crate::workload::{RunSample, ThroughputUnit, Workload, WorkloadSize, measured};
use basrelief_input::MemoryPool;
use basrelief_reference::{QualityMetrics, RenderOptions, RenderStyle, RgbPicture, draw_scene};
use basrelief_scene::{MemoryFiles, ViewOptions, load};
use basrelief_signals::{Mesh, Scene};
use std::fmt::Write as _;
use std::hint::black_box;
use std::sync::Arc;

/// A relief of 16 x 16 texels, so that tangents and the levels of a normal map are computed too.
const BUMPS: &[u8] = include_bytes!("../../../tests/models/bumps.png");

fn mesh(size: WorkloadSize) -> Arc<Mesh> {
    Arc::clone(&demo_scene(size.of("sphere", "mixed"), [64, 48]).objects[0].mesh)
}

/// Returns the coordinates of a texture. The sphere has only those of its normal map.
fn uv(mesh: &Mesh) -> &[[f32; 2]] {
    if mesh.uv.is_empty() { &mesh.uv_normal } else { &mesh.uv }
}

/// Returns the little-endian bytes of rows of numbers.
fn bytes<const N: usize>(rows: &[[f32; N]]) -> Vec<u8> {
    rows.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Returns the mesh as a GLB file with its normal map in the binary chunk.
fn glb(mesh: &Mesh) -> Vec<u8> {
    let indices: Vec<u8> = mesh.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let parts = [bytes(&mesh.positions), bytes(&mesh.normals), bytes(uv(mesh)), indices, BUMPS.to_vec()];
    let mut binary: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    for part in &parts {
        views.push(serde_json::json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": part.len() }));
        binary.extend(part);
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let bound =
        |fold: fn(f32, f32) -> f32| mesh.positions.iter().copied().reduce(|a, b| std::array::from_fn(|i| fold(a[i], b[i])));
    let floats = |view: usize, kind: &str| serde_json::json!({ "bufferView": view, "componentType": 5126, "count": mesh.positions.len(), "type": kind });
    let mut positions = floats(0, "VEC3");
    (positions["min"], positions["max"]) = (serde_json::json!(bound(f32::min)), serde_json::json!(bound(f32::max)));
    let json = serde_json::json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0 }] }],
        "materials": [{ "normalTexture": { "index": 0 } }], "textures": [{ "source": 0 }],
        "images": [{ "bufferView": 4, "mimeType": "image/png" }],
        "accessors": [positions, floats(1, "VEC3"), floats(2, "VEC2"),
            { "bufferView": 3, "componentType": 5125, "count": mesh.indices.len(), "type": "SCALAR" }],
        "bufferViews": views, "buffers": [{ "byteLength": binary.len() }]
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let total = 12 + 8 + json.len() + 8 + binary.len();
    [b"glTF", &word(2)[..], &word(total), &word(json.len()), b"JSON", &json, &word(binary.len()), b"BIN\0", &binary].concat()
}

/// Returns the mesh as an OBJ file.
fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::new();
    let mut line = |key: &str, row: &[f32]| {
        text.push_str(key);
        row.iter().try_for_each(|x| write!(text, " {x}")).expect("writing into memory");
        text.push('\n');
    };
    mesh.positions.iter().for_each(|row| line("v", row));
    uv(mesh).iter().for_each(|row| line("vt", row));
    mesh.normals.iter().for_each(|row| line("vn", row));
    for triangle in mesh.indices.as_chunks().0 {
        let [a, b, c] = triangle.map(|i| i + 1);
        writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}").expect("writing into memory");
    }
    text.into_bytes()
}

/// Returns the import of the file that `write` creates from the mesh.
fn import(size: WorkloadSize, kind: &'static str, write: fn(&Mesh) -> Vec<u8>) -> Workload {
    Workload::new(format!("scene/{kind}"), ThroughputUnit::Triangles, move || {
        let mesh = mesh(size);
        let (bytes, name) = (write(&mesh), format!("model.{kind}"));
        move || {
            let (scene, time) =
                measured(|| load(&bytes, &name, &MemoryFiles::default(), &ViewOptions::default(), &MemoryPool::default()));
            let (scene, _held): (Scene, _) = scene.expect("the model is sound");
            RunSample { time, count: (scene.objects[0].mesh.indices.len() / 3) as u64 }
        }
    })
}

fn demo(size: WorkloadSize) -> Workload {
    Workload::new("scene/demo", ThroughputUnit::Triangles, move || {
        move || {
            let (scene, time) = measured(|| demo_scene(size.of("sphere", "goblet"), [64, 48]));
            RunSample { time, count: (scene.objects[0].mesh.indices.len() / 3) as u64 }
        }
    })
}

fn picture(scene: &Scene) -> RgbPicture {
    draw_scene(scene, &scene.frames[0], &RenderStyle::from(RenderOptions::default()))
}

fn exact(size: WorkloadSize) -> Workload {
    Workload::new("reference/picture", ThroughputUnit::Pixels, move || {
        let scene = demo_scene("sphere", size.of([640, 480], [64, 48]));
        move || {
            let (picture, time) = measured(|| picture(&scene));
            RunSample { time, count: picture.rgb.len() as u64 }
        }
    })
}

fn metrics(size: WorkloadSize) -> Workload {
    Workload::new("reference/metrics", ThroughputUnit::Pixels, move || {
        let scene = demo_scene("sphere", size.of([640, 480], [64, 48]));
        let exact = picture(&scene);
        let mut other = exact.clone();
        other.rgb.iter_mut().for_each(|rgb| rgb[1] ^= 1);
        move || {
            let (quality, time) = measured(|| QualityMetrics::measure(&exact, &other));
            black_box(quality.expect("pictures of one size"));
            RunSample { time, count: exact.rgb.len() as u64 }
        }
    })
}

/// Returns import, the reference image, and the metrics.
pub fn workloads(size: WorkloadSize) -> Vec<Workload> {
    vec![import(size, "glb", glb), import(size, "obj", obj), demo(size), exact(size), metrics(size)]
}
