//! A corridor to the vanishing point.

use super::pattern::{Noise, floor};
use super::stage::{DemoBuilder, DemoScene, WHOLE, rectangle};
use crate::camera::{Projection, Viewpoint};
use basrelief_signals::Mesh;
use glam::{DMat4, DVec3};

/// Half the width, the height.
const SIZE: [f64; 2] = [2.0, 3.0];

/// Depth at both ends: it begins behind the eye, and ends where it is less than a pixel high.
const DEPTH: [f64; 2] = [-1.0, 2000.0];

/// Side of a texture's tile.
const TILE: f64 = 2.0;

/// Height of the skirting boards, and how far they stand out.
const BOARD: [f64; 2] = [0.16, 0.03];

/// Each side is two triangles from behind the eye to the horizon, its texture repeated a thousand times: along the scan
/// lines of the walls w runs through the ratio of 1:1000, along those of floor and ceiling it stays the same.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let (veins, dark) = (Noise::new(8, 57), DVec3::new(0.13, 0.15, 0.20));
    let floor_colors = shop.colors("floor checks", [256, 256], checks(&veins, 4, dark, DVec3::new(0.92, 0.90, 0.84)));
    let wall_colors =
        shop.colors("wall checks", [256, 128], checks(&veins, 2, DVec3::new(0.55, 0.20, 0.16), DVec3::new(0.88, 0.72, 0.48)));
    let ceiling_colors =
        shop.colors("ceiling checks", [128, 128], checks(&veins, 2, DVec3::new(0.30, 0.44, 0.60), DVec3::new(0.78, 0.88, 0.95)));
    let floor = shop.dull("floor", [1.0; 3], Some(floor_colors));
    let walls = shop.dull("walls", [1.0; 3], Some(wall_colors));
    let ceiling = shop.dull("ceiling", [1.0; 3], Some(ceiling_colors));
    let wood = shop.dull("wood", [0.30, 0.17, 0.09], None);
    let plaster = shop.dull("plaster", [0.75, 0.72, 0.66], None);
    let [half, height] = SIZE;
    shop.place("floor", flat(0.0), DMat4::IDENTITY, &floor);
    shop.place("ceiling", flat(height), DMat4::IDENTITY, &ceiling);
    for (name, side) in [("left", -1.0), ("right", 1.0)] {
        shop.place(&format!("{name} wall"), wall(side, half, [0.0, height]), DMat4::IDENTITY, &walls);
        shop.place(&format!("{name} skirting board"), wall(side, half - BOARD[1], [0.0, BOARD[0]]), DMat4::IDENTITY, &wood);
    }
    let end = rectangle(DVec3::new(-half, height, -DEPTH[1]), DVec3::X * (2.0 * half), DVec3::NEG_Y * height, WHOLE);
    shop.place("end", end, DMat4::IDENTITY, &plaster);
    let eye = DVec3::new(0.5, 1.6, 0.0);
    let lens = Projection::Perspective { field: 1.0, near: 0.1, far: 2.0 * DEPTH[1] };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let camera = Viewpoint::looking_at(eye, eye + DVec3::new(-0.16, -0.03, -1.0), lens).unwrap_or(Viewpoint { eye, axes, lens });
    shop.stage(camera, [0.45, 0.75, 0.5])
}

/// Floor or ceiling, by its height: texture coordinates are multiples of the tile from the eye on.
fn flat(y: f64) -> Mesh {
    let [half, _] = SIZE;
    let [near, far] = DEPTH;
    let along = far - near;
    let uv = [[-half / TILE, -far / TILE], [half / TILE, -near / TILE]];
    if y == 0.0 {
        return rectangle(DVec3::new(-half, y, -far), DVec3::X * (2.0 * half), DVec3::Z * along, uv);
    }
    rectangle(
        DVec3::new(-half, y, -near),
        DVec3::X * (2.0 * half),
        DVec3::NEG_Z * along,
        [[uv[0][0], uv[1][1]], [uv[1][0], uv[0][1]]],
    )
}

/// A wall of the left (-1) or right (1) side, between two heights.
fn wall(side: f64, x: f64, [low, high]: [f64; 2]) -> Mesh {
    let [near, far] = DEPTH;
    // To the right, as seen from inside, is away from the eye on the left wall, and back to it on the right one.
    let (start, end) = if side < 0.0 { (near, far) } else { (-far, -near) };
    let z = if side < 0.0 { -near } else { -far };
    let right = DVec3::NEG_Z * (side * (near - far));
    let uv = [[start / TILE, -high / TILE], [end / TILE, -low / TILE]];
    rectangle(DVec3::new(side * x, high, z), right, DVec3::NEG_Y * (high - low), uv)
}

/// Returns checks of two colours, this many per side (even), each with its own shade and veins.
fn checks(veins: &Noise, count: i64, dark: DVec3, light: DVec3) -> impl Fn(f64, f64) -> DVec3 + Sync {
    let cell = move |c: f64| floor(c * count as f64) as i64;
    move |u, v| {
        let base = if (cell(u) + cell(v)) % 2 == 0 { dark } else { light };
        base * (0.86 + 0.14 * veins.at(u, v))
    }
}
