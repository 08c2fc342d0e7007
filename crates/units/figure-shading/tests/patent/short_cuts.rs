//! Short cuts 2 and 3 (flat; same plane as before), and Figure 6.

use crate::chain::{Config, SIDE, direction, draw, feed, frame, lighting, polygon, shade, sun, triangle};
use basrelief_figure_shading::{CpuProcess, Microcomputer, PolygonRoute, ShadingMode, SumClamp};
use basrelief_shading::saturated;
use basrelief_signals::{Camera, Control, Frame, Light, Lighting, Material, Polygon};
use glam::Vec3;
use proptest::prelude::*;
use std::sync::Arc;

const SQUARE: [[f32; 2]; 4] = [[2.0, 2.0], [30.0, 2.0], [30.0, 30.0], [2.0, 30.0]];

/// Returns the largest change of brightness with a normal: Kd + n*Ks per unit of distance and light.
fn slope(lighting: &Lighting) -> f32 {
    lighting.kd + lighting.n * lighting.ks
}

proptest! {
    // Claim: as polygon_of_different_colours_is_not_flat.
    // Claim: as default_tolerances_move_output_by_at_most_1.
    #[test]
    fn flatness_changes_output_within_tolerance(
        t in triangle(), normal in direction(), off in prop::array::uniform3(direction()), light in direction(),
        lighting in lighting(), share in 0f32..0.9, tolerance in prop::sample::select(vec![1e-5f32, 1e-3, 0.05]),
    ) {
        let normals = off.map(|o| normal + 0.5 * share * tolerance * o);
        let mut config = Config::default();
        config.short_cuts.flatness.tolerance = tolerance;
        let lights = vec![sun(light)];
        let flat = draw(&config, lights.clone(), polygon(&t, &normals, lighting));
        prop_assert_eq!(flat.figure.expect("a figure").route, PolygonRoute::Flat);
        let full = draw(&config.plain(), lights, polygon(&t, &normals, lighting));
        // Each normal lies within the tolerance of the first, so any mean of them lies within twice that of any other. A
        // negligible specular term may be missing, at most half a step.
        let most = 2.0 * tolerance * slope(&lighting) + 1.0 / 510.0 + 1e-4;
        prop_assert_eq!(flat.dots.len(), full.dots.len());
        for (a, b) in flat.dots.iter().zip(&full.dots) {
            prop_assert!((a.brightness[0] - b.brightness[0]).abs() <= most, "{a:?} {b:?} {most}");
        }
    }

    #[test]
    fn curved_polygon_is_never_flat(t in triangle(), normal in direction(), off in direction(), far in 1.125f32..100.0) {
        let config = Config::default();
        let other = normal + far * config.short_cuts.flatness.tolerance * off;
        prop_assume!((other - normal).length() > 1.01 * config.short_cuts.flatness.tolerance);
        let shaded = draw(&config, vec![sun(Vec3::Z)], polygon(&t, &[normal, normal, other], Lighting::default()));
        prop_assert!(shaded.mean.is_empty());
    }

    // Claim: shade, short cut 3, Figure 7: Same plane changes no output beyond the tolerance. Reused values are not computed.
    #[test]
    fn same_plane_changes_output_within_tolerance(
        first in triangle(), second in triangle(), normal in direction(), off in direction(), light in direction(),
        lighting in lighting(), share in 0f32..0.9, tolerance in prop::sample::select(vec![1e-5f32, 1e-3]),
    ) {
        let mut config = Config::default();
        config.short_cuts.same_plane.normal_tolerance = tolerance;
        let other = normal + share * tolerance * off;
        let second = polygon(&second, &[other; 3], lighting);
        let mut unit = config.microcomputer();
        feed(&mut unit, [frame(vec![sun(light)])]);
        let stored = shade(&mut unit, &config, polygon(&first, &[normal; 3], lighting));
        prop_assume!(!stored.dots.is_empty());
        let reused = shade(&mut unit, &config, second.clone());
        prop_assert_eq!(reused.figure.expect("a figure").route, PolygonRoute::Reused);
        let fresh = draw(&config, vec![sun(light)], second);
        for (a, b) in reused.dots.iter().zip(&fresh.dots) {
            prop_assert!((a.brightness[0] - b.brightness[0]).abs() <= tolerance * slope(&lighting) + 1.0 / 510.0 + 1e-5);
        }
    }
}

// Claim: shade, 1, flatness decision: A polygon is flat if its normals are equal within a tolerance and its colours are equal.
#[test]
fn polygon_of_different_colours_is_not_flat() {
    let Control::Polygon(white) = polygon(&SQUARE, &[Vec3::Z; 4], Lighting::default()) else { unreachable!() };
    let mut coloured = Polygon::clone(&white);
    coloured.vertices[2].color = [1.0, 0.0, 0.0, 1.0];
    let route = |polygon| draw(&Config::default(), vec![sun(Vec3::Z)], Control::Polygon(polygon)).figure.expect("a figure").route;
    assert_eq!((route(white), route(Arc::new(coloured))), (PolygonRoute::Flat, PolygonRoute::Normal));
}

// Claim: shade, short cut 2: Flatness changes no output beyond the tolerance.
#[test]
fn default_tolerances_move_output_by_at_most_1() {
    let lighting = Lighting { ka: 0.1, kd: 0.8, ks: 0.4, n: 200.0 };
    for i in 0..200 {
        let off = Vec3::new(0.9e-5, 0.0, 0.0);
        let normal = Vec3::new(0.02 * (i as f32 / 20.0 - 5.0), 0.03, 1.0).normalize();
        let square = polygon(&SQUARE, &[normal, normal + off, normal + off, normal], lighting);
        let with = draw(&Config::default(), vec![sun(Vec3::Z)], square.clone()).dots;
        let without = draw(&Config::default().plain(), vec![sun(Vec3::Z)], square).dots;
        for (a, b) in with.iter().zip(&without) {
            assert!(saturated(a.brightness)[0].abs_diff(saturated(b.brightness)[0]) <= 1);
        }
    }
}

/// A name, and a change.
type Change<T> = (&'static str, fn(&mut T));

/// Inputs that may change between two polygons of one plane.
#[derive(Clone)]
struct Scene {
    to_viewer: [f64; 3],
    light: Light,
    lighting: Lighting,
    color: [f32; 4],
    point_color: [f32; 4],
    depth: f32,
}

impl Scene {
    fn new() -> Self {
        let (to_viewer, light) = ([0.0, 0.0, 1.0], sun(Vec3::new(0.1, 0.2, 1.0)));
        let lighting = Lighting { ka: 0.1, kd: 0.5, ks: 0.3, n: 20.0 };
        Self { to_viewer, light, lighting, color: [1.0; 4], point_color: [1.0; 4], depth: 0.5 }
    }

    fn frame(&self) -> Control {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: self.to_viewer };
        Control::Frame(Arc::new(Frame { width: SIDE, height: SIDE, camera, lights: vec![self.light], ..Frame::default() }))
    }

    fn polygon(&self) -> Control {
        let Control::Polygon(polygon) = polygon(&SQUARE, &[Vec3::Z; 4], self.lighting) else { unreachable!() };
        let mut polygon = Polygon::clone(&polygon);
        polygon.material = Arc::new(Material { lighting: self.lighting, base_color: self.color, ..Material::default() });
        for vertex in &mut polygon.vertices {
            vertex.color = self.point_color;
            vertex.position[2] = self.depth;
        }
        Control::Polygon(Arc::new(polygon))
    }
}

/// Returns the route of the second polygon, drawn by `unit` after the first of `before`.
fn second(before: &Scene, after: &Scene, config: &Config) -> PolygonRoute {
    let first = Config::default();
    let mut unit = first.microcomputer();
    feed(&mut unit, [before.frame()]);
    assert_eq!(shade(&mut unit, &first, before.polygon()).figure.expect("a figure").route, PolygonRoute::Flat);
    let mut other: Microcomputer = config.microcomputer();
    other.state = unit.state.clone();
    feed(&mut other, [Control::FrameEnd, after.frame()]);
    shade(&mut other, config, after.polygon()).figure.expect("a figure").route
}

// Claim: shade, Figure 7: A new mode, Ia, Is, L, V, Ka, Kd, Ks or n voids the stored brightness. Polygons without area or with
// several colours store nothing.
#[test]
fn figure_7_any_new_input_voids_stored_brightness() {
    let (scene, same) = (Scene::new(), Config::default());
    assert_eq!(second(&scene, &scene, &same), PolygonRoute::Reused, "sent again, but not changed");
    let changes: [Change<Scene>; 10] = [
        ("L", |s| s.light = sun(Vec3::new(0.3, 0.2, 1.0))),
        ("Is", |s| s.light.intensity = 0.5),
        ("V", |s| s.to_viewer = [0.6, 0.0, 0.8]),
        ("Ka", |s| s.lighting.ka = 0.2),
        ("Kd", |s| s.lighting.kd = 0.2),
        ("Ks", |s| s.lighting.ks = 0.2),
        ("n", |s| s.lighting.n = 21.0),
        ("colour of the surface", |s| s.color[1] = 0.5),
        ("colour of the points", |s| s.point_color[1] = 0.5),
        ("plane", |s| s.depth = 0.6),
    ];
    for (name, change) in changes {
        let mut changed = scene.clone();
        change(&mut changed);
        assert_eq!(second(&scene, &changed, &same), PolygonRoute::Flat, "{name}");
    }
    let settings: [Change<Config>; 4] = [
        ("mode", |c| (c.shading.mode, c.shading.flat_in_brightness_mode) = (ShadingMode::Brightness, true)),
        ("Ia", |c| c.shading.ia = 0.5),
        ("Is", |c| c.shading.is = 0.5),
        ("switch", |c| c.short_cuts.same_plane.enabled = false),
    ];
    for (name, change) in settings {
        let mut config = Config::default();
        change(&mut config);
        assert_eq!(second(&scene, &scene, &config), PolygonRoute::Flat, "{name}");
    }
}

// Claim: as same_plane_changes_output_within_tolerance.
#[test]
fn figure_7_reused_brightness_is_not_calculated() {
    let (scene, config) = (Scene::new(), Config::default());
    let mut unit = config.microcomputer();
    feed(&mut unit, [scene.frame()]);
    let first = shade(&mut unit, &config, scene.polygon());
    let runs = |unit: &Microcomputer| {
        [CpuProcess::Specular, CpuProcess::Brightness, CpuProcess::Mean].map(|p| unit.state.counters.processes[p as usize].runs)
    };
    assert_eq!(runs(&unit), [1, 1, 1]);
    let second = shade(&mut unit, &config, scene.polygon());
    assert_eq!(runs(&unit), [1, 1, 1]);
    assert_eq!(second.dots, first.dots);
    assert_eq!((unit.state.counters.flat, unit.state.counters.reused), (2, 1));
}

/// Returns the brightness at the sample points of a polygon in this state: ambient 0.1, diffuse 0.5, specular 0.3, all at full
/// value, without the terms that process 22 leaves out.
fn at_sample_points(mode: ShadingMode, flat: bool, negligible: bool) -> f32 {
    let mut config = Config::default();
    config.shading.mode = mode;
    config.shading.clamp = SumClamp::None;
    config.shading.flat_in_brightness_mode = true;
    config.short_cuts.flatness.tolerance = if flat { 1.0 } else { 0.0 };
    config.short_cuts.specular_negligible.threshold = if negligible { 1.0 } else { 0.0 };
    let lighting = Lighting { ka: 0.1, kd: 0.5, ks: 0.3, n: 1.0 };
    // Normals that differ slightly, so that the tolerance decides.
    let normals = [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::new(1e-4, 0.0, 1.0)];
    let shaded = draw(&config, vec![sun(Vec3::Z)], polygon(&SQUARE, &normals, lighting));
    let figure = shaded.figure.expect("a figure");
    assert_eq!(figure.registers.flat, flat && mode != ShadingMode::Polyhedron);
    let dots = if figure.brightness.is_empty() { &shaded.mean } else { &shaded.linear };
    dots[0].brightness[0]
}

// Claim: shade, Figure 6: The specular term is added exactly once: by circuit (50), or by process 22.
#[test]
fn figure_6_steps_80_to_83_add_specular_in_process_22() {
    for mode in [ShadingMode::Normal, ShadingMode::Brightness, ShadingMode::Polyhedron] {
        for flat in [false, true] {
            for negligible in [false, true] {
                let circuit_50_has_it = mode == ShadingMode::Normal && !flat;
                let enters = !negligible && !circuit_50_has_it;
                let expected = if enters { 0.9 } else { 0.6 };
                let brightness = at_sample_points(mode, flat, negligible);
                assert!((brightness - expected).abs() < 1e-3, "{mode:?}, flat {flat}, negligible {negligible}: {brightness}");
            }
        }
    }
}

// Claim: shade, 1, mean-value means: Process 24 gives the mean of the sample points to all dots.
#[test]
fn section_2_constant_shading_is_mean_of_sample_points() {
    let mut config = Config::default();
    config.shading.mode = ShadingMode::Polyhedron;
    let normals = [Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8)];
    let lighting = Lighting { ka: 0.1, kd: 0.6, ks: 0.0, n: 1.0 };
    let shaded = draw(&config, vec![sun(Vec3::Z)], polygon(&SQUARE[..3], &normals, lighting));
    assert!(!shaded.mean.is_empty() && shaded.linear.is_empty() && shaded.load.is_none());
    assert!(shaded.mean.iter().all(|d| (d.brightness[0] - (0.1 + 0.6 * 1.8 / 3.0)).abs() < 1e-6));
}
