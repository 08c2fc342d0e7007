//! A plane that a curve cuts into many small facets, beside a curved body.

use super::stage::{DemoBuilder, DemoScene, PI, SurfaceGrid, SurfacePoint, append, framing};
use basrelief_signals::{Lighting, Mesh};
use glam::{DMat4, DVec3};

/// Half the side of the plate, and its thickness.
const HALF: f64 = 1.25;
const THICKNESS: f64 = 0.14;

/// Height of the body.
const HEIGHT: f64 = 0.72;

/// A square plate from which a body with five lobes rises. To meet the curve along which the body cuts it, the plate is
/// divided into facets, all in the plane y = 0, with equal normals, and drawn one after the other: what the shading
/// device's short cuts for flat polygons and for the same plane as before are made for.
pub(super) fn build(tessellation: u32) -> DemoScene {
    let mut shop = DemoBuilder::default();
    let slate = shop.lacquer("slate", [0.34, 0.42, 0.50], Lighting { ka: 0.15, kd: 0.75, ks: 0.30, n: 50.0 });
    let jade = shop.lacquer("jade", [0.16, 0.60, 0.40], Lighting { ka: 0.12, kd: 0.75, ks: 0.60, n: 50.0 });
    shop.place("plane", plane(tessellation), DMat4::IDENTITY, &slate);
    shop.place("edge", edge(tessellation), DMat4::IDENTITY, &slate);
    shop.place("body", body(tessellation), DMat4::IDENTITY, &jade);
    shop.stage(framing([-1.0, -0.5, -1.0], [1.0, 0.3, 1.0], 28.0, 38.0), [-0.25, 0.9, 0.45])
}

/// Columns around the centre; a multiple of 8, so that the corners of the plate are vertices.
fn columns(tessellation: u32) -> u32 {
    16 * tessellation
}

/// Direction from the centre, from +z towards +x, s in 0..=1 once around.
fn outwards(s: f64) -> DVec3 {
    DVec3::new(libm::sin(2.0 * PI * s), 0.0, libm::cos(2.0 * PI * s))
}

/// Radius of the cutting curve in a direction, and its derivative by the angle.
fn curve(s: f64) -> [f64; 2] {
    let angle = 5.0 * 2.0 * PI * s;
    [0.78 + 0.09 * libm::cos(angle), -0.45 * libm::sin(angle)]
}

/// A point of the plate's outline.
fn outline(s: f64) -> DVec3 {
    let direction = outwards(s);
    direction * (HALF / direction.abs().max_element())
}

/// The plane between curve and outline.
fn plane(tessellation: u32) -> Mesh {
    SurfaceGrid::open(columns(tessellation), 3 * tessellation).mesh(|s, t| {
        let position = (outwards(s) * curve(s)[0]).lerp(outline(s), t);
        SurfacePoint { position, normal: DVec3::Y, tangent: DVec3::X, uv: [s, t] }
    })
}

/// The four narrow sides of the plate, each a plane of its own.
fn edge(tessellation: u32) -> Mesh {
    let mut edge = Mesh::default();
    for (side, normal) in (0..4).zip([DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::NEG_X]) {
        let part = SurfaceGrid::open(columns(tessellation) / 4, 1).mesh(|s, t| {
            let s = (f64::from(side) + s - 0.5) / 4.0;
            let position = outline(s) - DVec3::Y * (THICKNESS * t);
            SurfacePoint { position, normal, tangent: DVec3::Y.cross(normal), uv: [s, t] }
        });
        append(&mut edge, part);
    }
    edge
}

/// A dome over the curve: an ellipse in each direction from the centre.
fn body(tessellation: u32) -> Mesh {
    let grid =
        SurfaceGrid { columns: columns(tessellation), rows: 5 * tessellation, collapsed_top: true, collapsed_bottom: false };
    grid.mesh(|s, t| {
        let (sin, cos) = (libm::sin(0.5 * PI * t), if t == 1.0 { 0.0 } else { libm::cos(0.5 * PI * t) });
        let [radius, slope] = curve(s);
        let outwards = outwards(s);
        let around = outwards * slope + DVec3::Y.cross(outwards) * radius;
        let down = outwards * (radius * cos) - DVec3::Y * (HEIGHT * sin);
        let position = outwards * (radius * sin) + DVec3::Y * (HEIGHT * cos);
        SurfacePoint { position, normal: down.cross(around).normalize(), tangent: around.normalize(), uv: [s, t] }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The case of Figure 7: all facets on one plane, equal normals, one after the other.
    #[test]
    fn facets_are_coplanar_and_meet_the_body_without_a_gap() {
        for tessellation in [1, 4] {
            let stage = build(tessellation);
            let [plane, _, body] = [0, 1, 2].map(|i| &stage.objects[i].mesh);
            assert!(plane.positions.iter().all(|p| p[1] == 0.0) && plane.normals.iter().all(|n| *n == [0.0, 1.0, 0.0]));
            assert_eq!(plane.indices.len(), 3 * 2 * 16 * 3 * (tessellation * tessellation) as usize);
            let columns = columns(tessellation) as usize;
            assert_eq!(plane.positions[..=columns], body.positions[body.positions.len() - columns - 1..]);
            let half = HALF as f32;
            assert!(plane.positions.contains(&[half, 0.0, half]), "the plate has its corners");
        }
    }
}
