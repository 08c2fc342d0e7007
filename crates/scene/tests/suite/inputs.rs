//! Importing files that nobody in this project made. Skipped, loudly, where they are not at hand.

use basrelief_input::MemoryPool;
use basrelief_scene::{SceneError, ViewOptions, load_path};
use basrelief_signals::Scene;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The folder of foreign inputs: `BASRELIEF_INPUTS`, or `shared/inputs` beside the workspace.
fn inputs(part: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/inputs");
    let folder = std::env::var_os("BASRELIEF_INPUTS").map_or_else(beside, PathBuf::from).join(part);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("SKIPPED: no {} - set BASRELIEF_INPUTS to run this test", folder.display());
    None
}

fn files_below(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files_below(&path, endings));
        } else if path.extension().and_then(|e| e.to_str()).is_some_and(|e| endings.contains(&e)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn import(path: &Path) -> Result<Scene, SceneError> {
    load_path(path, &ViewOptions::default())
}

/// Error codes of the validator that an importer must not overlook, because geometry, materials or the container are
/// unusable. The others concern animations, skins, limits of declared extremes, or parts that are not drawn.
const FATAL: [&str; 17] = [
    "ACCESSOR_INDEX_OOB",
    "ACCESSOR_INDEX_PRIMITIVE_RESTART",
    "ACCESSOR_NORMALIZED_INVALID",
    "ACCESSOR_SMALL_BYTESTRIDE",
    "ACCESSOR_TOO_LONG",
    "BUFFER_BYTE_LENGTH_MISMATCH",
    "BUFFER_MISSING_GLB_DATA",
    "CAMERA_ZFAR_LEQUAL_ZNEAR",
    "INVALID_JSON",
    "INVALID_URI",
    "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT",
    "NODE_LOOP",
    "SCENE_NON_ROOT_NODE",
    "UNKNOWN_ASSET_MAJOR_VERSION",
    "VALUE_NOT_IN_RANGE",
    "CAMERA_XMAG_YMAG_ZERO",
];

/// Severe errors of a report: code and JSON pointer.
fn severe(report: &Path) -> Vec<(String, String)> {
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    let messages = report["issues"]["messages"].as_array().unwrap();
    let text = |m: &serde_json::Value, key: &str| m[key].as_str().unwrap_or("").to_owned();
    messages.iter().filter(|m| m["severity"] == 0).map(|m| (text(m, "code"), text(m, "pointer"))).collect()
}

fn is_fatal(code: &str, pointer: &str, file: &Path) -> bool {
    let drawn = !["/animations", "/skins"].iter().any(|p| pointer.starts_with(p)) && !file.starts_with("ext");
    let structure = ["GLB_", "TYPE_MISMATCH", "UNRESOLVED_REFERENCE"].iter().any(|c| code.starts_with(c));
    drawn && (FATAL.contains(&code) || structure)
}

#[test]
fn validator_files_import_or_name_the_fault() {
    let Some(folder) = inputs("bad/gltf-validator") else { return };
    let mut overlooked = Vec::new();
    let files = files_below(&folder, &["gltf", "glb"]);
    assert!(files.len() >= 185, "only {} files", files.len());
    for path in files {
        let start = Instant::now();
        let result = import(&path);
        assert!(start.elapsed() < Duration::from_secs(5), "{} took {:?}", path.display(), start.elapsed());
        let report = PathBuf::from(format!("{}.report.json", path.display()));
        let severe = severe(&report);
        let relative = path.strip_prefix(&folder).unwrap();
        match result {
            Err(e) => {
                let text = e.to_string();
                assert!(text.contains(path.file_name().unwrap().to_str().unwrap()) || !e.place.is_empty(), "{text}");
                println!("{}: {text}\n    expected {severe:?}", relative.display());
            }
            Ok(scene) => {
                println!("{}: {} objects, {:?}", relative.display(), scene.objects.len(), scene.warnings);
                if severe.iter().any(|(code, pointer)| is_fatal(code, pointer, relative)) {
                    overlooked.push((path, severe));
                }
            }
        }
    }
    assert!(overlooked.is_empty(), "{overlooked:#?}");
}

#[test]
fn corrupt_png_is_an_error_that_names_it() {
    let Some(folder) = inputs("bad/png") else { return };
    let model = r#"{"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "accessors": [{"type": "VEC3", "componentType": 5126, "count": 3}], "textures": [{"source": 0}],
        "images": [{"uri": "NAME"}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]}"#;
    let files = basrelief_scene::FolderFiles::new(&folder);
    for path in files_below(&folder, &["png"]) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = model.replace("NAME", name);
        let error = basrelief_scene::load(text.as_bytes(), "m.gltf", &files, &ViewOptions::default(), &MemoryPool::default());
        let text = error.err().unwrap_or_else(|| panic!("{name} was accepted")).to_string();
        assert!(text.starts_with(name), "{text}");
    }
}

#[test]
fn sample_models_import() {
    let Some(folder) = inputs("models") else { return };
    let paths = files_below(&folder, &["gltf", "glb", "obj"]);
    assert!(paths.len() >= 8, "{paths:?}");
    for path in paths {
        let scene = import(&path).unwrap_or_else(|e| panic!("{e}"));
        for object in &scene.objects {
            check_mesh(&object.mesh, object.material.normal_map.is_some());
        }
        println!("{}: {} objects, {:?}", path.display(), scene.objects.len(), scene.warnings);
    }
}

fn check_mesh(mesh: &basrelief_signals::Mesh, bump: bool) {
    let count = mesh.positions.len();
    assert!(mesh.indices.len().is_multiple_of(3) && mesh.indices.iter().all(|i| (*i as usize) < count));
    assert_eq!(mesh.normals.len(), count);
    assert_eq!(mesh.tangents.len(), if bump { count } else { 0 });
    assert_eq!(mesh.uv_normal.len(), if bump { count } else { 0 });
    let length = |v: &[f32]| v.iter().map(|c| c * c).sum::<f32>().sqrt();
    assert!(mesh.normals.iter().all(|n| (length(n) - 1.0).abs() < 1e-5));
    assert!(mesh.tangents.iter().all(|t| (length(&t[..3]) - 1.0).abs() < 1e-5 && t[3].abs() == 1.0));
}

#[test]
fn computed_tangents_agree_with_a_files_own() {
    let Some(folder) = inputs("models/Avocado") else { return };
    check_tangents(&folder, "Avocado.gltf");
}

#[test]
fn computed_tangents_agree_with_those_of_own_model() {
    check_tangents(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/models"), "patch.gltf");
}

/// MikkTSpace on the first mesh of a file, which has tangents, gives those tangents: the same handedness, nearly the same directions.
fn check_tangents(folder: &Path, name: &str) {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    let files = basrelief_scene::FolderFiles::new(folder);
    let mesh = |text: &str| {
        let view = ViewOptions::default();
        let (scene, _held) = basrelief_scene::load(text.as_bytes(), name, &files, &view, &MemoryPool::default()).unwrap();
        scene.objects[0].mesh.clone()
    };
    let given = mesh(&text);
    let mut document: serde_json::Value = serde_json::from_str(&text).unwrap();
    document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TANGENT").unwrap();
    let computed = mesh(&document.to_string());
    let (mut same_side, mut near) = (0, 0);
    for (a, b) in given.indices.iter().zip(&computed.indices) {
        let (a, b) = (given.tangents[*a as usize], computed.tangents[*b as usize]);
        same_side += usize::from(a[3] == b[3]);
        near += usize::from((0..3).map(|i| a[i] * b[i]).sum::<f32>() > 0.95);
    }
    let corners = given.indices.len();
    println!("of {corners} corners {same_side} have the same handedness, {near} nearly the same direction");
    assert!(same_side * 100 > corners * 99 && near * 100 > corners * 95);
}
