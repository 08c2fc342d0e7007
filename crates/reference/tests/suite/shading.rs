//! Light at vertices and once per polygon, on generated scenes.

use crate::common::{IDENTITY, bumpy_sphere, frame, object, polygons, scene, sphere};
use basrelief_reference::metrics::psnr;
use basrelief_reference::{
    BrightnessComponents, PolygonRenderer, RenderOptions, RenderStyle, RgbPicture, ShadingModel, TextureFilter, draw_scene,
};
use basrelief_signals::{Frame, Light, LightKind, Lighting, Material, Mesh, Polygon, Scene, Vertex};
use glam::DVec3;
use std::sync::Arc;

const ALL: [ShadingModel; 5] =
    [ShadingModel::NormalMap, ShadingModel::Phong, ShadingModel::Gouraud, ShadingModel::Face, ShadingModel::Mean];
const EYE: DVec3 = DVec3::new(1.5, 1.2, 3.0);
const TO_LIGHT: [f32; 3] = [0.6, 0.0, 0.8];
const LIGHTING: Lighting = Lighting { ka: 0.1, kd: 0.5, ks: 0.375, n: 8.0 };
const SIDE: u32 = 64;

/// Returns a style with the colours of the shading device: white highlights, no textures.
fn plain(shading: ShadingModel) -> RenderStyle {
    let options =
        RenderOptions { filter: TextureFilter::None, components: BrightnessComponents::Separate, ..RenderOptions::default() };
    RenderStyle { shading, options }
}

fn from_polygons(scene: &Scene, frame: &Frame, style: &RenderStyle) -> RgbPicture {
    let mut renderer = PolygonRenderer::new(frame.width, frame.height, *style);
    renderer.frame(frame);
    for object in &scene.objects {
        let (info, polygons) = polygons(object, frame);
        renderer.object(&info);
        polygons.iter().for_each(|polygon| renderer.polygon(polygon));
    }
    renderer.finish()
}

/// Returns a frame with one light from [`TO_LIGHT`], and the eye on the z axis.
fn facing() -> Frame {
    let lights = vec![Light { kind: LightKind::Directional { to_light: TO_LIGHT }, intensity: 1.0 }];
    Frame { lights, ..frame(SIDE, SIDE, DVec3::new(0.0, 0.0, 4.0)) }
}

/// Returns ambient and diffuse, and specular brightness by the formula, in the view and light of [`facing`].
fn terms(normal: DVec3) -> [f64; 2] {
    let to_light = DVec3::from(TO_LIGHT.map(f64::from)).normalize();
    let half = (to_light + DVec3::Z).normalize();
    let [ka, kd, ks] = [LIGHTING.ka, LIGHTING.kd, LIGHTING.ks].map(f64::from);
    [ka + kd * normal.dot(to_light).max(0.0), ks * normal.dot(half).max(0.0).powi(8)]
}

/// Returns normals that fan out from the corners of a triangle by different amounts.
fn normals() -> [DVec3; 3] {
    [[-0.3, 0.1, 0.9], [0.9, 0.2, 0.7], [0.3, -0.8, 0.6]].map(|n| DVec3::from(n).normalize())
}

/// Creates a triangle in the plane z = 0, facing +z, with [`normals`].
fn triangle() -> Mesh {
    let positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    let normals = normals().map(|n| n.as_vec3().to_array()).to_vec();
    Mesh { positions, normals, indices: vec![0, 1, 2], ..Mesh::default() }
}

fn channel(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

#[test]
fn scene_and_polygons_agree_to_60_db_in_each_shading() {
    let frame = frame(320, 240, EYE);
    let scene = bumpy_sphere(40);
    for shading in ALL {
        for filter in [TextureFilter::None, TextureFilter::Bilinear] {
            let options = RenderOptions { filter, ..plain(shading).options };
            let style = RenderStyle { shading, options };
            let (exact, other) = (draw_scene(&scene, &frame, &style), from_polygons(&scene, &frame, &style));
            let db = psnr(&exact, &other).expect("same size");
            println!("{style:?}: {db:.2} dB");
            assert!(db >= 60.0, "{style:?}: {db} dB");
        }
    }
}

#[test]
fn polygon_has_brightness_of_its_normal_or_vertices() {
    let material = Material { base_color: [0.5, 1.0, 0.25, 1.0], lighting: LIGHTING, ..Material::default() };
    let scene = scene(vec![object(triangle(), IDENTITY, material)]);
    let of_vertices = normals().map(terms);
    let mean = [0, 1].map(|k| of_vertices.iter().map(|pair| pair[k]).sum::<f64>() / 3.0);
    for (shading, [diffuse, specular]) in [(ShadingModel::Face, terms(DVec3::Z)), (ShadingModel::Mean, mean)] {
        for components in [BrightnessComponents::Separate, BrightnessComponents::Combined] {
            let style = RenderStyle { shading, options: RenderOptions { components, ..plain(shading).options } };
            let highlight = |base| if components == BrightnessComponents::Combined { base * specular } else { specular };
            let expected = [0.5, 1.0, 0.25].map(|base| channel(base * diffuse + highlight(base)));
            for picture in [draw_scene(&scene, &facing(), &style), from_polygons(&scene, &facing(), &style)] {
                let drawn = picture.rgb.iter().zip(&picture.covered).filter(|(_, covered)| **covered);
                assert!(drawn.clone().count() > 200);
                assert!(drawn.clone().all(|(rgb, _)| *rgb == expected), "{style:?}: {expected:?}");
            }
        }
    }
}

/// Constant shading of the shading device: the mean over the sample points of the polygon, three or more.
#[test]
fn mean_is_over_all_vertices_of_polygon() {
    let corner = |[x, y]: [f32; 2], normal: DVec3| {
        let normal = normal.as_vec3().to_array();
        Vertex { position: [x, y, 0.5, 1.0], normal, ..Vertex::default() }
    };
    let [a, b, c] = normals();
    let corners = [[10.0, 10.0], [50.0, 12.0], [54.0, 30.0], [40.0, 50.0], [8.0, 40.0]];
    let vertices: Vec<_> = corners.into_iter().zip([a, b, c, c, DVec3::Z]).map(|(at, n)| corner(at, n)).collect();
    let material = Arc::new(Material { lighting: LIGHTING, ..Material::default() });
    let mut renderer = PolygonRenderer::new(SIDE, SIDE, plain(ShadingModel::Mean));
    renderer.frame(&facing());
    renderer.polygon(&Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 });
    let mean = [a, b, c, c, DVec3::Z].map(|n| terms(n).iter().sum::<f64>()).iter().sum::<f64>() / 5.0;
    let picture = renderer.finish();
    for at in [[20, 20], [50, 25], [14, 38]] {
        assert_eq!(picture.rgb[at[1] * SIDE as usize + at[0]], [channel(mean); 3]);
    }
}

/// Light at the vertices is a colour at the vertices: interpolated perspective-correctly, unsaturated, and unchanged by clipping.
#[test]
fn gouraud_interpolates_vertex_light() {
    let floor = [4., 0., 0., 0., 0., 0., 4., -0.25, 0., 4., 0., 0., 0., 0., 0., 1.];
    let frame = Frame { lights: facing().lights, ..frame(160, 120, DVec3::new(0.3, 0.2, 2.0)) };
    let to_viewer = DVec3::from(frame.camera.to_viewer);
    let half = (DVec3::from(TO_LIGHT.map(f64::from)).normalize() + to_viewer).normalize();
    let lit = Mesh { normals: normals().map(|n| n.as_vec3().to_array()).to_vec(), ..triangle() };
    let lighting = Lighting { ka: 0.0, kd: 0.0, ks: 1.5, n: 3.0 };
    let shiny = Material { lighting, double_sided: true, ..Material::default() };
    let drawn = draw_scene(&scene(vec![object(lit.clone(), IDENTITY, shiny.clone())]), &frame, &plain(ShadingModel::Gouraud));
    let brightness = |n: DVec3| 1.5 * n.dot(half).max(0.0).powi(3);
    let painted = Mesh { colors: normals().map(|n| [brightness(n) as f32; 4]).to_vec(), ..triangle() };
    let glowing =
        Material { lighting: Lighting { ka: 1.0, kd: 0.0, ks: 0.0, n: 1.0 }, double_sided: true, ..Material::default() };
    let expected =
        draw_scene(&scene(vec![object(painted.clone(), IDENTITY, glowing.clone())]), &frame, &plain(ShadingModel::Phong));
    assert!(drawn.covered.iter().filter(|c| **c).count() > 1_000);
    assert!(psnr(&drawn, &expected).expect("same size") > 70.0);
    // The floor extends below the eye and behind it. Its transform exchanges y and z.
    let turned = |n: DVec3| DVec3::new(n.x, n.z, n.y).as_vec3().to_array();
    let lit = Mesh { normals: normals().map(turned).to_vec(), ..lit };
    let drawn = draw_scene(&scene(vec![object(lit, floor, shiny)]), &frame, &plain(ShadingModel::Gouraud));
    let expected = draw_scene(&scene(vec![object(painted, floor, glowing)]), &frame, &plain(ShadingModel::Phong));
    assert!(drawn.covered.iter().filter(|c| **c).count() > 5_000);
    assert!(psnr(&drawn, &expected).expect("same size") > 70.0);
}

// Claim: as flat_gouraud_and_phong_shading_agree_with_mesa.
#[test]
fn fine_mesh_looks_the_same_in_every_shading() {
    let frame = frame(160, 120, EYE);
    let picture = |rings, shading| {
        let material = Material { lighting: LIGHTING, ..Material::default() };
        draw_scene(&scene(vec![object(sphere(rings), IDENTITY, material)]), &frame, &plain(shading))
    };
    for shading in [ShadingModel::Gouraud, ShadingModel::Face, ShadingModel::Mean] {
        let db = |rings| psnr(&picture(rings, ShadingModel::Phong), &picture(rings, shading)).expect("same size");
        let (coarse, fine) = (db(6), db(120));
        assert!(coarse < 35.0 && fine > 45.0, "{shading:?}: {coarse} and {fine} dB");
    }
}

#[test]
fn missing_textures_leave_factor_and_vertex_colour() {
    let frame = frame(120, 90, EYE);
    let mut bare = bumpy_sphere(20);
    let object = Arc::make_mut(&mut bare.objects[0]);
    object.material = Arc::new(Material { color_texture: None, normal_map: None, ..Material::clone(&object.material) });
    for shading in ALL {
        let textured =
            RenderStyle { options: RenderOptions { filter: TextureFilter::Trilinear, ..plain(shading).options }, shading };
        let left_out = draw_scene(&bumpy_sphere(20), &frame, &plain(shading));
        assert_eq!(left_out, draw_scene(&bare, &frame, &textured), "{shading:?}");
        assert_ne!(left_out, draw_scene(&bumpy_sphere(20), &frame, &textured), "{shading:?}");
    }
}

#[test]
fn back_face_normals_reverse_at_vertices_and_faces() {
    let behind = [-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 0., 1.];
    let lights = vec![Light { kind: LightKind::Directional { to_light: [0.0, 0.0, 1.0] }, intensity: 1.0 }];
    let frame = Frame { lights, ..facing() };
    let mesh = Mesh { normals: vec![[0.0, 0.0, 1.0]; 3], ..triangle() };
    for shading in ALL {
        let draw = |world, two_sided_lighting| {
            let material = Material { double_sided: true, ..Material::default() };
            let scene = scene(vec![object(mesh.clone(), world, material)]);
            let options = RenderOptions { two_sided_lighting, ..plain(shading).options };
            draw_scene(&scene, &frame, &RenderStyle { shading, options }).rgb[32 * SIDE as usize + 32][0]
        };
        let front = draw(IDENTITY, false);
        assert!(front > 200);
        assert_eq!([draw(IDENTITY, true), draw(behind, true)], [front; 2], "{shading:?}");
        assert!(draw(behind, false) < 100, "{shading:?}");
    }
}
