//! Section 2: interpolation, and the theorem of the invention.

use crate::chain::{Config, direction, draw, lighting, polygon, sun, triangle, weights};
use basrelief_figure_shading::{ShadingMode, SumClamp};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use std::cmp::Ordering;

/// Returns the configuration for which the theorem is exact.
fn exact() -> Config {
    let mut config = Config::default().plain();
    config.shading.clamp = SumClamp::None;
    config
}

fn weighted(normals: &[Vec3; 3], w: [f64; 3]) -> DVec3 {
    (0..3).map(|i| w[i] * normals[i].as_dvec3()).sum()
}

fn power(x: f64, n: f32) -> f64 {
    libm::pow(x.clamp(0.0, 1.0), f64::from(n))
}

/// Computes `Ip = {alpha*gamma + beta*(1-gamma)} I1 + (1-alpha)*gamma I2 + (1-beta)*(1-gamma) I3`. The scan line through `y` cuts
/// P1P2 in Pa and P1P3 in Pb. Each ratio is 1 at the first-named point.
fn two_steps(t: &[[f32; 2]; 3], i: [f64; 3], dot: (u16, u16)) -> f64 {
    let (x, y) = (f64::from(dot.0) + 0.5, f64::from(dot.1) + 0.5);
    let p = t.map(|p| p.map(f64::from));
    // P1 is the point that lies alone on its side of the scan line.
    let side = p.map(|p| p[1].partial_cmp(&y).expect("numbers"));
    let is_alone = |&k: &usize| side[k] != Ordering::Equal && (0..3).filter(|&l| side[l] == side[k]).count() == 1;
    let alone = (0..3).find(is_alone).expect("the line cuts the triangle");
    let [p1, p2, p3] = [0, 1, 2].map(|k| p[(alone + k) % 3]);
    let [i1, i2, i3] = [0, 1, 2].map(|k| i[(alone + k) % 3]);
    let cut = |q: [f64; 2]| (y - p1[1]) / (q[1] - p1[1]);
    let (alpha, beta) = (1.0 - cut(p2), 1.0 - cut(p3));
    let (xa, xb) = (p1[0] + cut(p2) * (p2[0] - p1[0]), p1[0] + cut(p3) * (p3[0] - p1[0]));
    let gamma = if xa == xb { 1.0 } else { (xb - x) / (xb - xa) };
    let (ia, ib) = (alpha * i1 + (1.0 - alpha) * i2, beta * i1 + (1.0 - beta) * i3);
    let step = gamma * ia + (1.0 - gamma) * ib;
    let equation_6 = (alpha * gamma + beta * (1.0 - gamma)) * i1 + (1.0 - alpha) * gamma * i2 + (1.0 - beta) * (1.0 - gamma) * i3;
    assert!((step - equation_6).abs() < 1e-9, "(3) to (5) and (6)");
    equation_6
}

proptest! {
    // Claim: shade, 1, linear interpolation means: Circuit (21) interpolates ambient and diffuse brightness like equation (6) in
    // two steps.
    #[test]
    fn equation_6_equals_circuit_21(t in triangle(), normals in prop::array::uniform3(direction()), kd in 0.125f32..1.0) {
        let mut config = exact();
        config.shading.mode = ShadingMode::Brightness;
        let lighting = basrelief_signals::Lighting { ka: 0.1, kd, ks: 0.0, n: 1.0 };
        let shaded = draw(&config, vec![sun(Vec3::Z)], polygon(&t, &normals, lighting));
        let i = normals.map(|n| 0.1 + f64::from(kd) * f64::from(n.z));
        for dot in &shaded.linear {
            let expected = two_steps(&t, i, (dot.x, dot.y));
            for b in dot.brightness {
                prop_assert!((f64::from(b) - expected).abs() < 1e-5, "{dot:?} {expected}");
            }
        }
    }

    // Claim: shade, 1, normal-interpolation means: Circuit (50) computes only the specular term, from the interpolated normal.
    // Claim: shade, theorem: Without clamping and normalization, interpolated brightness and interpolated normals give equal
    // ambient and diffuse terms.
    #[test]
    fn theorem_only_specular_depends_on_interpolation(
        t in triangle(), normals in prop::array::uniform3(direction()), light in direction(), lighting in lighting(),
    ) {
        let shaded = draw(&exact(), vec![sun(light)], polygon(&t, &normals, lighting));
        prop_assert_eq!(shaded.linear.len(), shaded.highlights.len());
        let to_light = light.normalize().as_dvec3();
        let halfway = (to_light + DVec3::Z).normalize_or_zero();
        for (dot, sum) in shaded.linear.iter().zip(&shaded.dots) {
            let np = weighted(&normals, weights(&t, (dot.x, dot.y)));
            // (14) without and with its specular term.
            let diffuse = f64::from(lighting.ka) + f64::from(lighting.kd) * np.dot(to_light);
            let whole = diffuse + f64::from(lighting.ks) * power(np.dot(halfway), lighting.n);
            prop_assert!((f64::from(dot.brightness[0]) - diffuse).abs() < 1e-5, "{dot:?} {diffuse}");
            prop_assert!((f64::from(sum.brightness[0]) - whole).abs() < 2e-4, "{sum:?} {whole}");
            prop_assert_eq!(sum.brightness[0], sum.brightness[2]);
        }
    }

    /// max(0, L.N) at the sample points exceeds max(0, L.Np) by the part that is clamped at the dark points.
    // Claim: shade, theorem: Otherwise the error is at most the clamped amount or the shortening of the normal.
    #[test]
    fn theorem_error_with_clamp_is_at_most_clamped_part(
        t in triangle(), normals in prop::array::uniform3(direction()), light in direction(), lighting in lighting(),
    ) {
        let mut config = exact();
        config.shading.clamp = SumClamp::Vertex;
        let shaded = draw(&config, vec![sun(light)], polygon(&t, &normals, lighting));
        let to_light = light.normalize().as_dvec3();
        let cut_off = normals.iter().map(|n| -n.as_dvec3().dot(to_light)).fold(0.0, f64::max);
        for dot in &shaded.linear {
            let np = weighted(&normals, weights(&t, (dot.x, dot.y)));
            let by_normals = f64::from(lighting.ka) + f64::from(lighting.kd) * np.dot(to_light).max(0.0);
            let off = f64::from(dot.brightness[0]) - by_normals;
            prop_assert!(off >= -1e-5 && off <= f64::from(lighting.kd) * cut_off + 1e-5, "{off} {cut_off}");
        }
    }

    /// Renormalised, L.Np grows by the factor by which Np was short.
    // Claim: as theorem_error_with_clamp_is_at_most_clamped_part.
    #[test]
    fn theorem_error_renormalised_is_normal_shortening(
        t in triangle(), normals in prop::array::uniform3(direction()), light in direction(), lighting in lighting(),
    ) {
        let mut config = exact();
        config.shading.renormalise = true;
        let shaded = draw(&config, vec![sun(light)], polygon(&t, &normals, lighting));
        let to_light = light.normalize().as_dvec3();
        for dot in &shaded.linear {
            let np = weighted(&normals, weights(&t, (dot.x, dot.y)));
            let by_normals = f64::from(lighting.ka) + f64::from(lighting.kd) * np.normalize_or_zero().dot(to_light);
            let off = (f64::from(dot.brightness[0]) - by_normals).abs();
            prop_assert!(off <= f64::from(lighting.kd) * (1.0 - np.length()).abs() + 1e-5, "{off} {}", np.length());
        }
    }
}

// Claim: as theorem_error_with_clamp_is_at_most_clamped_part.
#[test]
fn theorem_fails_with_clamp_at_partly_dark_polygon() {
    let t = [[0.0, 0.0], [32.0, 0.0], [0.0, 32.0]];
    let normals = [Vec3::Z, -Vec3::Z, Vec3::Z];
    let lighting = basrelief_signals::Lighting { ka: 0.0, kd: 1.0, ks: 0.1, n: 10.0 };
    let at = |clamp| {
        let mut config = exact();
        config.shading.clamp = clamp;
        let shaded = draw(&config, vec![sun(Vec3::Z)], polygon(&t, &normals, lighting));
        shaded.linear.iter().find(|d| (d.x, d.y) == (15, 0)).expect("inside").brightness[0]
    };
    let share = 15.5 / 32.0;
    assert!((at(SumClamp::None) - (1.0 - 2.0 * share)).abs() < 1e-6);
    assert!((at(SumClamp::Vertex) - (1.0 - share)).abs() < 1e-6);
}

// Claim: shade, normals: The shortened normal dims the highlight: 20 degrees apart, x 0.47 at n = 50, x 0.047 at n = 200.
#[test]
fn section_4_shortened_normal_dims_highlight() {
    // Normals 20 degrees apart, H half-way between.
    let turn = 10f64.to_radians();
    let tilted = |s: f64| DVec3::new(s * libm::sin(turn), 0.0, libm::cos(turn)).as_vec3();
    let normals = [tilted(-1.0), tilted(1.0), tilted(1.0), tilted(-1.0)];
    let square = [[0.0, 0.0], [31.0, 0.0], [31.0, 31.0], [0.0, 31.0]];
    let peak = |renormalise, n| {
        let mut config = exact();
        config.shading.renormalise = renormalise;
        let lighting = basrelief_signals::Lighting { ka: 0.0, kd: 0.0, ks: 1.0, n };
        let shaded = draw(&config, vec![sun(Vec3::Z)], polygon(&square, &normals, lighting));
        shaded.highlights.iter().map(|h| h.brightness).fold(0.0, f32::max)
    };
    for (n, factor) in [(50.0, 0.47), (200.0, 0.047)] {
        let (short, long) = (peak(false, n), peak(true, n));
        assert!((short / long - factor).abs() < 0.01 * factor.max(0.1) + 0.002, "n = {n}: {short} / {long}");
        assert!((long - 1.0).abs() < 1e-3);
    }
}

// Claim: as section_2_ambient_counts_once_other_terms_per_light.
#[test]
fn section_2_circuit_50_clamps_n_h_before_power() {
    let t = [[1.0, 1.0], [30.0, 3.0], [9.0, 29.0]];
    let lighting = basrelief_signals::Lighting { ka: 0.0, kd: 0.0, ks: 0.5, n: 2.0 };
    for (normal, highlight) in [(1.5 * Vec3::Z, 0.5), (-Vec3::Z, 0.0), (-1.5 * Vec3::Z, 0.0), (0.5 * Vec3::Z, 0.125)] {
        let shaded = draw(&exact(), vec![sun(Vec3::Z)], polygon(&t, &[normal; 3], lighting));
        assert!(!shaded.highlights.is_empty());
        assert!(shaded.highlights.iter().all(|h| (h.brightness - highlight).abs() < 1e-6), "{normal}");
    }
}

// Claim: as section_2_ambient_counts_once_other_terms_per_light.
#[test]
fn section_2_terms_of_several_lights_add_up() {
    let t = [[1.0, 1.0], [30.0, 3.0], [9.0, 29.0]];
    let normals = [Vec3::new(0.1, 0.0, 1.0), Vec3::new(-0.2, 0.1, 1.0), Vec3::new(0.0, -0.2, 1.0)].map(Vec3::normalize);
    let lighting = basrelief_signals::Lighting { ka: 0.0, ..Default::default() };
    let lights = [sun(Vec3::new(0.3, 0.1, 1.0)), sun(Vec3::new(-0.5, 0.2, 1.0))];
    let at = |lights: Vec<_>| draw(&exact(), lights, polygon(&t, &normals, lighting)).dots;
    let (both, one, other) = (at(lights.to_vec()), at(vec![lights[0]]), at(vec![lights[1]]));
    assert!(!both.is_empty());
    for ((both, one), other) in both.iter().zip(&one).zip(&other) {
        assert!((both.brightness[1] - one.brightness[1] - other.brightness[1]).abs() < 1e-5);
    }
}
