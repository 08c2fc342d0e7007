//! A coin in relief under a circling light.

use super::lettering::{distance, width};
use super::pattern::{Noise, floor, smoothstep};
use super::stage::{DemoBuilder, DemoScene, PI, SurfaceGrid, SurfacePoint, framing};
use crate::view::LightOrbit;
use basrelief_signals::Mesh;
use glam::{DMat4, DVec2, DVec3};

/// Thickness of the coin, its radius being 1.
const THICKNESS: f64 = 0.16;

/// A gold coin on its back. Its relief - a sun, an inscription, a garland, a ring of beads - is a height map of 512 x 512 texels on a
/// flat disc. The light circles once in eight frames: at every frame the tables of brightness (CLUTs) are computed anew,
/// while the indices on the surface stay the same.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let grain = Noise::new(24, 5);
    let relief = shop.heights("relief", 512, 11.0, |u, v| height(&grain, DVec2::new(2.0 * u - 1.0, 1.0 - 2.0 * v) * 1.01));
    let reeds = shop.heights("reeds", 64, 5.0, |u, _| 0.5 + 0.5 * libm::cos(2.0 * PI * u));
    let gold = [1.0, 0.80, 0.38];
    let face = shop.material("gold, struck", gold, None, Some(relief));
    let edge = shop.material("gold, reeded", gold, None, Some(reeds));
    shop.place("face", disc(), DMat4::IDENTITY, &face);
    shop.place("edge", rim(), DMat4::IDENTITY, &edge);
    let stage = shop.stage(framing([-0.72, -THICKNESS, -0.72], [0.72, 0.0, 0.72], 0.0, 52.0), [-0.75, 0.75, 0.45]);
    DemoScene { frames: 8, light_orbit: LightOrbit::Degrees(360.0), ..stage }
}

/// The upper side: rings around the centre, u to the right and v to the front.
fn disc() -> Mesh {
    let grid = SurfaceGrid { columns: 96, rows: 10, collapsed_top: true, collapsed_bottom: false };
    grid.mesh(|s, t| {
        let (sin, cos) = (libm::sin(2.0 * PI * s), libm::cos(2.0 * PI * s));
        let position = DVec3::new(cos * t, 0.0, -sin * t);
        // The map reaches a little beyond the disc, so that no texel of the other side is filtered in.
        let uv = [position.x, position.z].map(|c| 0.5 + 0.5 * c / 1.01);
        SurfacePoint { position, normal: DVec3::Y, tangent: DVec3::X, uv }
    })
}

/// The edge, with 120 reeds.
fn rim() -> Mesh {
    SurfaceGrid::open(96, 2).mesh(|s, t| {
        let (sin, cos) = (libm::sin(2.0 * PI * s), libm::cos(2.0 * PI * s));
        let normal = DVec3::new(sin, 0.0, cos);
        SurfacePoint {
            position: normal - DVec3::Y * (THICKNESS * t),
            normal,
            tangent: DVec3::new(cos, 0.0, -sin),
            uv: [120.0 * s, t],
        }
    })
}

/// Height at a point of the unit disc, x to the right, y up.
fn height(grain: &Noise, p: DVec2) -> f64 {
    let r = p.length();
    let border = smoothstep(0.915, 0.94, r);
    let field = 0.10 + 0.02 * grain.at(0.5 + 0.5 * p.x, 0.5 + 0.5 * p.y);
    let angle = libm::atan2(p.x, p.y);
    let parts = [beads(r, angle), inscription(r, angle), garland(r, angle), sun(r, angle)];
    let relief = parts.into_iter().fold(border, f64::max);
    field + (0.9 - field) * relief
}

fn beads(r: f64, angle: f64) -> f64 {
    const COUNT: f64 = 80.0;
    let turn = angle / (2.0 * PI) * COUNT;
    let along = (turn - turn.round()) / COUNT * 2.0 * PI * 0.875;
    let squared = (along * along + (r - 0.875) * (r - 0.875)) / (0.026 * 0.026);
    0.8 * (1.0 - squared).max(0.0).sqrt()
}

/// BASRELIEF along the upper side, upright as seen from the middle.
fn inscription(r: f64, angle: f64) -> f64 {
    const TEXT: &str = "BASRELIEF";
    const UNIT: f64 = 0.030;
    const BASE: f64 = 0.61;
    const GAP: f64 = 2.6;
    let length: f64 = TEXT.chars().map(|c| width(c) + GAP).sum();
    // Letter units along the circle of radius BASE, from the beginning of the text.
    let mut x = angle * BASE / UNIT + length / 2.0;
    for letter in TEXT.chars() {
        let advance = width(letter) + GAP;
        if x >= 0.0 && x < advance {
            let point = DVec2::new(x - GAP / 2.0, (r - BASE) / UNIT);
            return 0.75 * (1.0 - smoothstep(0.25, 0.95, distance(letter, point)));
        }
        x -= advance;
    }
    0.0
}

/// A garland of leaves along the lower side, in pairs that point upwards.
fn garland(r: f64, angle: f64) -> f64 {
    const PAIRS: f64 = 9.0;
    const REACH: f64 = 1.25;
    const STEM: f64 = 0.70;
    let from_bottom = PI - angle.abs();
    let turn = from_bottom / REACH * PAIRS;
    if turn >= PAIRS {
        return 0.0;
    }
    let along = (turn - floor(turn) - 0.5) / PAIRS * REACH * STEM;
    let across = (r - STEM).abs();
    // Each leaf grows out of the stem at 35 degrees.
    let (sin, cos) = (0.5736, 0.8192);
    let (length, breadth) = ((along + 0.02) * cos + across * sin, across * cos - along * sin);
    let leaf =
        1.0 - (length - 0.03) * (length - 0.03) / (0.055 * 0.055) - (breadth - 0.035) * (breadth - 0.035) / (0.022 * 0.022);
    let stem = 1.0 - across * across / (0.012 * 0.012);
    0.7 * leaf.max(0.0).sqrt().max(0.6 * stem.max(0.0).sqrt())
}

/// A disc with sixteen rays, every other one short.
fn sun(r: f64, angle: f64) -> f64 {
    const RAYS: f64 = 16.0;
    let turn = angle / (2.0 * PI) * RAYS;
    let reach = if turn.round().rem_euclid(2.0) < 1.0 { 0.54 } else { 0.42 };
    let across = ((turn - turn.round()) / RAYS * 2.0 * PI).abs() * r;
    let width = 0.055 * ((reach - r) / (reach - 0.2)).clamp(0.0, 1.0);
    let ray = if width > 0.0 { (1.0 - across / width).max(0.0) * smoothstep(0.20, 0.26, r) } else { 0.0 };
    let dome = (1.0 - (r / 0.19) * (r / 0.19)).max(0.0).sqrt();
    (0.85 * dome).max(0.8 * ray.min(1.0))
}
