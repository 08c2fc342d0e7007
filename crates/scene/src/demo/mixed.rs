//! Everything at once.

use super::pattern::{BrickPattern, Noise, weave};
use super::stage::{DemoBuilder, DemoScene, PI, SurfaceGrid, SurfacePoint, append, framing, sphere};
use basrelief_signals::Mesh;
use glam::{DMat4, DVec3};

/// Centre of the ball and of the ring around it.
const BALL: DVec3 = DVec3::new(-0.35, 0.0, 0.3);

/// Bump targets beside ordinary polygons, in front of and behind each other: a woven ball whose number of reference
/// normals is fixed by the model, a brick block with colour texture and normal map, a block with a normal map that the
/// model forbids to use, a ring of plain coloured polygons through it all, and a textured floor without normal map.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let masonry = BrickPattern::new(3, 6, 31);
    let woven = shop.heights("weave", 256, 11.0, |u, v| weave(u, v, 8.0));
    let bricks = shop.heights("bricks", 256, 6.0, |u, v| masonry.height(u, v));
    let brick_colors = shop.colors("brick colours", [256, 256], |u, v| {
        let (stone, shade) = masonry.stone(u, v);
        DVec3::splat(0.7).lerp(DVec3::new(0.55, 0.22, 0.15).lerp(DVec3::new(0.85, 0.5, 0.33), shade), stone)
    });
    let stains = Noise::new(8, 41);
    let checks = shop.colors("checks", [128, 128], |u, v| check_color(&stains, u, v));

    let floor = shop.material("checks", [1.0; 3], Some(checks), None);
    let wicker = shop.material("wicker", [0.90, 0.72, 0.45], None, Some(woven));
    let brick = shop.material("brick", [1.0; 3], Some(brick_colors), Some(bricks));
    let enamel = shop.material("enamel", [1.0; 3], None, None);

    shop.place("floor", plane(), DMat4::from_translation(DVec3::NEG_Y), &floor);
    shop.place_as("ball", sphere(64, 32, [4.0, 2.0]), DMat4::from_translation(BALL), &wicker, Some(64), None);
    let block = |x: f64, z: f64, degrees: f64, half: f64| {
        let turned = DMat4::from_translation(DVec3::new(x, half - 1.0, z)) * crate::camera::turn(degrees);
        turned * DMat4::from_scale(DVec3::splat(half))
    };
    shop.place_as("brick block", cube(), block(1.35, -0.7, 25.0, 0.8), &brick, None, Some(true));
    shop.place_as("flat block", cube(), block(-1.9, -0.9, -20.0, 0.55), &brick, None, Some(false));
    shop.place("ring", ring(), DMat4::from_translation(BALL), &enamel);
    shop.stage(framing([-1.6, -1.0, -1.0], [1.6, 0.6, 1.0], 18.0, 22.0), [0.35, 0.8, 0.6])
}

/// A floor, seen from above.
fn plane() -> Mesh {
    SurfaceGrid::open(24, 24).mesh(|s, t| {
        let (x, z) = (8.0 * s - 4.0, 7.0 * t - 4.0);
        SurfacePoint { position: DVec3::new(x, 0.0, z), normal: DVec3::Y, tangent: DVec3::X, uv: [x, z] }
    })
}

/// The sides and the top of a cube from -1 to 1.
fn cube() -> Mesh {
    let mut cube = Mesh::default();
    let sides = [
        [DVec3::Z, DVec3::X],
        [DVec3::X, DVec3::NEG_Z],
        [DVec3::NEG_Z, DVec3::NEG_X],
        [DVec3::NEG_X, DVec3::Z],
        [DVec3::Y, DVec3::X],
    ];
    for [normal, right] in sides {
        let up = normal.cross(right);
        let side = SurfaceGrid::open(4, 4).mesh(|s, t| {
            let position = normal + right * (2.0 * s - 1.0) + up * (1.0 - 2.0 * t);
            SurfacePoint { position, normal, tangent: right, uv: [s, t] }
        });
        append(&mut cube, side);
    }
    cube
}

/// A slanting ring around the ball, its colours at the vertices.
fn ring() -> Mesh {
    const BIG: f64 = 1.25;
    const SMALL: f64 = 0.09;
    // Leans by 0.4 to the right.
    let (sin, cos) = (libm::sin(0.4), libm::cos(0.4));
    let lean = |p: DVec3| DVec3::new(p.x * cos + p.y * sin, p.y * cos - p.x * sin, p.z);
    let mut ring = SurfaceGrid::open(72, 16).mesh(|s, t| {
        let (a, b) = (2.0 * PI * s, 2.0 * PI * t);
        let outward = DVec3::new(libm::sin(a), 0.0, libm::cos(a));
        let normal = outward * libm::cos(b) - DVec3::Y * libm::sin(b);
        let position = lean(outward * BIG + normal * SMALL);
        let tangent = lean(DVec3::new(libm::cos(a), 0.0, -libm::sin(a)));
        SurfacePoint { position, normal: lean(normal), tangent, uv: [s, t] }
    });
    ring.colors = ring.uv.iter().map(|[s, _]| rainbow(f64::from(*s))).collect();
    ring
}

fn rainbow(s: f64) -> [f32; 4] {
    let wave = |shift: f64| (0.55 + 0.45 * libm::cos(2.0 * PI * (s - shift))) as f32;
    [wave(0.0), wave(1.0 / 3.0), wave(2.0 / 3.0), 1.0]
}

fn check_color(stains: &Noise, u: f64, v: f64) -> DVec3 {
    let dark = (u < 0.5) == (v < 0.5);
    let base = if dark { DVec3::new(0.16, 0.24, 0.30) } else { DVec3::new(0.80, 0.82, 0.78) };
    base * (0.9 + 0.1 * stains.at(u, v))
}
