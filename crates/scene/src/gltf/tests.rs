//! Whole documents, good and bad.

use super::glb::tests::build;
use crate::files::MemoryFiles;
use crate::picture::tests::png;
use crate::{SceneError, ViewOptions, load};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_input::MemoryPool;
use basrelief_signals::{LightKind, Scene, ShadingMode, ShadingSettings, TexelFilter, WrapMode};
use proptest::prelude::*;
use serde_json::{Value, json};

const UV: [[f32; 2]; 4] = [[0., 1.], [1., 1.], [1., 0.], [0., 0.]];

fn bytes<T: Copy, const N: usize>(list: &[T], to_bytes: fn(T) -> [u8; N]) -> Vec<u8> {
    list.iter().flat_map(|v| to_bytes(*v)).collect()
}

fn floats(list: &[f32]) -> Vec<u8> {
    bytes(list, f32::to_le_bytes)
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

/// A square in the xy plane, u to the right and v down, with two textures, a camera and a light.
fn square() -> Value {
    let positions = floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]);
    let uv = floats(UV.as_flattened());
    let indices = bytes(&[0u16, 1, 2, 0, 2, 3], u16::to_le_bytes);
    let all: Vec<u8> = [positions, floats(&[0., 0., 1.].repeat(4)), uv, indices].concat();
    let picture = png(2, 2, |x, y| [(200 * x) as u8, (100 * y) as u8, 255, 255]);
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3.0, "color": [1, 0, 0]}]}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"name": "root", "translation": [0, 0, 5], "children": [1, 2, 3]},
            {"name": "square", "mesh": 0, "scale": [2, 2, 2], "extras": {"basrelief": {"entries": 16}}},
            {"camera": 0, "translation": [0.5, 0.5, 10]},
            {"rotation": [0, 3, 0, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}],
        "materials": [{
            "name": "both",
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {"index": 0}},
            "normalTexture": {"index": 0, "scale": 0.5},
            "extras": {"basrelief": {"entries": 8, "bump": true}}
        }],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}],
        "images": [{"bufferView": 4, "mimeType": "image/jpeg"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 48},
            {"buffer": 0, "byteOffset": 96, "byteLength": 32},
            {"buffer": 0, "byteOffset": 128, "byteLength": 12},
            {"buffer": 1, "byteLength": picture.len()}
        ],
        "buffers": [{"byteLength": all.len(), "uri": data_uri(&all)}, {"byteLength": picture.len(), "uri": data_uri(&picture)}]
    })
}

fn load_scene(bytes: &[u8], name: &str) -> Result<Scene, SceneError> {
    load(bytes, name, &MemoryFiles::default(), &ViewOptions::default(), &MemoryPool::default()).map(|(scene, _)| scene)
}

fn import(document: &Value) -> Result<Scene, SceneError> {
    load_scene(document.to_string().as_bytes(), "m.gltf")
}

/// The document with the value at a pointer replaced; a missing key of an object is added.
fn with(mut document: Value, pointer: &str, value: Value) -> Value {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match document.pointer_mut(parent).unwrap() {
        Value::Object(map) => drop(map.insert(key.into(), value)),
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = value,
        _ => panic!("{parent} has no parts"),
    }
    document
}

/// A copy of the square with another buffer, a view over it, and an accessor that the attribute then uses.
fn with_attribute(name: &str, data: &[u8], view: Value, accessor: Value) -> Value {
    with_attribute_of(square(), name, data, view, accessor)
}

/// The document with one more attribute, as in [`with_attribute`].
fn with_attribute_of(mut document: Value, name: &str, data: &[u8], view: Value, accessor: Value) -> Value {
    let mut push = |list: &str, value: Value| {
        let list = document[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    };
    let buffer = push("buffers", json!({"byteLength": data.len(), "uri": data_uri(data)}));
    let merge = |mut base: Value, more: Value| {
        base.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        base
    };
    let view = push("bufferViews", merge(json!({"buffer": buffer, "byteLength": data.len()}), view));
    let accessor = push("accessors", merge(json!({"bufferView": view, "count": 4}), accessor));
    with(document, &format!("/meshes/0/primitives/0/attributes/{name}"), json!(accessor))
}

fn refuses(document: &Value, part: &str) {
    let error = import(document).err().unwrap_or_else(|| panic!("accepted, expected: {part}")).to_string();
    assert!(error.starts_with("m.gltf: ") && error.contains(part), "{error}\nexpected {part}");
}

#[test]
fn square_is_imported_completely() {
    let scene = import(&square()).unwrap();
    let [object] = &scene.objects[..] else { panic!("one object") };
    assert_eq!(object.name, "square");
    assert_eq!((object.entries, object.bump), (Some(16), Some(true)), "the node's word goes before the material's");
    assert_eq!(object.world, [2., 0., 0., 0., 0., 2., 0., 0., 0., 0., 2., 5., 0., 0., 0., 1.]);
    assert_eq!(object.mesh.indices, [0, 1, 2, 0, 2, 3]);
    assert_eq!(object.mesh.uv, UV);
    assert_eq!(object.mesh.tangents, [[1., 0., 0., 1.]; 4]);
    let material = &object.material;
    assert_eq!((material.base_color, material.normal_scale, material.double_sided), ([0.5, 1., 1., 1.], 0.5, false));
    let (color, map) = (material.color_texture.as_ref().unwrap(), material.normal_map.as_ref().unwrap());
    assert_eq!((color.sampler.wrap, color.sampler.filter), ([WrapMode::Clamp, WrapMode::Mirror], TexelFilter::Nearest));
    assert_ne!(color.id, map.id, "one picture, two uses, two textures");
    assert_eq!((color.levels.len(), color.levels[1].texels[0]), (2, [100, 50, 255, 255]));
    assert!(scene.warnings.iter().any(|w| w.contains("Rec. 709")), "{:?}", scene.warnings);
}

#[test]
fn camera_and_light_of_file_are_used() {
    let frame = import(&square()).unwrap().frames[0].clone();
    // The camera stands at (0.5, 0.5, 15), the square's centre at (1, 1, 5).
    let to_viewer = glam::DVec3::from_array(frame.camera.to_viewer);
    assert!((to_viewer - glam::DVec3::new(-0.5, -0.5, 10.0).normalize()).length() < 1e-12);
    // A quarter turn around y brings the node's z axis, opposite to the light's way, to +x.
    let LightKind::Directional { to_light } = frame.lights[0].kind else { panic!("directional") };
    assert!((to_light[0] - 1.0).abs() < 1e-6);
    assert_eq!(frame.lights[0].intensity, 1.0, "the strongest is scaled to 1");
}

#[test]
fn dark_lights_and_cut_sides_are_warnings() {
    let warns = |document: &Value, of: &str| import(document).unwrap().warnings.iter().any(|warning| warning.contains(of));
    let light = |field: &str, value| with(square(), &format!("/extensions/KHR_lights_punctual/lights/0/{field}"), value);
    let dark = "all lights of the file are dark: the default light is used";
    assert!(!warns(&square(), dark) && warns(&light("intensity", json!(0)), dark));
    assert!(warns(&light("color", json!([0, 0, 0])), dark));
    let lights = with(square(), "/extensions/KHR_lights_punctual/lights", json!([{"type": "point", "range": 3}]));
    assert!(warns(&lights, "`range` of lights is not used"));
    let falloff = "point lights have no falloff with distance";
    assert!(warns(&lights, falloff) && !warns(&square(), falloff), "a directional light has none in glTF either");
    let spot = with(square(), "/extensions/KHR_lights_punctual/lights", json!([{"type": "spot"}]));
    assert!(
        warns(&spot, falloff) && !warns(&with(spot, "/extensions/KHR_lights_punctual/lights/0/intensity", json!(0)), falloff)
    );
    assert!(warns(&lights, "one direction for each object"));
    // The image is 4 to 3.
    let orthographic =
        |xmag, ymag| json!([{"type": "orthographic", "orthographic": {"xmag": xmag, "ymag": ymag, "znear": 0, "zfar": 9}}]);
    let cut = |xmag, ymag| warns(&with(square(), "/cameras", orthographic(xmag, ymag)), "cuts its sides off");
    assert!(cut(-4, 2) && !cut(4, 3) && !cut(1, 2));
    let wide = json!([{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.8}}]);
    assert!(warns(&with(square(), "/cameras", wide), "is 1.35 times as wide as the image"));
}

#[test]
fn strength_of_light_stays_finite() {
    let light =
        |kind: &str| with(square(), "/extensions/KHR_lights_punctual/lights/0", json!({"type": kind, "intensity": 1e308}));
    let strong = with(light("directional"), "/extensions/KHR_lights_punctual/lights/0/color", json!([10, 10, 10]));
    refuses(&strong, "/nodes/3: its light is infinitely strong at the model's centre");
    // The light is 1e-160 from the centre of the square.
    let near =
        with(with(light("point"), "/nodes/0/translation", json!([-1, -1, 0])), "/nodes/3/translation", json!([1, 1, 1e-160]));
    assert_eq!(import(&near).unwrap().frames[0].lights[0].intensity, 1.0);
}

#[test]
fn meshes_and_textures_are_shared() {
    let mut document = with(square(), "/nodes/0/children", json!([1, 2, 3, 4]));
    document["nodes"].as_array_mut().unwrap().push(json!({"mesh": 1}));
    let second = document["materials"][0].clone();
    document["materials"].as_array_mut().unwrap().push(second);
    let mut mesh = document["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(1);
    document["meshes"].as_array_mut().unwrap().push(mesh);
    document["nodes"][2] = json!({"mesh": 0, "camera": 0});
    let scene = import(&document).unwrap();
    let [a, b, c] = &scene.objects[..] else { panic!("three objects") };
    assert!(std::sync::Arc::ptr_eq(&a.mesh, &b.mesh));
    assert_ne!(a.material.id, c.material.id);
    let map = |o: &basrelief_signals::Object| o.material.normal_map.clone().unwrap();
    assert!(std::sync::Arc::ptr_eq(&map(a), &map(c)));
}

#[test]
fn quantized_and_strided_attributes_are_read() {
    let tight = [[0u8, 255], [255, 255], [255, 0], [0, 0]];
    let padded: Vec<u8> = tight.iter().flat_map(|[u, v]| [*u, *v, 9, 9]).collect();
    let accessor = json!({"componentType": 5121, "normalized": true, "type": "VEC2"});
    let document = with_attribute("TEXCOORD_0", &padded, json!({"byteStride": 4}), accessor.clone());
    assert_eq!(import(&document).unwrap().objects[0].mesh.uv, UV);
    refuses(&with_attribute("TEXCOORD_0", &padded, json!({"byteStride": 1}), accessor), "/bufferViews/5/byteStride: is 1");

    let shorts = bytes(&[0i16, 0, 0, 9, 50, 0, 0, 9, 50, 50, 0, 9, 0, 50, 0, 9], i16::to_le_bytes);
    let document = with_attribute("POSITION", &shorts, json!({"byteStride": 8}), json!({"componentType": 5122, "type": "VEC3"}));
    refuses(&document, "with KHR_mesh_quantization");
    let document = with(document, "/extensionsUsed", json!(["KHR_mesh_quantization"]));
    let document = with(document, "/extensionsRequired", json!(["KHR_mesh_quantization"]));
    assert_eq!(import(&document).unwrap().objects[0].mesh.positions[2], [50., 50., 0.]);
}

/// The square with a skin. Its attributes hold these joints and weights.
fn skinned(joints: (&[u8], Value), weights: (&[u8], Value)) -> Value {
    let mut document = with(with(square(), "/skins", json!([{"joints": [0]}])), "/nodes/1/skin", json!(0));
    for (name, (data, accessor)) in [("JOINTS_0", joints), ("WEIGHTS_0", weights)] {
        document = with_attribute_of(document, name, data, json!({}), accessor);
    }
    document
}

#[test]
fn joints_and_weights_must_fit_positions() {
    let joints = || (&[0; 16][..], json!({"componentType": 5121, "type": "VEC4"}));
    let ones = floats(&[1., 0., 0., 0.].repeat(4));
    let weights = |count: usize| (&ones[..16 * count], json!({"componentType": 5126, "type": "VEC4", "count": count}));
    assert!(import(&skinned(joints(), weights(4))).is_ok());
    let expected = "/attributes/WEIGHTS_0: accessor 5 has 3 elements; expected 4, as many as POSITION";
    refuses(&skinned(joints(), weights(3)), expected);
    let few = (&[0; 12][..], json!({"componentType": 5121, "type": "VEC4", "count": 3}));
    refuses(&skinned(few, weights(4)), "/attributes/JOINTS_0: accessor 4 has 3 elements; expected 4");
    let float = (&ones[..], json!({"componentType": 5126, "type": "VEC4"}));
    refuses(&skinned(float, weights(4)), "JOINTS_0: accessor 4 is VEC4 of float; expected VEC4 of unsigned byte or short");
    let plain = (&[1; 16][..], json!({"componentType": 5121, "type": "VEC4"}));
    refuses(&skinned(joints(), plain), "WEIGHTS_0: accessor 5 is VEC4 of unsigned byte; expected VEC4 of float, normalized");
}

/// All primitives share two large accessors, which took minutes to decode again for each.
#[test]
fn primitives_without_triangles_are_skipped_fast() {
    let zeros = |component: u32, kind: &str, count: u32| json!({"componentType": component, "type": kind, "count": count});
    let mut document = square();
    let accessors = [zeros(5126, "VEC3", 1 << 20), zeros(5125, "SCALAR", 1 << 20), zeros(5125, "SCALAR", 1)];
    document["accessors"].as_array_mut().unwrap().extend(accessors);
    let primitives = document["meshes"][0]["primitives"].as_array_mut().unwrap();
    for i in 0..6000 {
        primitives.push(json!({"attributes": {"POSITION": 4}, "indices": 5 + i % 2}));
    }
    let began = std::time::Instant::now();
    assert_eq!(import(&document).unwrap().objects.len(), 1);
    assert!(began.elapsed().as_secs() < 10, "{:?}", began.elapsed());
}

#[test]
fn sparse_values_replace_zeros_and_data() {
    let mut sparse: Vec<u8> = bytes(&[1u32, 3], u32::to_le_bytes);
    sparse.extend(floats(&[7., 8., 9., 0., 1., 0.]));
    let part =
        json!({"count": 2, "indices": {"bufferView": 5, "componentType": 5125}, "values": {"bufferView": 5, "byteOffset": 8}});
    let accessor = json!({"componentType": 5126, "type": "VEC3", "sparse": part});
    let mut document = with_attribute("POSITION", &sparse, json!({}), accessor);
    document["accessors"][4]["bufferView"] = json!(0);
    let positions = |d: &Value| import(d).unwrap().objects[0].mesh.positions.clone();
    assert_eq!(positions(&document), [[0., 0., 0.], [7., 8., 9.], [1., 1., 0.], [0., 1., 0.]]);
    document["accessors"][4].as_object_mut().unwrap().remove("bufferView");
    assert_eq!(positions(&document)[..3], [[0., 0., 0.], [7., 8., 9.], [0., 0., 0.]]);
    refuses(&with(document.clone(), "/accessors/4/count", json!(1u64 << 40)), "without a buffer view");
    refuses(&with(document.clone(), "/accessors/4/sparse/count", json!(3)), "/accessors/4/sparse/");
    refuses(&with(document, "/accessors/4/sparse/indices/byteOffset", json!(4)), "strictly increasing");
}

#[test]
fn without_normals_faces_are_flat_and_vertices_split() {
    let mut document = square();
    document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("NORMAL");
    let mesh = import(&document).unwrap().objects[0].mesh.clone();
    assert_eq!((mesh.positions.len(), &mesh.normals), (6, &vec![[0., 0., 1.]; 6]));
    assert_eq!(mesh.tangents, [[1., 0., 0., 1.]; 6]);
}

#[test]
fn colour_texture_and_normal_map_may_use_different_coordinates() {
    let other = floats(&[0.5; 8]);
    let document = with_attribute("TEXCOORD_1", &other, json!({}), json!({"componentType": 5126, "type": "VEC2"}));
    let info = json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": {"offset": [1, 2], "scale": [2, 4]}}});
    let document = with(document, "/materials/0/pbrMetallicRoughness/baseColorTexture", info);
    let mesh = import(&document).unwrap().objects[0].mesh.clone();
    assert_eq!((&mesh.uv[..], &mesh.uv_normal[..]), (&[[2., 4.]; 4][..], &UV[..]));
}

#[test]
fn vertex_colours_of_three_components_are_opaque() {
    let accessor = json!({"componentType": 5123, "normalized": true, "type": "VEC3"});
    let colors = bytes(&[65535u16, 0, 0, 0].repeat(4), u16::to_le_bytes);
    let mesh = import(&with_attribute("COLOR_0", &colors, json!({"byteStride": 8}), accessor)).unwrap().objects[0].mesh.clone();
    assert_eq!(mesh.colors, [[1., 0., 0., 1.]; 4]);
}

#[test]
fn faults_are_named_with_their_pointer() {
    let set = |pointer: &str, value: Value| with(square(), pointer, value);
    refuses(&set("/nodes/1/children", json!([0])), "/nodes/0: is its own ancestor");
    refuses(&set("/nodes/1/children", json!([2])), "/nodes/1/children/0: node 2 has a parent already");
    refuses(&set("/scenes/0/nodes", json!([1])), "/scenes/0/nodes/0: node 1 is a child");
    refuses(&set("/nodes/0/children/0", json!(7)), "/nodes/0/children/0: refers to element 7 of /nodes");
    refuses(&set("/extensionsRequired", json!(["KHR_draco_mesh_compression"])), "`KHR_draco_mesh_compression`");
    refuses(&set("/accessors/3/count", json!(600)), "/accessors/3/count: 600 elements");
    refuses(&set("/accessors/0/count", json!(u64::MAX)), "/accessors/0/count");
    refuses(&set("/accessors/0/byteOffset", json!(u64::MAX)), "/accessors/0/count");
    refuses(&set("/accessors/0/type", json!("VEC4")), "/accessors/0/count");
    refuses(&set("/accessors/2/count", json!(3)), "/meshes/0/primitives/0/attributes/TEXCOORD_0: accessor 2 has 3 elements");
    refuses(&set("/bufferViews/0/byteLength", json!(4096)), "/bufferViews/0/byteLength");
    refuses(&set("/buffers/0/byteLength", json!(4096)), "/buffers/0/byteLength");
    refuses(&set("/buffers/0/uri", json!("missing.bin")), "/buffers/0/uri: cannot read `missing.bin`");
    refuses(&set("/buffers/0/uri", json!("../../x.bin")), "/buffers/0/uri: cannot read `../../x.bin`");
    refuses(&set("/buffers/0/uri", json!("https://example.org/x.bin")), "is a URL");
    refuses(&set("/samplers/0/wrapS", json!(1)), "/samplers/0/wrapS: wrap mode 1");
    refuses(&set("/cameras/0/perspective/znear", json!(-1)), "/cameras/0/perspective/znear");
    refuses(&set("/nodes/1/rotation", json!([0, 0, 0, 0])), "/nodes/1/rotation");
    let huge = || json!([1e308, 1e308, 1e308]);
    refuses(&with(set("/nodes/1/scale", huge()), "/nodes/0/scale", huge()), "/nodes/1: its world matrix overflows");
    refuses(&set("/meshes/0/primitives/0/mode", json!(9)), "/meshes/0/primitives/0/mode");
    refuses(&set("/meshes/0/primitives/0/indices", json!(0)), "accessor 0 is VEC3 of float");
    refuses(&set("/materials/0/pbrMetallicRoughness/baseColorFactor", json!([1, 1, 2, 1])), "baseColorFactor");
    refuses(&set("/nodes/1/mesh", json!(null)), "nothing to draw");
    refuses(&set("/nodes/1/extras", json!({"basrelief": {"entires": 1}})), "unknown field `entires`");
}

#[test]
fn extras_set_mode_ia_and_is_by_scene_material_and_node() {
    let set = |pointer: &str, value: Value| with(square(), pointer, value);
    let says = |shading: Value| json!({"basrelief": {"shading": shading}});
    let of_scene =
        with(set("/scenes/0/extras", says(json!({"ia": 0.5}))), "/materials/0/extras", says(json!({"is": 2, "mode": "normal"})));
    let scene = import(&with(of_scene, "/nodes/1/extras", says(json!({"mode": "polyhedron"})))).unwrap_or_else(|e| panic!("{e}"));
    let none = ShadingSettings::default();
    assert_eq!(scene.frames[0].shading, ShadingSettings { ia: Some(0.5), ..none });
    assert_eq!(scene.objects[0].shading, ShadingSettings { mode: Some(ShadingMode::Polyhedron), is: Some(2.0), ..none });
    refuses(&set("/nodes/1/extras", says(json!({"ia": 17}))), "expected 0..=16");
}

#[test]
fn omissions_are_warnings() {
    let says = |document: Value, part: &str| {
        let warnings = import(&document).unwrap_or_else(|e| panic!("{e}")).warnings;
        assert!(warnings.iter().any(|w| w.contains(part)), "{warnings:?}");
    };
    says(with(square(), "/materials/0/alphaMode", json!("BLEND")), "alphaMode BLEND");
    says(with(square(), "/animations", json!([{}])), "animations are ignored");
    says(with(square(), "/extensionsUsed", json!(["KHR_materials_unlit"])), "`KHR_materials_unlit` is not supported");
    let skinned = with(with(square(), "/skins", json!([{"joints": [0]}])), "/nodes/1/skin", json!(0));
    says(skinned, "has no JOINTS_0");
    let mut lines = square();
    let mut primitive = lines["meshes"][0]["primitives"][0].clone();
    primitive["mode"] = json!(1);
    lines["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    says(lines, "points or lines");
    let basisu = json!({"source": 0, "extensions": {"KHR_texture_basisu": {"source": 0}}});
    says(with(square(), "/textures/0", basisu), "`KHR_texture_basisu`");
    says(with(square(), "/textures/0", json!({"extensions": {"EXT_texture_webp": {"source": 0}}})), "drawn without it");
    let spot = json!({"KHR_lights_punctual": {"lights": [{"type": "spot"}]}});
    says(with(square(), "/extensions", spot), "spot light");
}

/// Vertex colours and lights do not change the colour of a glTF surface that only emits.
#[test]
fn emission_has_neither_vertex_colours_nor_highlight() {
    let colored = with_attribute("COLOR_0", &floats(&[0.5; 16]), json!({}), json!({"componentType": 5126, "type": "VEC4"}));
    let colors = |document: &Value| import(document).unwrap().objects[0].mesh.colors.clone();
    assert_eq!(colors(&colored), [[0.5; 4]; 4]);
    let black = json!({"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [0.5, 0.25, 0]});
    let emits = with(colored, "/materials/0", black);
    assert_eq!(colors(&emits), [[0f32; 4]; 0]);
    let material = import(&emits).unwrap().objects[0].material.clone();
    assert_eq!(material.base_color, [0.5, 0.25, 0.0, 1.0]);
    assert_eq!((material.lighting.ka, material.lighting.kd, material.lighting.ks), (1.0, 0.0, 0.0));
}

#[test]
fn keys_that_gltf_does_not_define_are_warnings() {
    let unknown = |place: &str, value: Value| {
        let warnings = import(&with(square(), place, value)).unwrap().warnings;
        let ends = warnings.iter().filter_map(|warning| {
            warning.strip_suffix(": glTF 2.0 does not define this key, so it is ignored; check its spelling")
        });
        ends.map(str::to_owned).collect::<Vec<_>>()
    };
    for place in
        ["/material", "/materials/0/pbrMetallicRoughness/baseColourFactor", "/nodes/3/extensions/KHR_lights_punctual/lamp"]
    {
        assert_eq!(unknown(place, json!([1, 0, 0, 1])), [place]);
    }
    for (place, value) in [
        ("/asset/generator", json!("a program")),
        ("/materials/0/pbrMetallicRoughness/metallicFactor", json!(0)),
        ("/materials/0/extensions", json!({"KHR_materials_ior": {"ior": 2}})),
        ("/meshes/0/extras", json!({"anything": [{"at": "all"}]})),
        ("/animations", json!([{"channels": [], "samplers": []}])),
    ] {
        assert_eq!(unknown(place, value), [""; 0], "{place}");
    }
}

#[test]
fn undeclared_extensions_are_warnings() {
    for place in ["/meshes/0/primitives/0", "/nodes/1", "/bufferViews/0", "/materials/0/normalTexture", ""] {
        let mut document = square();
        document.pointer_mut(place).unwrap()["extensions"]["XY_other"] = json!({"a": 1});
        let warnings = import(&document).unwrap().warnings;
        let other: Vec<_> = warnings.iter().filter(|warning| warning.contains("XY_other")).collect();
        assert_eq!(other, ["the extension `XY_other` is not supported: drawn without it"], "{place}");
    }
    let misplaced = with(square(), "/meshes/0/primitives/0/extensions", json!({"KHR_node_visibility": {}}));
    let message = "/meshes/0/primitives/0/extensions/KHR_node_visibility: this extension has no meaning here, so it is ignored";
    assert!(import(&misplaced).unwrap().warnings.iter().any(|warning| warning == message));
}

#[test]
fn unused_filters_of_samplers_are_one_warning() {
    let unused = "filters of samplers (`magFilter`, `minFilter`) are not used";
    let count = |sampler: Value| {
        let scene = import(&with(square(), "/samplers/0", sampler)).unwrap();
        scene.warnings.iter().filter(|warning| warning.contains(unused)).count()
    };
    for min in [9728, 9729, 9984, 9985, 9986] {
        assert_eq!(count(json!({"minFilter": min})), 1, "{min}");
    }
    assert_eq!(count(json!({"minFilter": 9728, "magFilter": 9728})), 1);
    assert_eq!(count(json!({"minFilter": 9987, "magFilter": 9728})), 1);
    assert_eq!(count(json!({"minFilter": 9987, "magFilter": 9729})), 0);
    assert_eq!(count(json!({})), 0);
}

#[test]
fn invisible_nodes_are_not_drawn() {
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    refuses(&with(square(), "/nodes/0/extensions", hidden), "nothing to draw");
}

/// Visibility affects meshes and lights, but not cameras (KHR_node_visibility).
#[test]
fn hidden_node_keeps_camera_and_loses_light() {
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    let seen = import(&square()).unwrap().frames[0].camera;
    assert_ne!(import(&with(square(), "/nodes/2/camera", json!(null))).unwrap().frames[0].camera.to_viewer, seen.to_viewer);
    let camera = with(square(), "/nodes/2/extensions", hidden.clone());
    assert_eq!(import(&camera).unwrap().frames[0].camera, seen);
    // The parent hides its child.
    let parent = json!({"children": [2], "translation": [0, 0, 5], "extensions": hidden});
    let mut below = with(with(square(), "/nodes/0/children", json!([1, 3])), "/scenes/0/nodes", json!([0, 4]));
    below["nodes"].as_array_mut().unwrap().push(parent);
    assert_eq!(import(&below).unwrap().frames[0].camera, seen);
    let mut light = square();
    light["nodes"][3]["extensions"]["KHR_node_visibility"] = json!({"visible": false});
    let default = import(&light).unwrap().frames[0].camera.to_light;
    assert!((default[0] - 1.0).abs() > 0.1, "{default:?}");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let accessor = json!({"componentType": 5126, "type": "VEC3"});
    let document = with_attribute("POSITION", &floats(&[f32::NAN; 12]), json!({}), accessor);
    refuses(&document, "/accessors/4: element 0 is");
}

#[test]
fn vertices_far_from_origin_of_mesh_are_a_warning() {
    let moved = |x: f32| {
        let corners = [[0f32, 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].map(|[a, b, c]| [a + x, b, c]);
        let accessor = json!({"componentType": 5126, "type": "VEC3"});
        with_attribute("POSITION", &floats(corners.as_flattened()), json!({}), accessor)
    };
    let warning = |document: &Value| {
        let warnings = import(document).unwrap().warnings;
        warnings.into_iter().find(|warning| warning.starts_with("vertices are"))
    };
    // The diagonal is the root of 2, so the bound of 819.2 sizes is at 1158.5.
    assert_eq!(warning(&moved(1150.0)), None);
    let expected = "vertices are 820 times the model's size away from the origin of their mesh, and single precision moves them \
        by about 0.06 pixels in an image of 640 pixels; move the mesh to the origin, and give its place to a node";
    assert_eq!(warning(&moved(1159.0)).as_deref(), Some(expected));
    // A node at the same place costs nothing: matrices are multiplied in double precision.
    assert_eq!(warning(&with(square(), "/nodes/0/translation", json!([1e9, 0, 0]))), None);
    let back = with(moved(1159.0), "/nodes/0/translation", json!([-1159, 0, 0]));
    assert_eq!(warning(&back).as_deref(), Some(expected), "the error is that of the mesh, not of the model");
}

#[test]
fn a_list_is_no_object() {
    let list = "a list stands here, expected an object";
    refuses(&with(square(), "/asset", json!(["2.0", null])), list);
    refuses(&with(square(), "/nodes/0", json!([])), list);
    refuses(&with(square(), "/cameras/0/perspective", json!([0.8, 0.1, null])), list);
    refuses(&with(square(), "/bufferViews/0", json!([0, 0, 48, null])), "/bufferViews/0 (line 1, column");
}

/// glTF 2.0 forbids these, but they have one meaning. They are drawn with a warning that names place, value and expectation.
#[test]
fn invalid_but_clear_values_are_drawn_with_a_warning() {
    let plain = import(&square()).unwrap();
    let warns = |document: &Value, sentence: &str| {
        let scene = import(document).unwrap_or_else(|e| panic!("{e}"));
        let new: Vec<_> = scene.warnings.iter().filter(|w| !plain.warnings.contains(w)).collect();
        assert!(new.iter().any(|w| w.starts_with(sentence)), "{new:#?}\nexpected {sentence}");
        assert_eq!(scene.objects[0].mesh.positions, plain.objects[0].mesh.positions);
    };
    let corners = [[0f32, 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    let at = |start: usize, stride: usize| {
        let mut data = vec![0; start + 4 * stride];
        for (i, corner) in corners.iter().enumerate() {
            data[start + i * stride..][..12].copy_from_slice(&floats(corner));
        }
        data
    };
    let accessor = |offset: usize| json!({"componentType": 5126, "type": "VEC3", "byteOffset": offset});
    let odd = with_attribute("POSITION", &at(2, 12), json!({}), accessor(2));
    warns(&odd, "/accessors/4/byteOffset: is 2 in a buffer view that begins at byte 0, expected both together and it alone");
    for stride in [13, 256] {
        let strided = with_attribute("POSITION", &at(0, stride), json!({"byteStride": stride}), accessor(0));
        warns(&strided, &format!("/bufferViews/5/byteStride: is {stride}, expected a multiple of 4 in 4..=252"));
    }
    let long = with(square(), "/nodes/1/rotation", json!([0, 0, 0, 3]));
    warns(&long, "/nodes/1/rotation: quaternion of length 3, expected 1");
    warns(&with(square(), "/accessors/0/max", json!([1, 5, 0])), "/accessors/0/max/1: is 5, expected 1, as in the data");
    warns(&with(square(), "/accessors/0/min", json!([0, 0])), "/accessors/0/min: holds 2 numbers, expected 3");
    warns(&with(square(), "/accessors/3/max", json!([7])), "/accessors/3/max/0: is 7, expected 3, as in the data");
    warns(&with(square(), "/bufferViews/3/byteStride", json!(2)), "/bufferViews/3/byteStride: is 2, expected none");
    let right = with(with(square(), "/accessors/0/max", json!([1, 1, 0])), "/accessors/0/min", json!([0, 0, 0]));
    assert_eq!(import(&right).unwrap(), plain, "what is right is passed over in silence");
}

/// glTF 2.0 forbids these, and readers differ in their meaning.
#[test]
fn ambiguous_values_are_refused() {
    let beside = with(square(), "/nodes/0/matrix", json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]));
    refuses(&beside, "/nodes/0/matrix: stands beside `translation`, and readers differ in which they take; expected either");
    let indices: Vec<u8> = [0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| [i.to_le_bytes(), [0; 2]].concat()).collect();
    let accessor = json!({"componentType": 5123, "count": 6, "type": "SCALAR"});
    let mut document = with_attribute("indices", &indices, json!({"byteStride": 4}), accessor);
    document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("indices");
    document["meshes"][0]["primitives"][0]["indices"] = json!(4);
    refuses(
        &document,
        "/bufferViews/5/byteStride: is 4, and /accessors/4, which lies in it, holds indices; expected no byteStride",
    );
}

/// Columns of a matrix of bytes begin at multiples of four; behind the last one nothing need follow.
#[test]
fn byte_matrix_needs_no_final_padding() {
    let of = |bytes: &[u8], count: usize, component: u32, kind: &str| {
        let accessor = json!({"componentType": component, "count": count, "type": kind});
        let mut document = with_attribute("_MATRIX", bytes, json!({}), accessor);
        document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("_MATRIX");
        document
    };
    let matrix = |bytes: &[u8], count| of(bytes, count, 5121, "MAT2");
    assert!(import(&matrix(&[1; 6], 1)).is_ok() && import(&matrix(&[1; 14], 2)).is_ok());
    assert!(import(&of(&[1; 23], 2, 5120, "MAT3")).is_ok() && import(&of(&[1; 46], 2, 5123, "MAT3")).is_ok());
    refuses(&of(&[1; 22], 2, 5120, "MAT3"), "/accessors/4/count");
    refuses(&of(&[1; 45], 2, 5123, "MAT3"), "/accessors/4/count");
    refuses(&matrix(&[1; 5], 1), "/accessors/4/count");
    refuses(&matrix(&[1; 13], 2), "/accessors/4/count");
}

/// The square as a GLB: its first buffer is the BIN chunk.
fn square_glb() -> Vec<u8> {
    let mut document = square();
    let uri = document["buffers"][0]["uri"].take();
    document["buffers"][0].as_object_mut().unwrap().remove("uri");
    let bin = STANDARD.decode(uri.as_str().unwrap().rsplit(',').next().unwrap()).unwrap();
    build(&document.to_string(), Some(&bin))
}

#[test]
fn glb_gives_same_scene_as_gltf() {
    let glb = load_scene(&square_glb(), "m.gltf").unwrap();
    assert_eq!(glb, import(&square()).unwrap());
}

#[test]
fn every_truncation_of_a_glb_is_an_error() {
    let whole = square_glb();
    for end in 0..whole.len() {
        let cut = load_scene(&whole[..end], "cut.glb");
        assert!(cut.is_err(), "cut at {end} of {}", whole.len());
    }
}

/// Pointers of all values of a document.
fn pointers(value: &Value, prefix: String, all: &mut Vec<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| pointers(v, format!("{prefix}/{k}"), all)),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| pointers(v, format!("{prefix}/{i}"), all)),
        _ => {}
    }
    if !prefix.is_empty() {
        all.push(prefix);
    }
}

fn odd_value() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(json!(null)),
        Just(json!([])),
        Just(json!({})),
        Just(json!("x")),
        Just(json!(true)),
        Just(json!("data:;base64,AAAA")),
        Just(json!(1e308)),
        Just(json!(-1e308)),
        Just(json!(u64::MAX)),
        Just(json!(-1)),
        Just(json!(0.5)),
        Just(json!([0, 0, 0])),
        (0u64..10).prop_map(|n| json!(n)),
        (5120u64..5127).prop_map(|n| json!(n)),
        (0u32..64).prop_map(|n| json!(1u64 << n)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Changed in a few places, a document is imported or refused with a message, but never a panic.
    #[test]
    fn mutated_documents_never_panic(changes in proptest::collection::vec((any::<prop::sample::Index>(), odd_value()), 1..4)) {
        let mut document = square();
        for (place, value) in changes {
            let mut all = Vec::new();
            pointers(&document, String::new(), &mut all);
            if all.is_empty() { break; }
            *document.pointer_mut(place.get::<String>(&all)).unwrap() = value;
        }
        if let Err(e) = import(&document) {
            prop_assert!(e.to_string().starts_with("m.gltf: ") || !e.file.is_empty());
        }
    }

    #[test]
    fn flipped_bytes_of_a_glb_never_panic(flips in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = square_glb();
        for (place, value) in flips {
            *place.get_mut(&mut bytes) = value;
        }
        let _ = load_scene(&bytes, "m.glb");
    }
}
