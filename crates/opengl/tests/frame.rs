//! The frame of `tests/opengl/application.py`: imported, drawn exactly, compared with the application's picture, and damaged.

use basrelief_input::MemoryPool;
use basrelief_opengl::{DumpFile, GlFrame, Mapping, PictureComparison, compare, import};
use basrelief_scene::{MemoryFiles, ViewOptions, load};
use basrelief_signals::Scene;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const FILES: [&str; 3] = ["frame.435.json", "frame.466.json", "frame.493.json"];

/// The uniform `bumpy` switches the normal map off for two objects.
const MAP: &str = "435.normal-map=none,493.normal-map=none";

fn bytes(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/opengl").join(name);
    fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn dump(name: &str) -> Value {
    serde_json::from_slice(&bytes(name)).unwrap()
}

fn mapping(entries: &str) -> Mapping {
    Mapping(entries.split(',').filter(|entry| !entry.is_empty()).map(|entry| entry.parse().unwrap()).collect())
}

fn imported(dumps: &[(&str, Vec<u8>)], map: &str) -> Result<GlFrame, String> {
    let files: Vec<_> = dumps.iter().map(|(name, bytes)| DumpFile { name, bytes }).collect();
    import(&files, &mapping(map), &MemoryPool::default()).map_err(|e| e.to_string())
}

/// Imports one changed dump.
fn changed(name: &str, map: &str, change: impl FnOnce(&mut Value)) -> Result<GlFrame, String> {
    let mut dump = dump(name);
    change(&mut dump);
    imported(&[(name, dump.to_string().into_bytes())], map)
}

fn whole(map: &str) -> GlFrame {
    imported(&FILES.map(|name| (name, bytes(name))), map).unwrap()
}

fn scene(frame: &GlFrame) -> Scene {
    let view = ViewOptions { size: frame.size, camera: Some(frame.camera), ..ViewOptions::default() };
    load(frame.gltf.as_bytes(), "frame.gltf", &MemoryFiles::default(), &view, &MemoryPool::default()).unwrap().0
}

fn compared(frame: &GlFrame) -> PictureComparison {
    let scene = scene(frame);
    compare(&scene, &scene.frames[0], frame.filter, frame.application.as_ref().unwrap()).unwrap()
}

#[test]
fn exact_picture_matches_the_application() {
    let frame = whole(MAP);
    let scene = scene(&frame);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let triangles: Vec<usize> = scene.objects.iter().map(|object| object.mesh.indices.len() / 3).collect();
    assert_eq!((frame.size, triangles), ([120, 90], vec![2, 480, 24]));
    let found = compared(&frame);
    assert_eq!(found.agreement(), Some(100.0), "{:?}", found.geometry);
    assert!(found.quality.psnr_db > 50.0 && found.quality.flip < 0.02, "{:?}", found.quality);
    let light = frame.camera.to_light;
    assert!((light[0] / light[1] - 0.6).abs() < 1e-6 && (light[2] / light[1] - 0.4).abs() < 1e-6, "{light:?}");
}

#[test]
fn mapping_replaces_guesses() {
    assert!(compared(&whole("")).quality.psnr_db < 30.0, "all three objects are bumpy");
    let frame = whole("435.normal-map=none,493.normal-map=none,light=0:0:-1,466.base-color=0:1:0,493.albedo=none");
    assert_eq!(frame.camera.to_light, [0.0, 0.0, -1.0]);
    let scene = scene(&frame);
    assert_eq!(scene.objects[1].material.base_color, [0.0, 1.0, 0.0, 1.0]);
    assert!(scene.objects[2].material.color_texture.is_none() && scene.objects[0].material.color_texture.is_some());
}

#[test]
fn mapped_names_that_do_not_exist_are_errors() {
    let says = |map: &str, part: &str| {
        let text = imported(&[(FILES[1], bytes(FILES[1]))], map).unwrap_err();
        assert!(text.starts_with("frame.466.json: call 466: ") && text.contains(part), "{text}");
    };
    says(
        "normal=normals",
        "--map normal=normals: the draw call has no such name; expected `none` or a vertex attribute of 3 or 4 numbers \
         (the draw call has normal, position",
    );
    says("albedo=x", "expected `none` or a sampler (the draw call has albedo");
    says(
        "mvp=x",
        "--map mvp=x: the draw call has no such name; expected a uniform that is a 4 x 4 matrix (the draw call has model",
    );
    says(
        "light=sun",
        "three numbers such as 1:2:3 that are not all 0, or a uniform of 3 or 4 numbers (the draw call has base_color",
    );
    says("mvp=view,position=x", "--map position=x");
    says("shininess=x", "--map shininess=x: the draw call has no such name; expected `none`, a number from 1 to 1000");
}

#[test]
fn mapping_of_a_call_that_is_not_imported_is_an_error() {
    let text = imported(&FILES.map(|name| (name, bytes(name))), "435.normal-map=none,7.uv=none").unwrap_err();
    let expected = "expected one of the imported draw calls, 435, 466, 493; call numbers differ from capture to capture";
    assert_eq!(text, format!("--map 7.uv=none: the draw call is not imported; {expected}"));
}

#[test]
fn map_without_normals_is_in_object_space() {
    let bare = |dump: &mut Value| {
        for name in ["normal", "tangent"] {
            dump["draw"]["attributes"].as_object_mut().unwrap().remove(name);
        }
    };
    let frame = changed(FILES[1], "", bare).unwrap();
    assert!(frame.notes.iter().any(|note| note.contains("normal-space = object (guessed")), "{:?}", frame.notes);
    let mesh = &scene(&frame).objects[0].mesh;
    assert!(mesh.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]) && mesh.tangents.iter().all(|t| *t == [1.0, 0.0, 0.0, 1.0]));
    // Without tangents but with normals they are computed.
    let frame = changed(FILES[1], "tangent=none", |_| {}).unwrap();
    assert!(frame.notes.iter().any(|note| note.contains("normal-space = tangent")), "{:?}", frame.notes);
}

/// A ramp along u that rises by 8 of 255 per texel: 1.0 is 255 / 8 texels high, so the slope is 1.
#[test]
fn height_map_becomes_a_normal_map() {
    let ramp = image::GrayImage::from_fn(32, 32, |x, _| image::Luma([x as u8 * 8]));
    let mut png = std::io::Cursor::new(Vec::new());
    ramp.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let data = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, png.into_inner());
    let map = "normal-map=none,height-map=normal_map,height-scale=31.875";
    let frame = changed(FILES[1], map, |dump| {
        dump["textures"]["GL_TEXTURE1, GL_TEXTURE_2D, level = 0"]["__data__"] = json!(data);
    });
    let scene = scene(&frame.unwrap());
    let texels = &scene.objects[0].material.normal_map.as_ref().unwrap().levels[0].texels;
    // (-1, 0, 1) / sqrt 2.
    assert_eq!(texels[16 * 32 + 16], [37, 128, 218, 255]);
}

#[test]
fn surface_without_normals_is_unlit() {
    let lighting = |map: &str, drop_coefficients: bool| {
        let frame = changed(FILES[2], map, |dump| {
            if drop_coefficients {
                let uniforms = dump["uniforms"].as_object_mut().unwrap();
                uniforms.retain(|name, _| !["ambient", "diffuse", "specular", "shininess"].contains(&&**name));
            }
        });
        scene(&frame.unwrap()).objects[0].material.lighting
    };
    let unlit = basrelief_signals::Lighting { ka: 1.0, kd: 0.0, ks: 0.0, n: 1.0 };
    assert_eq!(lighting("normal=none,normal-map=none", true), unlit);
    assert_eq!(lighting("normal=none,normal-map=none,diffuse=0.5", true), basrelief_signals::Lighting { kd: 0.5, ..unlit });
    assert_eq!(lighting("normal=none,normal-map=none", false).kd, 0.7, "uniforms state the light");
    assert_ne!(lighting("normal-map=none", true), unlit);
    assert_ne!(lighting("normal=none", true), unlit, "a normal map is lit");
}

#[test]
fn texture_without_coordinates_is_left_out() {
    for map in ["uv=none", "uv=none,albedo=albedo,normal-map=normal_map"] {
        let frame = changed(FILES[1], map, |_| {}).unwrap();
        let left_out =
            |name: &str| format!("call 466: texture `{name}` is left out, because the draw call has no texture coordinates");
        assert_eq!(frame.warnings, [left_out("albedo"), left_out("normal_map")], "{map}");
        assert!(!frame.notes.iter().any(|note| note.contains("albedo")), "{:?}", frame.notes);
        let scene = scene(&frame);
        let material = &scene.objects[0].material;
        assert!(material.color_texture.is_none() && material.normal_map.is_none());
        assert!(!frame.gltf.contains("baseColorTexture") && !frame.gltf.contains("normalTexture"));
    }
}

#[test]
fn mapped_texture_must_exist_without_coordinates_too() {
    let text = changed(FILES[1], "uv=none,albedo=x", |_| {}).unwrap_err();
    assert!(text.contains("--map albedo=x: the draw call has no such name"), "{text}");
}

#[test]
fn texture_of_depths_is_never_a_guess() {
    let depths = |map: &str| {
        changed(FILES[1], map, |dump| {
            let texture = &mut dump["textures"]["GL_TEXTURE0, GL_TEXTURE_2D, level = 0"];
            texture["__format__"] = json!("GL_DEPTH_COMPONENT24");
            texture["__data__"] = json!("UGYKMTIwIDkwCjEK");
        })
    };
    let frame = depths("").unwrap();
    assert_eq!(frame.warnings, ["call 466: texture `albedo` is left out, because it holds depths"]);
    assert!(scene(&frame).objects[0].material.color_texture.is_none());
    assert_eq!(
        depths("albedo=albedo").unwrap_err(),
        "frame.466.json: call 466: --map albedo=albedo: the texture holds depths; expected a sampler of a texture with colours; \
         leave it out with --map albedo=none"
    );
}

#[test]
fn texture_state_that_devices_lack_is_a_warning() {
    let state = |field: &str, value: Value| {
        let change = |dump: &mut Value| dump["parameters"]["GL_TEXTURE0"]["GL_TEXTURE_2D"][field] = value;
        changed(FILES[1], "", change).unwrap().warnings
    };
    let warning = |text: &str| [format!("call 466: texture `albedo`: {text}")];
    assert_eq!(state("GL_TEXTURE_SWIZZLE_R", json!("GL_BLUE")), warning("GL_TEXTURE_SWIZZLE_R = GL_BLUE is left out"));
    assert_eq!(state("GL_TEXTURE_BASE_LEVEL", json!(2)), warning("GL_TEXTURE_BASE_LEVEL = 2 is left out: drawn from level 0"));
    assert_eq!(
        state("GL_TEXTURE_INTERNAL_FORMAT", json!("GL_SRGB8")),
        warning("GL_SRGB8 is drawn without the conversion from sRGB to linear colours")
    );
}

#[test]
fn uniform_out_of_range_is_a_warning_with_both_values() {
    let uniform = |name: &str, value: Value| changed(FILES[1], "", |dump| dump["uniforms"][name] = value).unwrap().warnings;
    assert_eq!(uniform("shininess", json!(5000)), ["call 466: shininess = 5000 is drawn as 1000"]);
    assert_eq!(uniform("shininess", json!(0)), ["call 466: shininess = 0 is drawn as 1"]);
    assert_eq!(uniform("ambient", json!(2.0)), ["call 466: ambient = 2 is drawn as 1"]);
    assert_eq!(uniform("base_color", json!([2, 1, 1])), ["call 466: base-color = [2.0, 1.0, 1.0] is drawn as [1.0, 1.0, 1.0]"]);
    assert_eq!(uniform("shininess", json!(24)), [""; 0]);
}

#[test]
fn call_without_colors_is_left_out() {
    let mut prepass = dump(FILES[0]);
    prepass["parameters"]["GL_COLOR_WRITEMASK"] = json!(["GL_FALSE", "GL_FALSE", "GL_FALSE", "GL_TRUE"]);
    let prepass = prepass.to_string().into_bytes();
    let dumps = [(FILES[0], prepass.clone()), (FILES[1], bytes(FILES[1]))];
    let frame = imported(&dumps, MAP.split(',').next().unwrap()).unwrap();
    assert_eq!(frame.warnings, ["call 435: is left out, because it writes no colours (GL_COLOR_WRITEMASK)"]);
    assert_eq!(scene(&frame).objects.len(), 1);
    let text = imported(&dumps[..1], "").unwrap_err();
    assert!(text.starts_with("no given draw call writes colours; expected"), "{text}");
}

#[test]
fn dump_that_is_given_twice_is_an_error() {
    let text = imported(&[(FILES[0], bytes(FILES[0])), ("again.json", bytes(FILES[0]))], "").unwrap_err();
    assert_eq!(
        text,
        "again.json: has the same content as frame.435.json; expected one dump for each draw call; name each dump once"
    );
}

#[test]
fn position_without_matrix_has_the_identity() {
    let frame = changed(FILES[2], "", |dump| {
        dump["shaders"]["GL_VERTEX_SHADER"] = json!("void main() { gl_Position = vec4(position, 1.0); }");
    });
    let notes = frame.unwrap().notes;
    assert_eq!(notes[0], "call 493: mvp = identity, position = position (read from the vertex program)");
}

#[test]
fn agreement_of_almost_all_pixels_is_not_shown_as_all() {
    let frame = whole(MAP);
    let mut found = compared(&frame);
    assert_eq!(found.shown_agreement().unwrap(), "100.000");
    found.pixels = 480_000;
    found.geometry.as_mut().unwrap().depth += 1;
    assert_eq!(found.shown_agreement().unwrap(), "99.999");
    found.pixels = 1_000;
    assert_eq!(found.shown_agreement().unwrap(), "99.900");
}

#[test]
fn object_of_another_view_is_refused() {
    let second = |change: &dyn Fn(&mut Value)| {
        let mut dump = dump(FILES[1]);
        change(&mut dump);
        imported(&[(FILES[0], bytes(FILES[0])), (FILES[1], dump.to_string().into_bytes())], "").unwrap_err()
    };
    let text = second(&|dump| dump["parameters"]["GL_VIEWPORT"] = json!([0, 0, 60, 90]));
    assert!(text.starts_with("frame.466.json: call 466: /parameters/GL_VIEWPORT: is [0, 0, 60, 90]"), "{text}");
    let text = second(&|dump| dump["parameters"]["GL_DRAW_FRAMEBUFFER_BINDING"] = json!(7));
    assert!(text.contains("call 466: /parameters/GL_DRAW_FRAMEBUFFER_BINDING: is 7; expected 0, as in call 435"), "{text}");
    let text = second(&|dump| dump["uniforms"]["projection"][0][3] = json!(1.0));
    assert!(text.contains("call 466: /uniforms: the draw call has another projection"), "{text}");
}

#[test]
fn broken_dumps_name_call_and_field() {
    let says = |part: &str, change: &dyn Fn(&mut Value)| {
        let text = changed(FILES[2], "", change).unwrap_err();
        assert!(text.starts_with("frame.493.json: ") && text.contains(part), "{part}: {text}");
    };
    let texture = "GL_TEXTURE0, GL_TEXTURE_2D, level = 0";
    let vertex = "GL_VERTEX_SHADER";
    says("call 493: /textures/GL_TEXTURE0, GL_TEXTURE_2D, level = 0/__data__: not base64", &|d| {
        d["textures"][texture]["__data__"] = json!("?")
    });
    says("call 493: /textures/GL_TEXTURE0, GL_TEXTURE_2D, level = 0/__data__: neither PNG", &|d| {
        d["textures"][texture]["__data__"] = json!("AAAA")
    });
    says("32 x 32 texels, but the dump states 33 x 32", &|d| d["textures"][texture]["__width__"] = json!(33));
    says("/textures/GL_TEXTURE0, GL_TEXTURE_2D, level = 0/__width__ (line 1", &|d| {
        d["textures"][texture]["__width__"] = json!(-1)
    });
    says("call 493: /shaders/GL_VERTEX_SHADER: is missing", &|d| d["shaders"] = json!({}));
    says("the vertex program computes `gl_Position = vec4 ( wave", &|d| {
        d["shaders"][vertex] = json!("void main() { gl_Position = vec4(wave(position), 1.0); }")
    });
    says("call 493: /shaders/GL_GEOMETRY_SHADER: the draw call has such a program", &|d| {
        d["shaders"]["GL_GEOMETRY_SHADER"] = json!("x")
    });
    says("the vertex program computes", &|d| d["uniforms"]["view"] = json!([[1.0]]));
    says("flattens space", &|d| d["uniforms"]["view"] = json!([0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]));
    says("call 493: /draw/mode: `GL_LINES` cannot be drawn", &|d| d["draw"]["mode"] = json!("GL_LINES"));
    says("call 493: /draw/count: draws 27 vertices from 0", &|d| d["draw"]["count"] = json!(27));
    says("call 493: /draw/count: draws no triangle", &|d| d["draw"]["count"] = json!(2));
    says("/draw/attributes/uv: has 25 vertices, other attributes have 26", &|d| {
        let data = d["draw"]["attributes"]["uv"]["data"].as_str().unwrap();
        // 25 vertices of 8 bytes, in 268 characters.
        d["draw"]["attributes"]["uv"]["data"] = json!(format!("{}=", &data[..267]));
    });
    says("holds no vertices", &|d| d["draw"] = json!({"call": 493, "mode": "GL_TRIANGLES", "count": 3}));
    says("not finite", &|d| d["draw"]["attributes"]["position"]["data"] = json!("AADAfwAAAAAAAAAA".repeat(26)));
    says("/framebuffer/GL_DEPTH_ATTACHMENT/__data__: has another number of bytes", &|d| {
        d["framebuffer"]["GL_DEPTH_ATTACHMENT"]["__data__"] = json!("UGYKMTIwIDkwCjEK")
    });
    says("120 x 90 pixels do not hold the viewport", &|d| d["parameters"]["GL_VIEWPORT"] = json!([1, 0, 120, 90]));
}

#[test]
fn file_that_is_no_dump_is_named() {
    for text in ["{}", r#"{"asset": {"version": "2.0"}}"#, r#"{"view_projection": [1]}"#] {
        let error = imported(&[("a.json", text.into())], "").unwrap_err();
        assert_eq!(
            error,
            "a.json: is no state dump of OpenGL, because `parameters` is missing or empty; expected the JSON that \
             `apitrace replay -D CALL TRACE` writes; name the dumps that `basrelief capture` keeps, for example"
        );
    }
}

#[test]
fn dump_without_picture_is_imported() {
    let frame = imported(&[(FILES[0], bytes(FILES[0]))], "").unwrap();
    assert!(frame.application.is_none());
    assert_eq!(scene(&frame).objects.len(), 1);
}

#[test]
fn truncated_dump_is_an_error_that_names_the_file() {
    let whole = bytes(FILES[0]);
    for end in (0..whole.len() - 2).step_by(97) {
        let text = imported(&[(FILES[0], whole[..end].to_vec())], "").unwrap_err();
        assert!(text.starts_with("frame.435.json: "), "{end}: {text}");
    }
}

#[test]
fn damaged_dump_never_panics() {
    let whole = bytes(FILES[0]);
    let mut state = 1_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut refused = 0;
    for _ in 0..400 {
        let mut dump = whole.clone();
        let at = next(dump.len());
        dump[at] = b"09{}[],:\"a-e."[next(13)];
        if let Err(text) = imported(&[(FILES[0], dump)], "") {
            assert!(text.starts_with("frame.435.json: "), "{text}");
            refused += 1;
        }
    }
    assert!(refused > 20, "{refused}");
}

#[test]
fn memory_limit_is_kept() {
    let files = FILES.map(|name| (name, bytes(name)));
    let files: Vec<_> = files.iter().map(|(name, bytes)| DumpFile { name, bytes }).collect();
    for limit in [100_000, 300_000] {
        let error = import(&files, &mapping(MAP), &MemoryPool::new(limit)).unwrap_err();
        assert!(error.over_budget && error.to_string().contains("over the limit of"), "{error}");
    }
    let budget = MemoryPool::default();
    drop(import(&files, &mapping(MAP), &budget).unwrap());
    assert_eq!(budget.left(), MemoryPool::DEFAULT, "everything is given back");
}
