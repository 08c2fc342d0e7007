//! Degenerate polygons: the rules in the crate documentation.

use crate::chain::{Config, SIDE, draw, polygon, sun};
use basrelief_figure_shading::{ShadedDot, ShadingMode};
use basrelief_signals::{Control, Lighting, Polygon};
use glam::Vec3;
use std::collections::BTreeSet;
use std::sync::Arc;

const TRIANGLE: [[f32; 2]; 3] = [[2.0, 2.0], [28.0, 4.0], [6.0, 30.0]];

/// Returns the dots in every mode, which have the same positions.
fn drawn(points: &[[f32; 2]], normals: &[Vec3]) -> Vec<ShadedDot> {
    let mut places: Vec<BTreeSet<(u16, u16)>> = Vec::new();
    let mut last = Vec::new();
    for mode in [ShadingMode::Polyhedron, ShadingMode::Brightness, ShadingMode::Normal] {
        let mut config = Config::default().plain();
        config.shading.mode = mode;
        last = draw(&config, vec![sun(Vec3::Z)], polygon(points, normals, Lighting::default())).dots;
        places.push(last.iter().map(|d| (d.x, d.y)).collect());
        assert_eq!(places[places.len() - 1].len(), last.len(), "no dot twice");
    }
    assert!(places.iter().all(|p| *p == places[0]));
    last
}

// Claim: shade, degenerate polygons: Each degenerate polygon has a rule: zero area, repeated points, concave, folded, NaN, invalid
// normals, fewer than three points.
#[test]
fn zero_area_and_repeated_points_have_no_dots() {
    for points in [
        [[1.0, 1.0], [5.0, 5.0], [9.0, 9.0]],
        [[1.0, 1.0], [1.0, 1.0], [9.0, 3.0]],
        [[4.0, 4.0]; 3],
        [[-9.0, 1.0], [-5.0, 5.0], [-9.0, 9.0]],
    ] {
        assert!(drawn(&points, &[Vec3::Z; 3]).is_empty(), "{points:?}");
    }
}

// Claim: as zero_area_and_repeated_points_have_no_dots.
#[test]
fn repeated_point_changes_nothing() {
    let [a, b, c] = TRIANGLE;
    let normals = [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)];
    let once = drawn(&TRIANGLE, &normals);
    let twice = drawn(&[a, b, b, c], &[normals[0], normals[1], normals[1], normals[2]]);
    assert!(!once.is_empty());
    assert_eq!(once, twice);
}

// Claim: as zero_area_and_repeated_points_have_no_dots.
#[test]
fn concave_or_folded_polygon_is_drawn_once_per_dot() {
    let arrow = [[2.0, 2.0], [28.0, 15.0], [2.0, 28.0], [14.0, 15.0]];
    let inside = drawn(&arrow, &[Vec3::Z; 4]);
    assert!(inside.iter().any(|d| (d.x, d.y) == (20, 14)));
    let bow = [[2.0, 2.0], [28.0, 28.0], [28.0, 2.0], [2.0, 26.0]];
    assert!(drawn(&bow, &[Vec3::Z; 4]).len() < (SIDE * SIDE) as usize);
}

// Claim: as zero_area_and_repeated_points_have_no_dots.
#[test]
fn nan_coordinates_count_as_zero() {
    let nan = [[f32::NAN, 2.0], [28.0, 4.0], [6.0, 30.0]];
    let zero = [[0.0, 2.0], [28.0, 4.0], [6.0, 30.0]];
    assert_eq!(drawn(&nan, &[Vec3::Z; 3]), drawn(&zero, &[Vec3::Z; 3]));
}

// Claim: as zero_area_and_repeated_points_have_no_dots.
#[test]
fn infinite_normal_counts_as_zero_and_is_ambient() {
    for renormalise in [false, true] {
        let mut config = Config::default().plain();
        config.shading.renormalise = renormalise;
        let at = |normal: Vec3| {
            let dots = draw(&config, vec![sun(Vec3::Z)], polygon(&TRIANGLE, &[normal; 3], Lighting::default())).dots;
            assert!(!dots.is_empty());
            dots
        };
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(at(Vec3::new(bad, 0.0, 1.0)), at(Vec3::ZERO));
        }
        assert!(at(Vec3::ZERO).iter().all(|d| (d.brightness[0] - Lighting::default().ka).abs() < 1e-6));
    }
}

// Claim: as zero_area_and_repeated_points_have_no_dots.
#[test]
fn polygon_with_too_few_points_has_no_dots() {
    for count in 0..3 {
        let Control::Polygon(whole) = polygon(&TRIANGLE, &[Vec3::Z; 3], Lighting::default()) else { unreachable!() };
        let vertices = whole.vertices[..count].to_vec();
        let few = Control::Polygon(Arc::new(Polygon { vertices, ..Polygon::clone(&whole) }));
        for mode in [ShadingMode::Polyhedron, ShadingMode::Brightness, ShadingMode::Normal] {
            let mut config = Config::default();
            config.shading.mode = mode;
            assert!(draw(&config, vec![sun(Vec3::Z)], few.clone()).dots.is_empty());
        }
    }
}
