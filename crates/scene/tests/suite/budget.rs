//! A small model can expand into large data, which are counted and refused above the limit.

use basrelief_input::MemoryPool;
use basrelief_scene::{MemoryFiles, SceneError, ViewOptions, load};
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};
use std::io::Cursor;

const LIMIT: u64 = 1 << 20;

/// The error of a model that must not be held.
fn error_of(bytes: &[u8], name: &str, files: &MemoryFiles, view: &ViewOptions) -> SceneError {
    let budget = MemoryPool::new(LIMIT);
    let error =
        load(bytes, name, files, view, &budget).map(|_| ()).expect_err(&String::from_utf8_lossy(&bytes[..bytes.len().min(60)]));
    assert_eq!(budget.left(), LIMIT, "what was refused is not held");
    error
}

fn says_so(error: &SceneError, what: &str, part: &str) {
    let text = error.to_string();
    assert!(error.over_budget && !error.file.is_empty(), "{what}: {text}");
    assert!(text.contains("over the limit of 1 MiB; give more with --memory-limit"), "{what}: {text}");
    assert!(text.contains(part), "{what}: {text}, expected {part:?} in it");
}

/// A grey picture: a few kilobytes.
fn picture(side: u32) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::new_luma8(side, side).write_to(&mut bytes, ImageFormat::Png).expect("in memory");
    bytes.into_inner()
}

fn files() -> MemoryFiles {
    let corners: Vec<u8> = [0., 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes).collect();
    MemoryFiles::default()
        .with("corners.bin", corners)
        .with("large.bin", vec![0; 4 << 20])
        .with("wide.bin", vec![0; 1 << 18])
        .with("small.png", picture(4))
        .with("large.png", picture(1024))
        .with("large.mtl", "newmtl a\n".repeat(100_000))
        .with("picture.mtl", "newmtl a\nmap_Kd large.png\n")
        .with("bump.mtl", "newmtl a\nbump large.png\n")
}

/// One triangle.
fn triangle() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"uri": "corners.bin", "byteLength": 36}]
    })
}

fn with(changes: &[(&str, Value)]) -> Value {
    let mut document = triangle();
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        let parent = document.pointer_mut(parent).expect("it is there");
        match (parent, key.parse::<usize>()) {
            (Value::Array(list), Ok(i)) if i < list.len() => list[i] = value.clone(),
            (Value::Array(list), _) => list.push(value.clone()),
            (parent, _) => parent[key] = value.clone(),
        }
    }
    document
}

/// Elements that no data back.
fn zeros(count: u64, kind: &str) -> Value {
    json!({"componentType": 5126, "count": count, "type": kind})
}

/// One triangle of the first three of these positions.
fn with_positions(accessor: Value) -> Value {
    with(&[
        ("/accessors/0", accessor),
        ("/buffers/1", json!({"uri": "data:;base64,AAEC", "byteLength": 3})),
        ("/bufferViews/1", json!({"buffer": 1, "byteLength": 3})),
        ("/accessors/1", json!({"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"})),
        ("/meshes/0/primitives/0/indices", 1.into()),
    ])
}

#[test]
fn gltf_size_over_budget_is_refused() {
    let many = |item: Value, count: usize| Value::Array(vec![item; count]);
    let primitive = |material: usize| json!({"attributes": {"POSITION": 0}, "material": material});
    let textured = |picture: &str, of: &str| {
        let material =
            if of == "normalTexture" { json!({of: {"index": 0}}) } else { json!({"pbrMetallicRoughness": {of: {"index": 0}}}) };
        with(&[
            ("/images", json!([{"uri": picture}])),
            ("/textures", json!([{"source": 0}])),
            ("/materials", json!([material])),
            ("/meshes/0/primitives/0", primitive(0)),
        ])
    };
    let uri = format!("data:;base64,{}", "A".repeat(600_000));
    let names = |place: &str| {
        vec![("/meshes/0/primitives", many(json!({"attributes": {"POSITION": 0}}), 400))]
            .into_iter()
            .chain([(if place == "node" { "/nodes/0/name" } else { "/meshes/0/name" }, Value::from("n".repeat(10_000)))])
            .collect::<Vec<_>>()
    };
    let repeated = with(&[
        ("/meshes/0/primitives", many(primitive(0), 900)),
        ("/accessors/0", zeros(200, "VEC3")),
        ("/materials", json!([{}])),
    ]);
    let cases: Vec<(&str, &str, Value)> = vec![
        (
            "/buffers/uri, a file",
            "large.bin: /buffers/0/uri: needs 4 MiB for a file",
            with(&[("/buffers/0", json!({"uri": "large.bin", "byteLength": 36}))]),
        ),
        ("/buffers/uri, data", "/buffers/0/uri: needs", with(&[("/buffers/0", json!({"uri": uri, "byteLength": 36}))])),
        (
            "/images/uri, data",
            "m.gltf: ",
            with(&[
                ("/images", json!([{"uri": uri}])),
                ("/textures", json!([{"source": 0}])),
                ("/materials", json!([{"normalTexture": {"index": 0}}])),
                ("/meshes/0/primitives/0", primitive(0)),
            ]),
        ),
        ("/images, its texels", "large.png: /images/0: needs", textured("large.png", "baseColorTexture")),
        ("/images, its normals", "large.png: /images/0: needs", textured("large.png", "normalTexture")),
        ("/accessors/count", "for elements of accessor 0", with_positions(zeros(200_000, "VEC3"))),
        (
            "/accessors/count, decoded",
            "for vertices and triangles",
            with(&[
                ("/buffers/0", json!({"uri": "wide.bin", "byteLength": 1 << 18})),
                ("/bufferViews/0/byteLength", (1 << 18).into()),
                ("/accessors/0", json!({"bufferView": 0, "componentType": 5120, "count": 80_000, "type": "VEC3"})),
                ("/extensionsUsed", json!(["KHR_mesh_quantization"])),
            ]),
        ),
        (
            "/accessors/sparse",
            "for elements of accessor 0",
            with_positions(
                json!({"componentType": 5126, "count": 200_000, "type": "VEC3", "sparse": {"count": 1, "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0}}}),
            ),
        ),
        (
            "/meshes/primitives/indices",
            "for vertices and triangles",
            with(&[
                ("/bufferViews/1", json!({"buffer": 1, "byteLength": 1 << 16})),
                ("/buffers/1", json!({"uri": "wide.bin", "byteLength": 1 << 18})),
                ("/accessors/1", json!({"bufferView": 1, "componentType": 5121, "count": 60_000, "type": "SCALAR"})),
                ("/meshes/0/primitives/0", json!({"attributes": {"POSITION": 0}, "indices": 1, "mode": 5})),
            ]),
        ),
        ("/meshes/primitives, without normals", "for vertices and triangles", with(&[("/accessors/0", zeros(9_000, "VEC3"))])),
        (
            "/meshes/primitives, without tangents",
            "for vertices and triangles",
            with(&[
                ("/accessors/0", zeros(3_000, "VEC3")),
                ("/accessors/1", zeros(3_000, "VEC2")),
                ("/images", json!([{"uri": "small.png"}])),
                ("/textures", json!([{"source": 0}])),
                ("/materials", json!([{"normalTexture": {"index": 0}}])),
                ("/meshes/0/primitives/0", json!({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})),
            ]),
        ),
        ("/meshes/primitives, many", "", repeated),
        ("/meshes/name", "for objects and their names", with(&names("mesh"))),
        ("/nodes/name", "for objects and their names", with(&names("node"))),
        ("/nodes", "for its JSON", with(&[("/nodes", many(json!({}), 5_000))])),
        ("/nodes/children", "for its JSON", with(&[("/nodes/0/children", many(1.into(), 50_000))])),
        ("/scenes/nodes", "for its JSON", with(&[("/scenes/0/nodes", many(0.into(), 50_000))])),
        ("/materials", "for its JSON", with(&[("/materials", many(json!({}), 5_000))])),
        ("/extensionsUsed", "for its JSON", with(&[("/extensionsUsed", many("X".into(), 50_000))])),
        ("/accessors/min", "for its JSON", with(&[("/accessors/0/min", many(0.into(), 50_000))])),
        ("/asset/generator", "for its JSON", with(&[("/asset/generator", "x".repeat(2 << 20).into())])),
    ];
    for (what, part, document) in cases {
        says_so(&error_of(document.to_string().as_bytes(), "m.gltf", &files(), &ViewOptions::default()), what, part);
    }
}

#[test]
fn lights_are_counted_in_every_frame() {
    let light = json!({"extensions": {"KHR_lights_punctual": {"light": 0}}});
    let mut document = with(&[("/extensions", json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}}))]);
    document["nodes"] = Value::Array([vec![json!({"mesh": 0})], vec![light; 100]].concat());
    document["scenes"] = json!([{"nodes": (0..101).collect::<Vec<_>>()}]);
    let view = ViewOptions { frames: Some(1_000), ..ViewOptions::default() };
    let error = error_of(document.to_string().as_bytes(), "m.gltf", &files(), &view);
    says_so(&error, "/nodes/extensions/KHR_lights_punctual", "for frames and their lights");
}

#[test]
fn obj_statement_over_budget_is_refused() {
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
    let face = "f 1/1 2/1 3/1\n";
    let cases = [
        ("v", "for positions", "v 0 0 0\n".repeat(60_000)),
        ("v with colours", "", "v 0 0 0 1 1 1\n".repeat(25_000)),
        ("vt", "for texture coordinates", "vt 0 0\n".repeat(80_000)),
        ("vn", "for normals", "vn 0 0 1\n".repeat(100_000)),
        ("f", "for corners of faces", "f 1 2 3\n".repeat(40_000)),
        ("f, one", "line 5: needs", format!("f{}\n", " 1 2 3".repeat(40_000))),
        (
            "f, each with a vertex of its own",
            "for vertices and triangles",
            (0..6_000).map(|i| format!("vt 0 0\nf 1/{} 2/1 3/1\n", i + 2)).collect(),
        ),
        (
            "o",
            "for groups and their names",
            (0..200).map(|i| format!("usemtl {i}\n{face}")).fold(format!("o {}\n", "n".repeat(9_000)), |a, b| a + &b),
        ),
        ("usemtl", "", (0..4_000).map(|i| format!("usemtl {i}\n{face}")).collect()),
        ("mtllib", "for names of material libraries", "mtllib x\n".repeat(20_000)),
        ("joined lines", "for lines of OBJ text", "f 1 2 \\\n3\n".repeat(60_000)),
        ("newmtl", "large.mtl: needs", format!("mtllib large.mtl\n{face}")),
        ("map_Kd", "large.png: needs", format!("mtllib picture.mtl\nusemtl a\n{face}")),
        ("bump", "large.png: needs", format!("mtllib bump.mtl\nusemtl a\n{face}")),
    ];
    for (what, part, text) in cases {
        let text = format!("{start}{text}{face}");
        says_so(&error_of(text.as_bytes(), "m.obj", &files(), &ViewOptions::default()), what, part);
    }
}

/// A scene keeps the memory of its data. Memory for the import is given back.
#[test]
fn memory_of_the_import_is_given_back() {
    let budget = MemoryPool::new(64 << 20);
    let document = with(&[
        ("/accessors/0", zeros(3_000, "VEC3")),
        ("/images", json!([{"uri": "large.png"}])),
        ("/textures", json!([{"source": 0}])),
        ("/materials", json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])),
        ("/meshes/0/primitives/0", json!({"attributes": {"POSITION": 0}, "material": 0})),
    ]);
    let loaded = load(document.to_string().as_bytes(), "m.gltf", &files(), &ViewOptions::default(), &budget);
    let (scene, held) = loaded.expect("within the budget");
    let texels = 4 * (1024 * 1024 * 4) / 3;
    let mesh = &scene.objects[0].mesh;
    let lists = 12 * mesh.positions.len() + 12 * mesh.normals.len() + 8 * mesh.uv.len() + 4 * mesh.indices.len();
    let beside = held.bytes() - (texels + lists) as u64;
    assert!(beside < 4096, "{beside} bytes beside texels and vertices");
    drop(held);
    assert_eq!(budget.left(), 64 << 20);
}
