//! Short cut 1: the specular term is negligible.

use crate::chain::{Config, direction, draw, lighting, polygon, sun, triangle};
use basrelief_figure_shading::{NormalInterpolationConfig, PolygonRoute, PowerMethod, ShadingMode, SpecularSkip};
use basrelief_shading::saturated;
use basrelief_signals::Lighting;
use glam::Vec3;
use proptest::prelude::*;

fn route(config: &Config, normals: &[Vec3; 3], lighting: Lighting) -> PolygonRoute {
    let t = [[0.0, 0.0], [31.0, 0.0], [0.0, 31.0]];
    draw(config, vec![sun(Vec3::Z)], polygon(&t, normals, lighting)).figure.expect("a figure").route
}

fn renormalising(renormalise: bool) -> Config {
    let mut config = Config::default();
    config.shading.renormalise = renormalise;
    config
}

/// Returns normals that lean away from the highlight by this angle \[degrees\], in three directions.
fn leaning(angle: f64) -> [Vec3; 3] {
    [0.0, 120.0, 240.0].map(|turn: f64| {
        let (a, t) = (angle.to_radians(), turn.to_radians());
        glam::DVec3::new(libm::sin(a) * libm::cos(t), libm::sin(a) * libm::sin(t), libm::cos(a)).as_vec3()
    })
}

// Claim: as specular_negligible_changes_output_by_at_most_1.
#[test]
fn highlight_may_peak_inside_dark_polygon() {
    let lighting = Lighting { ks: 0.5, n: 200.0, ..Lighting::default() };
    for angle in [20.0, 40.0, 80.0] {
        let normals = leaning(angle);
        assert!(normals.iter().all(|n| 0.5 * libm::powf(n.z, 200.0) < 1.0 / 510.0), "all dark");
        assert_eq!(route(&renormalising(true), &normals, lighting), PolygonRoute::Normal, "{angle} degrees");
        assert_eq!(route(&renormalising(false), &normals, lighting), PolygonRoute::GateClosed, "{angle} degrees");
        let shaded =
            draw(&renormalising(true), vec![sun(Vec3::Z)], polygon(&[[0.0, 0.0], [31.0, 0.0], [0.0, 31.0]], &normals, lighting));
        let peak = shaded.highlights.iter().map(|h| h.brightness).fold(0.0, f32::max);
        assert!(peak > 0.1, "{angle} degrees: {peak}");
    }
}

// Claim: as specular_negligible_changes_output_by_at_most_1.
#[test]
fn cancelling_normals_have_no_bound() {
    let lighting = Lighting { ks: 0.5, n: 200.0, ..Lighting::default() };
    let apart = [Vec3::X, -Vec3::X, Vec3::Y];
    assert_eq!(route(&renormalising(true), &apart, lighting), PolygonRoute::Normal);
    assert_eq!(route(&renormalising(false), &apart, lighting), PolygonRoute::GateClosed);
    let zero = [Vec3::X, Vec3::X, Vec3::ZERO];
    assert_eq!(route(&renormalising(true), &zero, lighting), PolygonRoute::Normal);
}

// Claim: as specular_negligible_changes_output_by_at_most_1.
#[test]
fn back_facing_or_matt_polygon_is_negligible() {
    let lighting = Lighting { ks: 0.5, n: 1.0, ..Lighting::default() };
    let away = leaning(110.0);
    assert_eq!(route(&renormalising(true), &away, lighting), PolygonRoute::GateClosed);
    let matte = Lighting { ks: 0.0, ..lighting };
    assert_eq!(route(&renormalising(false), &leaning(5.0), matte), PolygonRoute::GateClosed);
    let mut off = renormalising(true);
    off.short_cuts.specular_negligible.enabled = false;
    assert_eq!(route(&off, &away, matte), PolygonRoute::Normal);
}

// Claim: shade, short cut 1: Register (18) closes gate (51), or circuit (50) does not start. Only the latter saves cycles.
#[test]
fn register_18_closes_gate_or_skips_circuit_50() {
    let lighting = Lighting { ks: 0.5, n: 200.0, ..Lighting::default() };
    let polygon = || polygon(&[[0.0, 0.0], [31.0, 0.0], [0.0, 31.0]], &leaning(40.0), lighting);
    let mut config = Config::default();
    assert!(draw(&config, vec![sun(Vec3::Z)], polygon()).load.is_none());
    config.shading.specular_skip = SpecularSkip::Gate;
    let load = draw(&config, vec![sun(Vec3::Z)], polygon()).load.expect("started");
    assert!(!load.open);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4 * ProptestConfig::default().cases, ..ProptestConfig::default() })]

    // Claim: shade, short cut 1: Specular negligible changes no output by more than 1, even if a highlight peaks inside a polygon
    // with dark corners.
    #[test]
    fn specular_negligible_changes_output_by_at_most_1(
        t in triangle(), middle in direction(), spread in 0f32..2.5, off in prop::array::uniform3(direction()),
        lights in prop::collection::vec(direction(), 1..3), lighting in lighting(), renormalise in any::<bool>(),
        mode in prop::sample::select(vec![ShadingMode::Normal, ShadingMode::Normal, ShadingMode::Brightness, ShadingMode::Polyhedron]),
        table in any::<bool>(), flatness in any::<bool>(),
    ) {
        let normals = off.map(|o| (middle + spread * o).normalize_or_zero());
        let mut config = renormalising(renormalise);
        config.shading.mode = mode;
        config.short_cuts.flatness.enabled = flatness;
        if table {
            config.circuit_50 = NormalInterpolationConfig {
                power: PowerMethod::Table, table_entries: 200, table_bits: 9, ..NormalInterpolationConfig::default()
            };
        }
        let mut without = config.clone();
        without.short_cuts.specular_negligible.enabled = false;
        let lights: Vec<_> = lights.into_iter().map(sun).collect();
        let with = draw(&config, lights.clone(), polygon(&t, &normals, lighting)).dots;
        let without = draw(&without, lights, polygon(&t, &normals, lighting)).dots;
        prop_assert_eq!(with.len(), without.len());
        for (a, b) in with.iter().zip(&without) {
            prop_assert_eq!((a.x, a.y, a.z), (b.x, b.y, b.z));
            let (a8, b8) = (saturated(a.brightness), saturated(b.brightness));
            prop_assert!((0..3).all(|i| a8[i].abs_diff(b8[i]) <= 1), "{a:?} {b:?}");
        }
    }
}
