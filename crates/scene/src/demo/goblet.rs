//! A goblet: a spline turned around an axis.

use super::spline::CubicSpline;
use super::stage::{DemoBuilder, DemoScene, PI, SurfaceGrid, SurfacePoint, framing};
use basrelief_signals::{Lighting, Mesh};
use glam::{DMat4, DVec2, DVec3};

/// Control points of the profile, radius and height: from the bottom of the cup up its inside, over the rim, down the
/// outside, stem and knob to the edge of the foot. Twin points make the curve turn sharply.
const PROFILE: CubicSpline<21> = CubicSpline([
    DVec2::new(0.000, 1.140),
    DVec2::new(0.240, 1.140),
    DVec2::new(0.540, 1.260),
    DVec2::new(0.660, 1.560),
    DVec2::new(0.520, 1.960),
    DVec2::new(0.435, 2.200),
    DVec2::new(0.455, 2.225),
    DVec2::new(0.475, 2.200),
    DVec2::new(0.560, 1.970),
    DVec2::new(0.720, 1.550),
    DVec2::new(0.620, 1.160),
    DVec2::new(0.220, 1.050),
    DVec2::new(0.060, 0.980),
    DVec2::new(0.060, 0.860),
    DVec2::new(0.190, 0.780),
    DVec2::new(0.190, 0.660),
    DVec2::new(0.050, 0.560),
    DVec2::new(0.080, 0.220),
    DVec2::new(0.170, 0.120),
    DVec2::new(0.440, 0.080),
    DVec2::new(0.560, 0.000),
]);

/// A golden goblet with narrow highlights along its curves. At tessellation 4 it has 6,864 triangles.
pub(super) fn build(tessellation: u32) -> DemoScene {
    let mut shop = DemoBuilder::default();
    let gold = shop.lacquer("gold", [0.86, 0.62, 0.20], Lighting { ka: 0.14, kd: 0.70, ks: 0.70, n: 80.0 });
    shop.place("goblet", surface(tessellation), DMat4::IDENTITY, &gold);
    shop.stage(framing([-0.5, 0.1, -0.5], [0.5, 2.1, 0.5], 0.0, 18.0), [-0.6, 0.55, 0.75])
}

/// The profile turned around the y axis.
fn surface(tessellation: u32) -> Mesh {
    let grid = SurfaceGrid { columns: 12 * tessellation, rows: 18 * tessellation, collapsed_top: true, collapsed_bottom: false };
    grid.mesh(|s, t| {
        let (point, along) = PROFILE.at(t);
        let (sin, cos) = (libm::sin(2.0 * PI * s), libm::cos(2.0 * PI * s));
        let turned = |radius: f64, height: f64| DVec3::new(sin * radius, height, cos * radius);
        // Down the outside is to the left of the normal.
        let normal = turned(-along.y, along.x).normalize();
        SurfacePoint { position: turned(point.x, point.y), normal, tangent: DVec3::new(cos, 0.0, -sin), uv: [s, t] }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_those_of_the_surface() {
        let mesh = surface(16);
        let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        for t in mesh.indices.as_chunks::<3>().0 {
            let [a, b, c] = t.map(|i| wide(mesh.positions[i as usize]));
            let face = (b - a).cross(c - a).normalize();
            assert!(t.iter().all(|i| face.dot(wide(mesh.normals[*i as usize])) > 0.98), "at {a}");
        }
    }

    #[test]
    fn cup_is_open_above_and_rests_on_ground() {
        let [bottom, foot] = [0.0, 1.0].map(|t| PROFILE.at(t).0);
        let (top, _) = (0..=1_000).map(|i| PROFILE.at(f64::from(i) / 1_000.0)).max_by(|a, b| a.0.y.total_cmp(&b.0.y)).unwrap();
        assert!(bottom.x == 0.0 && foot.y == 0.0);
        assert!(top.y > 2.0 && top.x > 0.4, "{top}");
    }
}
