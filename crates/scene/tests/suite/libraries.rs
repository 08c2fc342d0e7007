//! Reasons for own readers of glTF and OBJ: faults of `gltf` and `tobj`, one test each.
//!
//! A test that fails here is good news: the library has mended that fault. Weigh again then whether it can take the place
//! of our reader (docs/adr/0033-gltf-and-obj-readers-are-our-own.md), and take the test away.

use basrelief_input::MemoryPool;
use basrelief_scene::{MemoryFiles, ViewOptions, load};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Asserts that a library still has a fault, and says how to react if it is mended.
#[track_caller]
fn still(fault: bool, what: &str) {
    assert!(fault, "mended: {what}; weigh the library again (docs/adr/0033) and take this test away");
}

fn ours(name: &str, bytes: &[u8]) -> Result<(), String> {
    load(bytes, name, &MemoryFiles::default(), &ViewOptions::default(), &MemoryPool::default())
        .map(drop)
        .map_err(|e| e.to_string())
}

/// A triangle in a buffer of a GLB; `element` is a vertex.
fn triangle(element: [&[u8]; 3], component: u32, accessor: Value) -> (Value, Vec<u8>) {
    let stride = element[0].len().next_multiple_of(4);
    let bin: Vec<u8> = element.iter().flat_map(|e| [e, &[0u8; 4][..stride - e.len()]].concat()).collect();
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": component, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": bin.len(), "byteStride": stride}], "buffers": [{"byteLength": bin.len()}]
    });
    document["accessors"][0].as_object_mut().unwrap().extend(accessor.as_object().unwrap().clone());
    (document, bin)
}

fn float_triangle(accessor: Value) -> (Value, Vec<u8>) {
    let corner = |x: f32, y: f32| [x, y, 0.0].map(f32::to_le_bytes).concat();
    triangle([&corner(0., 0.), &corner(1., 0.), &corner(0., 1.)], 5126, accessor)
}

fn glb((document, bin): &(Value, Vec<u8>)) -> Vec<u8> {
    let json = document.to_string();
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat();
    let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", bin)].concat();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

fn root(document: &Value) -> Result<gltf::json::Root, String> {
    gltf::json::deserialize::from_str(&document.to_string()).map_err(|e| e.to_string())
}

/// Vertices as `gltf` reads them; a panic is an error.
fn read_positions((document, bin): &(Value, Vec<u8>)) -> Result<usize, String> {
    let document = gltf::Document::from_json_without_validation(root(document)?);
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let count = || primitive.reader(|_| Some(&bin[..])).read_positions().map_or(0, |p| p.count());
    catch_unwind(AssertUnwindSafe(count)).map_err(|_| "panic".into())
}

#[test]
fn gltf_panics_on_quantized_positions() {
    let mut model = triangle([&[0, 0, 0], &[1, 0, 0], &[0, 1, 0]], 5121, json!({}));
    for list in ["extensionsUsed", "extensionsRequired"] {
        model.0[list] = json!(["KHR_mesh_quantization"]);
    }
    assert_eq!(ours("a.glb", &glb(&model)), Ok(()));
    still(read_positions(&model) == Err("panic".into()), "gltf reads quantized positions");
    still(gltf::Gltf::from_slice(&glb(&model)).is_err(), "gltf takes files that require KHR_mesh_quantization");
}

#[test]
fn gltf_panics_on_references_to_nothing_unless_it_validates() {
    let mut model = float_triangle(json!({}));
    model.0["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(7);
    assert!(ours("a.glb", &glb(&model)).unwrap_err().contains("refers to element 7 of /accessors"));
    still(read_positions(&model) == Err("panic".into()), "gltf survives a reference to nothing without validation");
}

#[test]
fn validation_by_gltf_refuses_accessors_of_zeros() {
    let mut model = float_triangle(json!({}));
    let sparse = json!({"count": 3, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 0}});
    model.0["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    model.0["accessors"][0]["sparse"] = sparse;
    model.0["bufferViews"][0].as_object_mut().unwrap().remove("byteStride");
    model.0["bufferViews"].as_array_mut().unwrap().push(json!({"buffer": 0, "byteOffset": 36, "byteLength": 3}));
    model.1.extend([0, 1, 2, 0]);
    model.0["buffers"][0]["byteLength"] = json!(model.1.len());
    assert_eq!(ours("a.glb", &glb(&model)), Ok(()));
    model.0["accessors"][0].as_object_mut().unwrap().remove("sparse");
    model.0["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    still(gltf::Gltf::from_slice(&glb(&model)).is_err(), "gltf takes an accessor without a buffer view");
}

#[test]
fn gltf_refuses_integers_with_a_zero_fraction() {
    let (mut document, bin) = float_triangle(json!({}));
    document["accessors"][0]["count"] = json!(3.0);
    assert!(document.to_string().contains("3.0"));
    assert_eq!(ours("a.glb", &glb(&(document.clone(), bin))), Ok(()));
    still(root(&document).is_err(), "gltf reads 3.0 as an integer, as glTF 2.0 allows");
}

#[test]
fn gltf_refuses_a_model_for_an_animation_that_is_not_drawn() {
    let (mut document, bin) = float_triangle(json!({}));
    document["animations"] = json!([{"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": []}]);
    assert_eq!(ours("a.glb", &glb(&(document.clone(), bin))), Ok(()));
    still(root(&document).is_err(), "gltf reads a model whose animation it does not know");
}

#[test]
fn gltf_does_not_keep_a_wrong_number_for_the_message() {
    let model = float_triangle(json!({"componentType": 1234}));
    assert!(ours("a.glb", &glb(&model)).unwrap_err().contains("component type 1234"));
    let error = gltf::Gltf::from_slice(&glb(&model)).unwrap_err().to_string();
    still(!error.contains("1234"), "gltf says which number stood there");
}

#[test]
fn gltf_rounds_transforms_to_single_precision() {
    let (mut document, _) = float_triangle(json!({}));
    document["nodes"][0]["translation"] = json!([0.1, 0, 0]);
    let read = serde_json::to_value(root(&document).unwrap().nodes[0].translation).unwrap()[0].as_f64().unwrap();
    still(read != 0.1, "gltf keeps transforms in double precision");
}

#[test]
fn gltf_panics_on_a_glb_of_length_0() {
    let file = [&b"glTF"[..], &2u32.to_le_bytes(), &0u32.to_le_bytes()].concat();
    assert!(ours("a.glb", &file).unwrap_err().contains("byte 8: length in the header is 0"));
    still(catch_unwind(|| gltf::Glb::from_slice(&file).map(drop)).is_err(), "gltf refuses a GLB of length 0");
}

fn by_tobj(text: &str) -> Result<Vec<tobj::Model>, String> {
    let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let no_library = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    tobj::load_obj_buf(&mut text.as_bytes(), &options, no_library).map(|(models, _)| models).map_err(|e| e.to_string())
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn tobj_does_not_locate_faults() {
    let text = format!("{TRIANGLE}v 1 x 0\n");
    assert!(ours("a.obj", text.as_bytes()).unwrap_err().starts_with("a.obj: line 5: `x`"));
    still(!by_tobj(&text).unwrap_err().contains('5'), "tobj names the line");
    let text = format!("{TRIANGLE}f 1 2 9\n");
    assert!(ours("a.obj", text.as_bytes()).unwrap_err().starts_with("a.obj: line 5: uses vertex 9"));
    still(!by_tobj(&text).unwrap_err().contains(['5', '9']), "tobj names the line and the vertex");
}

#[test]
fn tobj_takes_numbers_that_are_not_finite() {
    let text = TRIANGLE.replace("v 1 0 0", "v NaN 1e99 0");
    assert!(ours("a.obj", text.as_bytes()).unwrap_err().starts_with("a.obj: line 2: `NaN`"));
    still(by_tobj(&text).is_ok(), "tobj refuses NaN");
}

#[test]
fn tobj_skips_statements_silently() {
    let text = format!("this is no model\n{TRIANGLE}curv 0 1 1 2\n");
    let (files, view) = (MemoryFiles::default(), ViewOptions::default());
    let (scene, _held) = load(text.as_bytes(), "a.obj", &files, &view, &MemoryPool::default()).unwrap();
    assert!(scene.warnings.iter().any(|w| w.contains("`curv` is skipped")), "{:?}", scene.warnings);
    still(by_tobj(&text).is_ok(), "tobj tells of statements that it does not know");
}

#[test]
fn tobj_reads_map_options_as_names_and_no_normal_maps() {
    let read = |text: &str| tobj::load_mtl_buf(&mut text.as_bytes()).unwrap().0.remove(0);
    let color = read("newmtl a\nmap_Kd -clamp on wall.png\n").diffuse_texture;
    still(color.as_deref() != Some("wall.png"), "tobj reads the options of maps");
    still(read("newmtl a\nnorm n.png\n").normal_texture.is_none(), "tobj knows `norm`");
}
