//! Situations from public bug reports: `tests/inputs/reports/` has an input for each, with the right result in note.md.

use basrelief_scene::{ViewOptions, load_path};
use basrelief_signals::{Mesh, Object, Scene};
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/inputs/reports").join(name)
}

fn load(name: &str, file: &str) -> Scene {
    load_path(&folder(name).join(file), &ViewOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn obj(name: &str) -> Scene {
    load(name, "m.obj")
}

/// Lowest and highest place of an object in the world.
fn bounds(object: &Object) -> [[f64; 3]; 2] {
    let (mut lowest, mut highest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for index in &object.mesh.indices {
        let [x, y, z] = object.mesh.positions[*index as usize].map(f64::from);
        for (axis, row) in object.world.as_chunks::<4>().0[..3].iter().enumerate() {
            let c = row[0] * x + row[1] * y + row[2] * z + row[3];
            lowest[axis] = lowest[axis].min(c);
            highest[axis] = highest[axis].max(c);
        }
    }
    [lowest, highest]
}

/// Area of the triangles of a mesh in the plane z = 0: all of it, and counter-clockwise less clockwise.
fn areas(mesh: &Mesh) -> [f64; 2] {
    let corner = |i: u32| mesh.positions[i as usize].map(f64::from);
    let triangles = mesh.indices.as_chunks::<3>().0.iter().map(|t| t.map(corner));
    let signed = triangles.map(|[a, b, c]| ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0);
    signed.fold([0.0; 2], |[all, sum], area| [all + area.abs(), sum + area])
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

#[track_caller]
fn is_square(scene: &Scene, half: f64) {
    let expected = [[-half, -half, 0.0], [half, half, 0.0]];
    let bounds = bounds(&scene.objects[0]);
    assert!(bounds.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| close(*a, *b)), "{bounds:?}");
}

#[track_caller]
fn warns(scene: &Scene, parts: &[&str]) {
    let found = |part: &&str| scene.warnings.iter().any(|warning| warning.contains(*part));
    assert!(parts.iter().all(found) && scene.warnings.len() == parts.len(), "{:?}, expected {parts:?}", scene.warnings);
}

/// Base colours of the objects, by their place from left to right.
fn colors(scene: &Scene) -> Vec<[f32; 3]> {
    let mut objects: Vec<_> = scene.objects.iter().collect();
    objects.sort_by(|a, b| bounds(a)[0][0].total_cmp(&bounds(b)[0][0]));
    objects.iter().map(|object| std::array::from_fn(|i| object.material.base_color[i])).collect()
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];

#[test]
fn jpeg_reports_agree_with_libjpeg() {
    let kinds = [
        "noninterleaved-1x2",
        "noninterleaved-2x2",
        "scans-ni3-2x2",
        "chroma-larger",
        "sf-1x1.2x1.2x1",
        "sf-optimize_1x1.2x1.2x1",
        "sf-1x1.2x2.2x2_progressive",
        "sf-3x1",
        "sf-3x2",
    ];
    for kind in kinds {
        let name = format!("jpeg-{kind}");
        let scene = load(&name, "q.gltf");
        let texture = scene.objects[0].material.color_texture.as_ref().unwrap();
        let expected = image::open(folder(&name).join("expected.png")).unwrap().into_rgb8();
        let ours = texture.levels[0].texels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
        let sum: f64 = ours.zip(expected.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
        assert!(sum / (expected.as_raw().len() as f64) < 4.0, "{name}: {}", sum / expected.as_raw().len() as f64);
    }
}

#[test]
fn arithmetic_and_cut_jpegs_are_named_errors() {
    for (name, part) in [("jpeg-arith", "uses arithmetic coding, which is not supported"), ("jpeg-cut-half", "is cut off")] {
        let error = load_path(&folder(name).join("q.gltf"), &ViewOptions::default()).err().unwrap().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn byte_order_mark_of_obj_is_skipped() {
    is_square(&obj("obj-bom-first-vertex"), 0.5);
    warns(&obj("obj-bom-first-vertex"), &[]);
    assert_eq!(colors(&obj("obj-bom-mtllib")), [RED]);
}

#[test]
fn comment_with_backslash_hides_no_vertex() {
    is_square(&obj("obj-comment-backslash"), 0.5);
}

#[test]
fn concave_faces_have_the_area_of_their_polygon() {
    for (name, area) in [("L-1", 1.12), ("L-2", 1.12), ("L-5", 1.12), ("quad-1", 0.8), ("quad-3", 0.8)] {
        let [all, sum] = areas(&obj(&format!("obj-concave-{name}")).objects[0].mesh);
        assert!(close(all, area) && close(sum.abs(), area), "{name}: {all} {sum}");
    }
}

#[test]
fn lines_that_end_in_cr_are_read() {
    is_square(&obj("obj-cr-only"), 0.5);
}

#[test]
fn material_names_are_compared_as_bytes() {
    assert_eq!(colors(&obj("obj-gbk-names")), [RED, GREEN]);
    assert_eq!(obj("obj-gbk-names").objects[0].name, "\\xba\\xecɫ");
    assert_eq!(colors(&obj("obj-hash-names")), [RED, GREEN]);
}

#[test]
fn several_libraries_of_one_statement_are_read() {
    assert_eq!(colors(&obj("obj-mtllib-two")), [RED]);
}

#[test]
fn backslash_at_the_end_of_a_name_is_a_warning() {
    let scene = obj("obj-usemtl-backslash-end");
    assert!(scene.warnings.iter().any(|w| w.starts_with("line 6: a name that ends in a backslash")), "{:?}", scene.warnings);
}

/// Sets of face normals, in the order of the triangles.
fn corner_normals(scene: &Scene) -> Vec<[f32; 3]> {
    let mesh = &scene.objects[0].mesh;
    mesh.indices.iter().map(|i| mesh.normals[*i as usize]).collect()
}

#[test]
fn smoothing_off_gives_flat_faces() {
    let reference = corner_normals(&obj("obj-smooth-reference-normals"));
    for name in ["obj-smooth-0", "obj-smooth-off"] {
        assert_eq!(corner_normals(&obj(name)), reference, "{name}");
        warns(&obj(name), &[]);
    }
}

#[test]
fn file_without_smoothing_groups_is_smooth_with_a_warning() {
    let scene = obj("obj-smooth-none");
    warns(&scene, &["neither smoothing groups (`s`) nor normals"]);
    let diagonal = 1.0 / 3.0f32.sqrt();
    assert!(corner_normals(&scene).iter().flatten().all(|c| (c.abs() - diagonal).abs() < 1e-6));
}

#[test]
fn map_coordinates_keep_their_shape() {
    let (local, far) = (obj("obj-utm-local"), obj("obj-utm-offset"));
    assert_eq!(local.objects[0].mesh, far.objects[0].mesh);
    let offset = |scene: &Scene| [3, 7, 11].map(|i| scene.objects[0].world[i]);
    assert_eq!(offset(&local), [0.0; 3]);
    assert_eq!(offset(&far)[..2], [4_471_234.0, 5_331_245.0]);
    let height = |scene: &Scene| bounds(&scene.objects[0]).map(|point| point[2]);
    assert!(height(&local).iter().zip(height(&far)).all(|(a, b)| (b - a - 512.0).abs() < 1e-9));
}

#[test]
fn odd_vertex_colours_are_warnings() {
    warns(&obj("obj-vcolor-255"), &["vertex colours beyond 0..=1"]);
    for (name, count) in [("obj-vcolor-w", "7"), ("obj-vcolor-w8", "8")] {
        let scene = obj(name);
        warns(&scene, &[&format!("vertices of {count}")]);
        assert_eq!(scene.objects[0].mesh.colors[0], [1.0, 0.0, 0.0, 1.0]);
    }
}

#[test]
fn unused_mtl_statements_are_named() {
    for (name, parts) in [
        ("mtl-disp", &["`disp`"][..]),
        ("mtl-map-d", &["`map_d`"]),
        ("mtl-map-ka-only", &["`map_Ka`"]),
        ("mtl-map-ks", &["`map_Ks`", "`map_Ns`", "`map_Ke`"]),
        ("mtl-Kd0", &["its `Kd` is black"]),
        ("mtl-opt-colorspace", &["`-colorspace`"]),
        ("mtl-comment", &[]),
        ("mtl-tex-plain", &[]),
        ("mtl-tex-scale", &[]),
        ("mtl-tex-offset", &[]),
    ] {
        warns(&obj(name), parts);
    }
    for name in ["mtl-comment", "mtl-opt-colorspace"] {
        assert!(obj(name).objects[0].material.color_texture.is_some(), "{name}");
    }
}

#[test]
fn ks_ns_and_illum_set_the_lighting_coefficients() {
    let lighting = |name: &str| {
        let lighting = obj(name).objects[0].material.lighting;
        [lighting.ka, lighting.kd, lighting.ks, lighting.n]
    };
    assert_eq!(lighting("mtl-kskn"), [0.1, 0.8, 1.0, 200.0]);
    assert_eq!(lighting("mtl-illum0")[..3], [1.0, 0.0, 0.0]);
    warns(&obj("mtl-kskn"), &[]);
}

/// Scale and offset in the file's coordinates, v up; the mesh has v down.
#[test]
fn map_options_scale_and_move_texture_coordinates() {
    let uv = |name: &str| obj(name).objects[0].mesh.uv.clone();
    assert_eq!(uv("mtl-tex-plain"), [[0., 1.], [1., 1.], [1., 0.], [0., 0.]]);
    assert_eq!(uv("mtl-tex-scale"), [[0., 1.], [2., 1.], [2., -1.], [0., -1.]]);
    assert_eq!(uv("mtl-tex-offset"), [[0.5, 0.5], [1.5, 0.5], [1.5, -0.5], [0.5, -0.5]]);
}

#[test]
fn surface_that_only_emits_shows_its_emission() {
    let scene = load("gltf-emissive-only", "m.gltf");
    let material = &scene.objects[0].material;
    assert_eq!(material.base_color, [1.0, 0.5, 0.0, 1.0]);
    assert_eq!((material.lighting.ka, material.lighting.kd, material.lighting.ks), (1.0, 0.0, 0.0));
    warns(&scene, &[]);
}

#[test]
fn default_weights_of_morph_targets_are_applied() {
    let scene = load("gltf-morph-weights", "m.gltf");
    is_square(&scene, 0.5);
    warns(&scene, &[]);
}

#[test]
fn joints_place_a_skinned_mesh_and_its_node_does_not() {
    let scene = load("gltf-skin-scale", "m.gltf");
    is_square(&scene, 0.5);
    warns(&scene, &[]);
}
