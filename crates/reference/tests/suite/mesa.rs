//! Comparison of the reference image with Mesa, drawn by an independent tool from the same model file: with normal maps, in flat,
//! Gouraud and Phong shading, and with textures alone.

mod tool;

use basrelief_reference::{
    BrightnessComponents, LevelRule, PyramidLevels, RenderOptions, RenderStyle, RgbPicture, ShadingModel, TextureFilter,
    draw_scene,
};
use basrelief_scene::ViewOptions;
use basrelief_signals::{Material, Mesh, Object, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tool::{Mesa, agreement, double_sided, foreign_models, load, mode, models, name_of};

/// Returns the same scene in white, because without textures the tool also leaves out the factors of materials.
fn white(scene: &Scene) -> Scene {
    let bleached = |object: &Arc<Object>| {
        let material = Arc::new(Material { base_color: [1.0; 4], ..Material::clone(&object.material) });
        Arc::new(Object { material, ..Object::clone(object) })
    };
    Scene { objects: scene.objects.iter().map(bleached).collect(), ..scene.clone() }
}

/// Form of a mesh as glTF.
#[derive(Clone, Copy)]
struct Look<'a> {
    double_sided: bool,
    /// Scale of its node (`"scale"`).
    scale: [i8; 3],
    /// Name of its picture file, and wrap modes in glTF's numbers.
    picture: Option<(&'a str, [u32; 2])>,
}

const PLAIN: Look<'_> = Look { double_sided: true, scale: [1, 1, 1], picture: None };

/// Writes the mesh of an object as glTF, with its normals. For an OBJ file without normals each reader computes its own (the
/// tool's are split at seams of the texture: 499 of Spot's vertices differ from the importer's, by up to 36 degrees), and this
/// test does not compare normals. OBJ output is not possible, because the tool's reader drops normals and materials.
fn as_gltf(mesh: &Mesh, look: Look<'_>, folder: &Path) -> PathBuf {
    let uv: Vec<_> = (0..mesh.positions.len()).map(|i| mesh.uv.get(i).copied().unwrap_or_default()).collect();
    let vectors = mesh.positions.iter().chain(&mesh.normals).flatten().chain(uv.iter().flatten());
    let bytes: Vec<u8> = vectors.flat_map(|c| c.to_le_bytes()).chain(mesh.indices.iter().flat_map(|i| i.to_le_bytes())).collect();
    let (vertices, corners) = (mesh.positions.len(), mesh.indices.len());
    let arrays = [(12 * vertices, 5126, vertices, "VEC3"), (12 * vertices, 5126, vertices, "VEC3")];
    let arrays = arrays.into_iter().chain([(8 * vertices, 5126, vertices, "VEC2"), (4 * corners, 5125, corners, "SCALAR")]);
    let (mut views, mut accessors, mut start) = (Vec::new(), Vec::new(), 0);
    for (view, (length, component, count, kind)) in arrays.enumerate() {
        views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}}}"#));
        accessors.push(format!(r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"}}"#));
        start += length;
    }
    let (surface, picture) = look.picture.map_or_else(Default::default, |(uri, [s, t])| {
        let picture = format!(
            r#""textures":[{{"source":0,"sampler":0}}],"images":[{{"uri":"{uri}"}}],"samplers":[{{"wrapS":{s},"wrapT":{t}}}],"#
        );
        (r#","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#, picture)
    });
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":{:?}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}},"indices":3,"material":0}}]}}],
        {picture}"materials":[{{"doubleSided":{}{surface}}}],"buffers":[{{"uri":"mesh.bin","byteLength":{}}}],
        "bufferViews":[{}],"accessors":[{}]}}"#,
        look.scale,
        look.double_sided,
        bytes.len(),
        views.join(","),
        accessors.join(",")
    );
    let path = folder.join("model.gltf");
    std::fs::write(folder.join("mesh.bin"), bytes).expect("a temporary file");
    std::fs::write(&path, json).expect("a temporary file");
    path
}

fn only_mesh(scene: &Scene) -> Mesh {
    let [object] = &scene.objects[..] else { panic!("{}: one object expected", scene.name) };
    Mesh::clone(&object.mesh)
}

/// Default style of the tool.
const BUMP: RenderStyle = RenderStyle {
    shading: ShadingModel::NormalMap,
    options: RenderOptions {
        filter: TextureFilter::Bilinear,
        level: LevelRule::LongerAxis,
        pyramid: PyramidLevels::Given,
        components: BrightnessComponents::Separate,
        two_sided_lighting: false,
    },
};

fn draw(scene: &Scene, style: RenderStyle) -> RgbPicture {
    draw_scene(scene, &scene.frames[0], &style)
}

/// Draws with both and asserts agreement.
fn assert_agreement(mesa: &Mesa, name: &str, scene: &Scene, model: &Path, style: RenderStyle, cull: bool) {
    assert_agreement_to(45.0, mesa, name, scene, model, style, cull);
}

fn assert_agreement_to(least: f64, mesa: &Mesa, name: &str, scene: &Scene, model: &Path, style: RenderStyle, cull: bool) {
    let (db, differing) = agreement(&draw(scene, style), &mesa.draw(model, style, cull));
    let (mode, filter) = (mode(style.shading), style.options.filter);
    let what = format!("{name}, {mode}, texture filter: {filter:?}, culled: {cull}");
    println!("{what}: {db:.2} dB, {:.4} % of coverage differs", 100.0 * differing);
    assert!(db >= least && differing <= 0.001, "{what}: {db:.2} dB, {differing}");
}

/// Returns meshes to be written as glTF: a demo of this repository, then the OBJ files of others that exist.
fn meshes() -> Vec<(&'static str, Mesh)> {
    let folder = foreign_models();
    let foreign = ["spot.obj", "teapot.obj"].into_iter().filter_map(|name| Some((name, folder.as_ref()?.join(name))));
    let foreign = foreign.map(|(name, path)| (name, only_mesh(&load(&path))));
    std::iter::once(("goblet", goblet())).chain(foreign).collect()
}

/// Returns the mesh of the demo `goblet`, a surface of revolution.
fn goblet() -> Mesh {
    let scene = basrelief_scene::demo("goblet", &ViewOptions::default()).expect("a demo");
    Mesh::clone(&scene.objects[0].mesh)
}

#[test]
fn exact_pictures_agree_with_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    for model in
        models(&["Avocado/Avocado.gltf", "TwoSidedPlane/TwoSidedPlane.gltf", "TextureCoordinateTest/TextureCoordinateTest.gltf"])
    {
        let (name, scene) = (name_of(&model), load(&model));
        assert_agreement(&mesa, &name, &scene, &model, BUMP, true);
        assert_agreement(&mesa, &name, &double_sided(&scene), &model, BUMP, false);
    }
    for (name, mesh) in meshes() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let model = as_gltf(&mesh, PLAIN, folder.path());
        assert_agreement(&mesa, name, &load(&model), &model, BUMP, false);
    }
}

const SHADINGS: [ShadingModel; 3] = [ShadingModel::Face, ShadingModel::Gouraud, ShadingModel::Phong];

// Claim: shade, reference image: Flat, Gouraud and Phong agree with Mesa, and with each other on a fine mesh.
#[test]
fn flat_gouraud_and_phong_shading_agree_with_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    for model in models(&["Avocado/Avocado.gltf", "ClearcoatWicker.glb"]) {
        let (name, textured) = (name_of(&model), double_sided(&load(&model)));
        for shading in SHADINGS {
            let plain = RenderStyle { shading, options: RenderOptions { filter: TextureFilter::None, ..BUMP.options } };
            assert_agreement(&mesa, &name, &white(&textured), &model, plain, false);
            assert_agreement(&mesa, &name, &textured, &model, RenderStyle { shading, ..BUMP }, false);
        }
    }
    for (name, mesh) in meshes() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let model = as_gltf(&mesh, PLAIN, folder.path());
        let scene = load(&model);
        for shading in SHADINGS {
            assert_agreement(&mesa, name, &scene, &model, RenderStyle { shading, ..BUMP }, false);
        }
    }
}

/// The models above are closed or double-sided, so culling is invisible in them. A goblet without every second triangle is open.
#[test]
fn culling_agrees_with_mesa_mirrored_or_not() {
    let Some(mesa) = Mesa::find() else { return };
    let mut mesh = goblet();
    mesh.indices = mesh.indices.chunks_exact(3).step_by(2).flatten().copied().collect();
    for scale in [[1, 1, 1], [-1, 1, 1]] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let model = as_gltf(&mesh, Look { double_sided: false, scale, ..PLAIN }, folder.path());
        let scene = load(&model);
        let open = double_sided(&scene);
        let count = |picture: RgbPicture| picture.covered.iter().filter(|&&c| c).count();
        let (culled, all) = (count(draw(&scene, BUMP)), count(draw(&open, BUMP)));
        assert!(culled + 1_000 < all, "culling must show: {culled} of {all} pixels");
        let name = format!("half a goblet, scaled by {scale:?}");
        for shading in [ShadingModel::NormalMap, ShadingModel::Face] {
            assert_agreement(&mesa, &name, &scene, &model, RenderStyle { shading, ..BUMP }, true);
            assert_agreement(&mesa, &name, &open, &model, RenderStyle { shading, ..BUMP }, false);
        }
    }
}

/// Returns the style of textures without light, with this filter.
fn textured(filter: TextureFilter) -> RenderStyle {
    RenderStyle { shading: ShadingModel::Texture, options: RenderOptions { filter, ..BUMP.options } }
}

const MODELS: [&str; 6] = [
    "Avocado/Avocado.gltf",
    "TwoSidedPlane/TwoSidedPlane.gltf",
    "TextureCoordinateTest/TextureCoordinateTest.gltf",
    "ClearcoatWicker.glb",
    "ClearCoatCarPaint.glb",
    "NormalTangentTest.glb",
];

/// Draws with each filter, and asserts 45 dB, or `of_levels` dB with MIP levels.
///
/// With levels the pictures differ by more than rounding. Mesa takes differences between neighbouring pixels for the derivatives
/// that decide the level, and rounds the means of its levels in its own way. Measured: 56 dB and more. If a side is no power of
/// two, the levels themselves differ, because OpenGL does not define their computation: Mesa resamples the finer level with two
/// taps, and here boxes share texels ([`basrelief_scene::pyramid`]). Measured: 36 dB.
fn assert_textures_agree(mesa: &Mesa, name: &str, scene: &Scene, model: &Path, of_levels: f64) {
    let filters = [(TextureFilter::Nearest, 45.0), (TextureFilter::Bilinear, 45.0), (TextureFilter::Trilinear, of_levels)];
    for (filter, least) in filters {
        assert_agreement_to(least, mesa, name, scene, model, textured(filter), false);
    }
}

// Claim: images: Texture mapping alone agrees with Mesa on six models, on Spot, and with sides that are no power of two in every
// wrap mode.
#[test]
fn textures_agree_with_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    for model in models(&MODELS) {
        assert_textures_agree(&mesa, &name_of(&model), &double_sided(&load(&model)), &model, 45.0);
    }
}

/// Spot with its texture: we read OBJ and MTL, the tool reads glTF, because it drops materials of OBJ files.
// Claim: as textures_agree_with_mesa.
#[test]
fn obj_texture_agrees_with_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    let Some(models) = foreign_models() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name);
    let plain = std::fs::read_to_string(models.join("spot.obj")).expect("Spot");
    std::fs::copy(models.join("spot_texture.png"), file("spot.png")).expect("Spot's texture");
    std::fs::write(file("spot.mtl"), "newmtl skin\nmap_Kd spot.png\n").expect("a temporary file");
    std::fs::write(file("spot.obj"), format!("mtllib spot.mtl\nusemtl skin\n{plain}")).expect("a temporary file");
    assert_obj_agrees(&mesa, folder.path(), "spot.obj", "spot.png");
}

/// A quad of our own with its texture, without the colour and the normal map of its material.
// Claim: as textures_agree_with_mesa.
#[test]
fn own_obj_texture_agrees_with_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/models");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let copied = |name: &str| std::fs::copy(models.join(name), folder.path().join(name)).expect("a model of our own");
    ["patch.obj", "checks.png"].iter().for_each(|name| _ = copied(name));
    std::fs::write(folder.path().join("patch.mtl"), "newmtl bumpy\nmap_Kd checks.png\n").expect("a temporary file");
    assert_obj_agrees(&mesa, folder.path(), "patch.obj", "checks.png");
}

/// Draws an OBJ file of one mesh, and the same mesh as glTF with the picture of its material.
fn assert_obj_agrees(mesa: &Mesa, folder: &Path, name: &str, picture: &str) {
    let scene = load(&folder.join(name));
    let mesh = only_mesh(&scene);
    assert!(scene.objects[0].material.color_texture.is_some() && !mesh.uv.is_empty(), "{:?}", scene.warnings);
    let model = as_gltf(&mesh, Look { picture: Some((picture, [10497, 10497])), ..PLAIN }, folder);
    assert_textures_agree(mesa, name, &scene, &model, 45.0);
}

/// A floor that extends to the horizon. Its texture is not square, its sides are no powers of two, and it uses each wrap mode of
/// glTF.
// Claim: as textures_agree_with_mesa.
#[test]
fn textures_of_any_size_and_wrap_agree_with_mesa() {
    let Some(mesa) = Mesa::find() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let odd = image::RgbImage::from_fn(101, 38, |x, y| {
        let ring = ((f64::from(x) - 30.0) / 9.0, (f64::from(y) - 12.0) / 7.0);
        let wave = |t: f64| (127.5 + 100.0 * libm::sin(t)) as u8;
        image::Rgb([wave(ring.0 * ring.0 + ring.1 * ring.1), wave(f64::from(x) / 8.0), (6 * y) as u8])
    });
    odd.save(folder.path().join("odd.png")).expect("a temporary file");
    let [repeat, mirror, clamp] = [10497, 33648, 33071];
    for wrap in [[repeat, mirror], [mirror, clamp], [clamp, repeat]] {
        let model = as_gltf(&floor(), Look { picture: Some(("odd.png", wrap)), ..PLAIN }, folder.path());
        assert_textures_agree(&mesa, &format!("odd.png {wrap:?}"), &load(&model), &model, 33.0);
    }
}

/// Creates a square of two triangles seen at a low angle, with texture coordinates from -1.5 to 2.5.
fn floor() -> Mesh {
    let corners = [[-1.0, 4.0], [1.0, 4.0], [1.0, -4.0], [-1.0, -4.0_f32]];
    Mesh {
        positions: corners.map(|[x, z]| [x, 0.0, z]).to_vec(),
        normals: vec![[0.0, 1.0, 0.0]; 4],
        uv: corners.map(|[x, z]| [0.5 + 2.0 * x, 0.5 + 0.5 * z]).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}
