//! Draw calls of the fixed function: matrices, light, material and texture of a dump.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use basrelief_input::MemoryPool;
use basrelief_opengl::{DumpFile, GlFrame, Mapping, import};
use basrelief_scene::{MemoryFiles, ViewOptions, load};
use basrelief_signals::{Lighting, Object};
use serde_json::{Value, json};

fn attribute(size: usize, values: &[f32]) -> Value {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    json!({"size": size, "data": STANDARD.encode(bytes)})
}

/// A triangle three units in front of the viewer, with a red and rough material under a white light from above.
fn dump() -> Value {
    json!({
        "draw": {"call": 7, "mode": "GL_TRIANGLES", "count": 3, "attributes": {
            "gl_Vertex": attribute(4, &[0., 0., 0., 1., 1., 0., 0., 1., 0., 1., 0., 1.]),
            "gl_Normal": attribute(3, &[0., 0., 1.].repeat(3)),
            "gl_Color": attribute(4, &[0.5, 1., 1., 1.].repeat(3)),
            "gl_MultiTexCoord0": attribute(4, &[0., 0., 0., 1., 1., 0., 0., 1., 0., 1., 0., 1.]),
        }},
        "parameters": {
            "GL_VIEWPORT": [0, 0, 16, 16],
            "GL_DEPTH_TEST": "GL_TRUE",
            "GL_LIGHTING": "GL_TRUE",
            "GL_PROJECTION_MATRIX": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.5, -1, 0, 0, -2.5, 0],
            "GL_MODELVIEW_MATRIX": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -3, 1],
            "GL_LIGHT_MODEL_AMBIENT": [0.25, 0.25, 0.25, 1],
            "GL_FRONT": {"GL_AMBIENT": [0.8, 0, 0, 1], "GL_DIFFUSE": [0.8, 0, 0, 1], "GL_SPECULAR": [0.4, 0, 0, 1], "GL_SHININESS": 20},
            "GL_LIGHT0": {"GL_DIFFUSE": [1, 1, 1, 1], "GL_SPECULAR": [1, 1, 1, 1], "GL_POSITION": [0, 2, 0, 0]},
        },
    })
}

fn imported(dumps: &[Value], map: &str) -> Result<GlFrame, String> {
    let texts: Vec<String> = dumps.iter().map(Value::to_string).collect();
    let files: Vec<_> = texts.iter().map(|text| DumpFile { name: "a.json", bytes: text.as_bytes() }).collect();
    let mapping = Mapping(map.split(',').filter(|entry| !entry.is_empty()).map(|entry| entry.parse().unwrap()).collect());
    import(&files, &mapping, &MemoryPool::default()).map_err(|e| e.to_string())
}

/// Imports one changed dump.
fn changed(change: impl FnOnce(&mut Value)) -> GlFrame {
    let mut dump = dump();
    change(&mut dump);
    imported(&[dump], "").unwrap()
}

fn object(frame: &GlFrame) -> std::sync::Arc<Object> {
    let view = ViewOptions { size: frame.size, camera: Some(frame.camera), ..ViewOptions::default() };
    load(frame.gltf.as_bytes(), "a.gltf", &MemoryFiles::default(), &view, &MemoryPool::default()).unwrap().0.objects.remove(0)
}

fn assert_color(object: &Object, expected: [f32; 3]) {
    let color = object.material.base_color;
    assert!(color.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{color:?}");
}

fn names(frame: &GlFrame, part: &str) -> bool {
    frame.warnings.iter().any(|warning| warning.contains(part))
}

#[test]
fn matrices_light_and_material_are_read() {
    let frame = changed(|_| {});
    assert_eq!(frame.warnings, Vec::<String>::new());
    // World space is eye space.
    assert_eq!((frame.camera.to_light, frame.camera.to_viewer), ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]));
    let object = object(&frame);
    assert_eq!(object.material.lighting, Lighting { ka: 0.25, kd: 1.0, ks: 0.5, n: 20.0 });
    assert_color(&object, [0.8, 0.0, 0.0]);
    assert!(object.mesh.colors.is_empty(), "vertex colours do not reach a lit surface");
    let projection = frame.camera.view_projection;
    assert_eq!((projection[0], projection[10], projection[14]), (1.0, -1.5, -1.0), "row by row");
}

#[test]
fn colors_come_from_vertices_without_light_or_as_material() {
    let unlit = object(&changed(|dump| dump["parameters"]["GL_LIGHTING"] = json!("GL_FALSE")));
    assert_eq!(unlit.material.lighting, Lighting { ka: 1.0, kd: 0.0, ks: 0.0, n: 1.0 });
    assert_color(&unlit, [0.5, 1.0, 1.0]);
    assert!(unlit.mesh.colors.is_empty(), "all vertices have one colour");
    let as_material = |dump: &mut Value| dump["parameters"]["GL_COLOR_MATERIAL"] = json!("GL_TRUE");
    let lit = object(&changed(as_material));
    assert_color(&lit, [0.5, 1.0, 1.0]);
    assert_eq!(lit.material.lighting.ka, 0.25);
    let several = object(&changed(|dump| {
        as_material(dump);
        dump["draw"]["attributes"]["gl_Color"] = attribute(4, &[1., 0., 0., 1., 0., 1., 0., 1., 0., 0., 1., 1.]);
    }));
    assert_color(&several, [1.0; 3]);
    assert_eq!(several.mesh.colors[1], [0.0, 1.0, 0.0, 1.0]);
    let other = changed(|dump| {
        as_material(dump);
        dump["parameters"]["GL_COLOR_MATERIAL_PARAMETER"] = json!("GL_SPECULAR");
    });
    assert!(names(&other, "vertex colours are another part of the material") && object(&other).mesh.colors.is_empty());
}

#[test]
fn parts_that_the_formula_lacks_are_warnings() {
    let white = changed(|dump| dump["parameters"]["GL_FRONT"]["GL_SPECULAR"] = json!([1, 1, 1, 1]));
    assert!(
        names(&white, "call 7: the specular colour [1, 1, 1] is drawn as 1.00 times the base colour"),
        "{:?}",
        white.warnings
    );
    let second = changed(|dump| dump["parameters"]["GL_LIGHT3"] = dump["parameters"]["GL_LIGHT0"].clone());
    assert!(names(&second, "GL_LIGHT3 is left out"), "{:?}", second.warnings);
    let point = changed(|dump| {
        dump["parameters"]["GL_LIGHT0"]["GL_POSITION"] = json!([0.5, 0.5, 7, 1]);
        dump["parameters"]["GL_LIGHT0"]["GL_SPOT_CUTOFF"] = json!(30);
    });
    assert!(names(&point, "GL_LIGHT0 is a point") && names(&point, "GL_LIGHT0 is a spotlight"), "{:?}", point.warnings);
    // The middle of the triangle is (0.5, 0.5, -3) for the viewer.
    assert_eq!(point.camera.to_light, [0.0, 0.0, 1.0]);
    let dark = object(&changed(|dump| dump["parameters"]["GL_FRONT"]["GL_DIFFUSE"] = json!([0, 0, 0, 1])));
    assert_color(&dark, [0.2, 0.0, 0.0]);
    assert_eq!((dark.material.lighting.ka, dark.material.lighting.kd), (1.0, 0.0));
    let left_out = changed(|dump| dump["draw"]["left_out"] = json!(["glMaterialfv"]));
    assert!(names(&left_out, "glMaterialfv between primitives of a display list"), "{:?}", left_out.warnings);
}

#[test]
fn light_of_a_later_draw_call_is_used() {
    let mut unlit = dump();
    unlit["parameters"]["GL_LIGHTING"] = json!("GL_FALSE");
    assert_eq!(imported(&[unlit.clone()], "").unwrap().camera.to_light, [0.0, 0.0, 1.0]);
    assert_eq!(imported(&[unlit.clone(), dump()], "").unwrap().camera.to_light, [0.0, 1.0, 0.0]);
    assert_eq!(imported(&[unlit, dump()], "light=1:0:0").unwrap().camera.to_light, [1.0, 0.0, 0.0]);
}

fn with_texture(dump: &mut Value) {
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(2, 2, image::Rgb([9, 8, 7])).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let record = json!({"__width__": 2, "__height__": 2, "__data__": STANDARD.encode(png.into_inner())});
    dump["textures"]["GL_TEXTURE0, GL_TEXTURE_2D, level = 0"] = record;
    let state = json!({"enabled": "GL_TRUE", "GL_TEXTURE_MIN_FILTER": "GL_NEAREST"});
    dump["parameters"]["GL_TEXTURE0"] = json!({"GL_TEXTURE_2D": state, "GL_TEXTURE_ENV": {"GL_TEXTURE_ENV_MODE": "GL_MODULATE"}});
}

#[test]
fn texture_that_is_on_becomes_albedo() {
    let frame = changed(with_texture);
    assert!(frame.notes.iter().any(|note| note == "call 7: albedo = GL_TEXTURE0 (guessed)"), "{:?}", frame.notes);
    let textured = object(&frame);
    assert_eq!(textured.material.color_texture.as_ref().unwrap().levels[0].texels[0], [9, 8, 7, 255]);
    assert_eq!(textured.material.lighting.ka, 0.25);
    let off = object(&changed(|dump| {
        with_texture(dump);
        dump["parameters"]["GL_TEXTURE0"]["GL_TEXTURE_2D"]["enabled"] = json!("GL_FALSE");
    }));
    assert!(off.material.color_texture.is_none());
    let replaced = object(&changed(|dump| {
        with_texture(dump);
        dump["parameters"]["GL_TEXTURE0"]["GL_TEXTURE_ENV"]["GL_TEXTURE_ENV_MODE"] = json!("GL_REPLACE");
    }));
    assert_eq!(replaced.material.lighting.ka, 1.0);
    assert_color(&replaced, [1.0; 3]);
    let unlit = object(&changed(|dump| {
        with_texture(dump);
        dump["parameters"]["GL_TEXTURE0"]["GL_TEXTURE_ENV"]["GL_TEXTURE_ENV_MODE"] = json!("GL_REPLACE");
        dump["parameters"]["GL_LIGHTING"] = json!("GL_FALSE");
    }));
    assert_color(&unlit, [1.0; 3]);
    let combined = changed(|dump| {
        with_texture(dump);
        dump["parameters"]["GL_TEXTURE0"]["GL_TEXTURE_ENV"]["GL_TEXTURE_ENV_MODE"] = json!("GL_ADD");
        dump["parameters"]["GL_TEXTURE_MATRIX"] = json!([2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
        dump["parameters"]["GL_TEXTURE_GEN_S"] = json!("GL_TRUE");
    });
    for part in ["combined by GL_ADD", "texture matrix", "that OpenGL generates"] {
        assert!(names(&combined, part), "{part}: {:?}", combined.warnings);
    }
}

#[test]
fn mapping_replaces_the_material() {
    let frame = imported(&[dump()], "base-color=0:1:0,ambient=0.5,specular=0,color=gl_Color").unwrap();
    let object = object(&frame);
    assert_color(&object, [0.0, 1.0, 0.0]);
    assert_eq!((object.material.lighting.ka, object.material.lighting.ks), (0.5, 0.0));
}

#[test]
fn faulty_state_of_the_fixed_function_is_named() {
    let says = |part: &str, change: &dyn Fn(&mut Value)| {
        let mut dump = dump();
        change(&mut dump);
        let text = imported(&[dump], "").unwrap_err();
        assert!(text.starts_with("a.json: call 7: ") && text.contains(part), "{part}: {text}");
    };
    says("/parameters/GL_MODELVIEW_MATRIX: is no 4 x 4 matrix", &|dump| dump["parameters"]["GL_MODELVIEW_MATRIX"] = json!([1]));
    says("/parameters/GL_PROJECTION_MATRIX: is no 4 x 4 matrix", &|dump| {
        dump["parameters"].as_object_mut().unwrap().remove("GL_PROJECTION_MATRIX");
    });
    says("flattens space", &|dump| dump["parameters"]["GL_MODELVIEW_MATRIX"][0] = json!(0));
    says("expected 1 as the fourth number", &|dump| {
        dump["draw"]["attributes"]["gl_Vertex"] = attribute(4, &[1., 0., 0., 2.].repeat(3));
    });
    says("/shaders/GL_VERTEX_PROGRAM_ARB: the draw call has such a program", &|dump| {
        dump["shaders"] = json!({"GL_VERTEX_PROGRAM_ARB": "!!ARBvp1.0"});
    });
}
