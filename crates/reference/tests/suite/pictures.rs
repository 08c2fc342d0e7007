//! Properties of the reference image, on generated scenes.

use crate::common::{IDENTITY, bumpy_sphere, frame, object, polygons, row_major, scene, sphere};
use basrelief_reference::metrics::psnr;
use basrelief_reference::{
    BrightnessComponents, PolygonRenderer, RenderOptions, RgbPicture, TextureFilter, draw_scene, object_centre,
};
use basrelief_signals::{Frame, Light, LightKind, Lighting, Material, Mesh, Polygon, Scene, Vertex};
use glam::DVec3;
use std::sync::Arc;

const EYE: DVec3 = DVec3::new(1.5, 1.2, 3.0);

fn covered(picture: &RgbPicture) -> usize {
    picture.covered.iter().filter(|&&c| c).count()
}

fn from_polygons(scene: &Scene, frame: &Frame, options: &RenderOptions) -> RgbPicture {
    let mut renderer = PolygonRenderer::new(frame.width, frame.height, *options);
    renderer.frame(frame);
    for object in &scene.objects {
        let (info, polygons) = polygons(object, frame);
        renderer.object(&info);
        polygons.iter().for_each(|polygon| renderer.polygon(polygon));
    }
    renderer.finish()
}

/// Creates a square of side 2 in the plane z = 0, facing +z, in `n * n * 2` triangles.
fn square(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..(n + 1) * (n + 1) {
        let [u, v] = [i % (n + 1), i / (n + 1)].map(|k| k as f32 / n as f32);
        mesh.positions.push([2.0 * u - 1.0, 1.0 - 2.0 * v, 0.0]);
        mesh.normals.push([0.0, 0.0, 1.0]);
        mesh.tangents.push([1.0, 0.0, 0.0, 1.0]);
        mesh.uv.push([u, v]);
        mesh.uv_normal.push([u, v]);
    }
    for i in (0..n * n).map(|k| k / n * (n + 1) + k % n) {
        mesh.indices.extend([i, i + n + 1, i + 1, i + 1, i + n + 1, i + n + 2]);
    }
    mesh
}

fn white(light: LightKind, size: u32) -> Frame {
    let mut frame = frame(size, size, DVec3::new(0.0, 0.0, 4.0));
    frame.lights = vec![Light { kind: light, intensity: 1.0 }];
    frame
}

#[test]
fn scene_and_polygons_agree_to_60_db() {
    let frame = frame(320, 240, EYE);
    let scene = bumpy_sphere(72);
    assert!(scene.objects[0].mesh.indices.len() / 3 > 2 * 8192, "more than one batch");
    for filter in [TextureFilter::Nearest, TextureFilter::Bilinear, TextureFilter::Trilinear] {
        for components in [BrightnessComponents::Combined, BrightnessComponents::Separate] {
            let options = RenderOptions { filter, components, ..RenderOptions::default() };
            let (exact, other) = (draw_scene(&scene, &frame, &options), from_polygons(&scene, &frame, &options));
            let db = psnr(&exact, &other).expect("same size");
            assert!(covered(&exact) > 20_000 && db >= 60.0, "{options:?}: {db} dB");
        }
    }
}

#[test]
fn facing_square_has_brightness_of_formula() {
    let to_light = [0.6, 0.0, 0.8];
    let lighting = Lighting { ka: 0.1, kd: 0.5, ks: 0.3, n: 8.0 };
    let material = Material { base_color: [0.5, 1.0, 0.25, 1.0], lighting, ..Material::default() };
    let scene = scene(vec![object(square(1), IDENTITY, material)]);
    let half = DVec3::new(0.6, 0.0, 1.8).normalize().z;
    let (diffuse, specular) = (0.1 + 0.5 * 0.8, 0.3 * half.powi(8));
    let eight_bits = |c: f64| (c.min(1.0) * 255.0 + 0.5) as u8;
    let combined = [0.5, 1.0, 0.25].map(|base| eight_bits(base * (diffuse + specular)));
    let separate = [0.5, 1.0, 0.25].map(|base| eight_bits(base * diffuse + specular));
    for (components, expected) in [(BrightnessComponents::Combined, combined), (BrightnessComponents::Separate, separate)] {
        let options = RenderOptions { components, ..RenderOptions::default() };
        let picture = draw_scene(&scene, &white(LightKind::Directional { to_light }, 64), &options);
        assert_eq!(picture.rgb[32 * 64 + 32], expected);
    }
}

#[test]
fn specular_term_is_not_gated() {
    let to_light = [0.0, 0.96, -0.28];
    let lighting = Lighting { ka: 0.0, kd: 1.0, ks: 1.0, n: 1.0 };
    let material = Material { lighting, ..Material::default() };
    let scene = scene(vec![object(square(1), IDENTITY, material)]);
    let picture = draw_scene(&scene, &white(LightKind::Directional { to_light }, 32), &RenderOptions::default());
    assert!(picture.rgb[16 * 32 + 16][0] > 100, "light from behind, highlight still there");
}

#[test]
fn point_lights_are_evaluated_at_world_box_centre() {
    let world = [2., 0., 0., 5., 0., 1., 0., 0., 0., 0., 1., -2., 0., 0., 0., 1.];
    let mesh = Mesh { positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.5, 3.0, 0.25]], ..Mesh::default() };
    assert_eq!(object_centre(&object(mesh, world, Material::default())), [6.0, 1.5, -1.5]);
    assert_eq!(object_centre(&object(Mesh::default(), world, Material::default())), [0.0; 3]);
    let scene = scene(vec![object(square(1), IDENTITY, Material::default())]);
    let draw = |kind| draw_scene(&scene, &white(kind, 48), &RenderOptions::default());
    let point = draw(LightKind::Point { position: [3.0, 0.0, 4.0] });
    assert_eq!(point, draw(LightKind::Directional { to_light: [0.6, 0.0, 0.8] }));
}

#[test]
fn normal_map_tilts_normal_in_tangent_frame() {
    // +Y up: the bitangent cross(N, T) of this square is +y.
    let tilted = DVec3::new(0.48, 0.36, 0.8);
    let texel = tilted.to_array().map(|c| (127.5 * (c + 1.0)).round() as u8);
    let normal_map = Some(crate::common::texture(0, 4, |_, _| texel));
    let lighting = Lighting { ka: 0.0, kd: 1.0, ks: 0.0, n: 1.0 };
    let lit = |normal_scale: f32, to_light: [f32; 3]| {
        let material = Material { normal_map: normal_map.clone(), normal_scale, lighting, ..Material::default() };
        let scene = scene(vec![object(square(1), IDENTITY, material)]);
        let options = RenderOptions { filter: TextureFilter::Bilinear, ..RenderOptions::default() };
        draw_scene(&scene, &white(LightKind::Directional { to_light }, 16), &options).rgb[8 * 16 + 8][0]
    };
    assert!(lit(1.0, [0.48, 0.36, 0.8]) >= 254);
    assert!(lit(-1.0, [-0.48, -0.36, 0.8]) >= 254);
    assert!(lit(0.0, [0.0, 0.0, 1.0]) == 255);
    assert!((f64::from(lit(1.0, [0.0, 0.0, 1.0])) - 0.8 * 255.0).abs() < 2.0);
}

#[test]
fn near_plane_clipping_keeps_the_rest() {
    let floor = [4., 0., 0., 0., 0., 0., 4., -1., 0., 4., 0., 0., 0., 0., 0., 1.];
    let frame = frame(160, 120, DVec3::new(0.3, 0.2, 2.0));
    let draw = |n| {
        let material = Material { color_texture: Some(crate::common::stripes(64)), double_sided: true, ..Material::default() };
        draw_scene(&scene(vec![object(square(n), floor, material)]), &frame, &RenderOptions::default())
    };
    let (coarse, fine) = (draw(1), draw(40));
    assert!(covered(&coarse) > 5_000);
    assert_eq!(coarse.covered, fine.covered);
    assert!(psnr(&coarse, &fine).expect("same size") > 60.0);
}

#[test]
fn front_faces_survive_mirroring() {
    let mirror = [-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    let behind = [-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 0., 1.];
    let frame = white(LightKind::Directional { to_light: [0.0, 0.0, 1.0] }, 40);
    let draw = |world, double_sided| {
        let material = Material { double_sided, ..Material::default() };
        draw_scene(&scene(vec![object(square(1), world, material)]), &frame, &RenderOptions::default())
    };
    let front = draw(IDENTITY, false);
    assert_eq!(front, draw(mirror, false));
    assert_eq!(covered(&draw(behind, false)), 0);
    assert_eq!(draw(behind, true).covered, front.covered);
}

#[test]
fn back_face_normals_reverse_on_request() {
    let behind = [-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., -1., 0., 0., 0., 0., 1.];
    let frame = white(LightKind::Directional { to_light: [0.0, 0.0, 1.0] }, 40);
    let material = Material { double_sided: true, ..Material::default() };
    let scene_of = |world| scene(vec![object(square(1), world, material.clone())]);
    let draw = |world, two_sided_lighting| {
        draw_scene(&scene_of(world), &frame, &RenderOptions { two_sided_lighting, ..RenderOptions::default() })
    };
    let front = draw(IDENTITY, false);
    assert_eq!(draw(IDENTITY, true), front);
    assert_eq!(draw(behind, true).rgb, front.rgb);
    assert_ne!(draw(behind, false).rgb, front.rgb);
    assert_eq!([draw(behind, true).backs, front.backs], [covered(&front), 0]);
}

#[test]
fn front_surface_hides_earlier_and_later_ones() {
    let near = [0.5, 0., 0., 0., 0., 0.5, 0., 0., 0., 0., 0.5, 1.5, 0., 0., 0., 1.];
    let red = Material { base_color: [1.0, 0.0, 0.0, 1.0], ..Material::default() };
    let objects = [object(sphere(80), near, red), object(sphere(80), IDENTITY, Material::default())];
    let frame = frame(200, 200, DVec3::new(0.0, 0.0, 5.0));
    let draw =
        |order: [usize; 2]| draw_scene(&scene(order.map(|i| objects[i].clone()).to_vec()), &frame, &RenderOptions::default());
    let picture = draw([0, 1]);
    assert_eq!(picture, draw([1, 0]));
    assert_eq!(picture.rgb[100 * 200 + 100][1], 0);
}

#[test]
fn renderer_draws_several_frames() {
    let scene = bumpy_sphere(12);
    let options = RenderOptions::default();
    let (info, first) = polygons(&scene.objects[0], &frame(80, 60, EYE));
    let mut renderer = PolygonRenderer::new(80, 60, options);
    first.iter().for_each(|polygon| renderer.polygon(polygon));
    assert_eq!(renderer.finish(), RgbPicture::new(80, 60), "nothing is drawn ahead of a frame");
    for eye in [EYE, -EYE] {
        let frame = frame(80, 60, eye);
        let (_, polygons) = polygons(&scene.objects[0], &frame);
        renderer.frame(&frame);
        renderer.object(&info);
        polygons.iter().for_each(|polygon| renderer.polygon(polygon));
        assert_eq!(renderer.finish(), from_polygons(&scene, &frame, &options));
    }
}

#[test]
fn polygons_are_fans_and_invalid_ones_are_dropped() {
    let frame = white(LightKind::Directional { to_light: [0.0, 0.0, 1.0] }, 16);
    let draw = |corners: &[[f32; 2]], inverse_w: f32| {
        let vertex = |&[x, y]: &[f32; 2]| Vertex { position: [x, y, 0.5, inverse_w], ..Vertex::default() };
        let vertices = corners.iter().map(vertex).collect();
        let material = Arc::new(Material::default());
        let mut renderer = PolygonRenderer::new(16, 16, RenderOptions::default());
        renderer.frame(&frame);
        renderer.polygon(&Polygon { vertices, material, object: 0, lod: 0, bump: false, arrival: 0 });
        covered(&renderer.finish())
    };
    assert_eq!(draw(&[[2.0, 2.0], [8.0, 2.0], [10.0, 4.0], [8.0, 6.0], [2.0, 6.0]], 1.0), 26);
    assert_eq!(draw(&[[2.0, 2.0], [8.0, 2.0], [f32::NAN, 6.0]], 1.0), 0);
    assert_eq!(draw(&[[2.0, 2.0], [8.0, 2.0], [8.0, 6.0]], f32::INFINITY), 0);
    assert_eq!(draw(&[[2.0, 2.0], [8.0, 2.0]], 1.0) + draw(&[], 1.0), 0);
    assert_eq!(draw(&[[-1e30, -1e30], [1e30, -1e30], [0.0, 1e30]], 1.0) % 256, 0);
}

#[test]
fn indices_out_of_range_are_dropped() {
    let mut mesh = square(1);
    mesh.indices = vec![0, 2, 99, 0, 2];
    let scene = scene(vec![object(mesh, IDENTITY, Material::default())]);
    assert_eq!(covered(&draw_scene(&scene, &frame(16, 16, EYE), &RenderOptions::default())), 0);
}

#[test]
fn depth_and_shape_follow_the_camera() {
    let frame = frame(100, 100, DVec3::new(0.0, 0.0, 4.0));
    let picture = draw_scene(&scene(vec![object(square(1), IDENTITY, Material::default())]), &frame, &RenderOptions::default());
    let corner = row_major(&frame.camera.view_projection) * DVec3::new(1.0, 1.0, 0.0).extend(1.0);
    let side = 100.0 * corner.x / corner.w;
    assert!((covered(&picture) as f64).sqrt() - side < 1.0);
    assert!(picture.covered[50 * 100 + 50] && !picture.covered[2 * 100 + 2]);
}
