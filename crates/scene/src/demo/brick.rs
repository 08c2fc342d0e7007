//! A wall and a floor to the horizon.

use super::pattern::{BrickPattern, Noise};
use super::stage::{DemoBuilder, DemoScene, SurfaceGrid, SurfacePoint};
use crate::camera::{Projection, Viewpoint};
use basrelief_signals::Mesh;
use glam::{DMat4, DVec3};

/// Side of a texture's tile in the world: 512 texels.
const TILE: f64 = 3.0;

/// Nearest and farthest depth of the geometry: from LOD 0 to beyond LOD 63.
const DEPTH: [f64; 2] = [0.9, 500.0];

const WALL_X: f64 = -1.9;
const WALL_HEIGHT: f64 = 3.2;

/// A brick wall on the left and a paved floor, in low light. LOD is per polygon, so both are cut into strips that grow
/// with the distance, each about one LOD deep: every LOD 0..=63 occurs in the picture.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let (bricks, slabs) = (BrickPattern::new(6, 12, 11), BrickPattern::new(4, 4, 23));
    let mortar = Noise::new(48, 3);
    let wall_map = shop.heights("bricks", 512, 9.0, |u, v| bricks.height(u, v));
    let floor_map = shop.heights("slabs", 512, 10.0, |u, v| slabs.height(u, v));
    let wall_color = shop.colors("brick colours", [512, 512], |u, v| brick_color(&bricks, &mortar, u, v));
    let floor_color = shop.colors("slab colours", [512, 512], |u, v| slab_color(&slabs, u, v));
    let wall_material = shop.material("brick", [1.0; 3], Some(wall_color), Some(wall_map));
    let floor_material = shop.material("slabs", [1.0; 3], Some(floor_color), Some(floor_map));
    shop.place("wall", wall(), DMat4::IDENTITY, &wall_material);
    shop.place("floor", floor(), DMat4::IDENTITY, &floor_material);
    let eye = DVec3::new(0.0, 1.5, 0.0);
    let lens = Projection::Perspective { field: 0.95, near: 0.5, far: 2.0 * DEPTH[1] };
    let ahead = DVec3::new(-0.32, -0.16, -1.0);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let camera = Viewpoint::looking_at(eye, eye + ahead, lens).unwrap_or(Viewpoint { eye, axes, lens });
    shop.stage(camera, [0.62, 0.62, 0.42])
}

/// Depth of a strip's edge, t from 0 (far) to 1 (near): each strip is as many times deeper than the one before it.
fn depth(t: f64) -> f64 {
    DEPTH[1] * libm::exp(t * libm::log(DEPTH[0] / DEPTH[1]))
}

/// Seen from the right: s to the right is deeper, t down.
fn wall() -> Mesh {
    SurfaceGrid::open(130, 6).mesh(|s, t| {
        let z = -depth(1.0 - s);
        let y = WALL_HEIGHT * (1.0 - t);
        let uv = [-z / TILE, (WALL_HEIGHT - y) / TILE];
        SurfacePoint { position: DVec3::new(WALL_X, y, z), normal: DVec3::X, tangent: DVec3::NEG_Z, uv }
    })
}

/// Seen from above: s to the right, t down is nearer. It spreads with the distance, as the picture does.
fn floor() -> Mesh {
    SurfaceGrid::open(24, 130).mesh(|s, t| {
        let depth = depth(t);
        let x = WALL_X + s * (1.5 - WALL_X + 1.2 * depth);
        SurfacePoint { position: DVec3::new(x, 0.0, -depth), normal: DVec3::Y, tangent: DVec3::X, uv: [x / TILE, -depth / TILE] }
    })
}

fn brick_color(masonry: &BrickPattern, mortar: &Noise, u: f64, v: f64) -> DVec3 {
    let (stone, shade) = masonry.stone(u, v);
    let brick = DVec3::new(0.50, 0.19, 0.13).lerp(DVec3::new(0.83, 0.45, 0.30), shade);
    let mortar = DVec3::splat(0.62 + 0.15 * mortar.at(u, v));
    mortar.lerp(brick, stone)
}

fn slab_color(masonry: &BrickPattern, u: f64, v: f64) -> DVec3 {
    let (stone, shade) = masonry.stone(u, v);
    let slab = DVec3::new(0.50, 0.51, 0.54).lerp(DVec3::new(0.84, 0.80, 0.72), shade);
    DVec3::new(0.36, 0.34, 0.30).lerp(slab, stone)
}
