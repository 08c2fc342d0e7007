//! A box that turns close to the eye.

use super::paintings::{Landscape, Mosaic, Painting, Rings, Stripes};
use super::stage::{DemoBuilder, DemoScene, PI, SurfaceGrid, SurfacePoint, WHOLE, rectangle};
use crate::camera::{Projection, Viewpoint};
use crate::view::LightOrbit;
use basrelief_signals::Mesh;
use glam::{DMat4, DVec3};

/// A box of five pictures on a plain disc. It turns once in eight frames, so close to the eye that its edges pass at a
/// quarter of the distance of its middle: perspective is strong, and each side is only two triangles.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let paintings: [(&str, [u32; 2], &dyn Painting); 4] = [
        ("rings", [256, 256], &Rings::new(5)),
        ("landscape", [384, 256], &Landscape::new(9, 384)),
        ("mosaic", [256, 256], &Mosaic::new(3)),
        ("stripes", [200, 120], &Stripes::new(7)),
    ];
    let pictures = paintings.map(|(name, size, painting)| shop.picture(name, size, |u, v| painting.at(u, v)));
    let sides = [DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::NEG_X];
    for (picture, out) in pictures.into_iter().zip(sides) {
        let material = shop.dull(&picture.name, [1.0; 3], Some(picture.clone()));
        let right = DVec3::Y.cross(out);
        let corner = out - right + DVec3::Y;
        shop.place(&picture.name, rectangle(corner, right * 2.0, DVec3::NEG_Y * 2.0, WHOLE), DMat4::IDENTITY, &material);
    }
    let checks = shop.colors("checks", [64, 64], |u, v| {
        if (u < 0.5) == (v < 0.5) { DVec3::new(0.16, 0.22, 0.30) } else { DVec3::new(0.90, 0.86, 0.74) }
    });
    let lid = shop.dull("lid", [1.0; 3], Some(checks));
    let top = rectangle(DVec3::new(-1.0, 1.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, [[0.0, 0.0], [4.0, 4.0]]);
    shop.place("lid", top, DMat4::IDENTITY, &lid);
    let felt = shop.dull("felt", [0.20, 0.42, 0.28], None);
    shop.place("disc", disc(), DMat4::from_translation(DVec3::NEG_Y * 1.02), &felt);
    let eye = DVec3::new(0.55, 1.55, 1.75);
    let lens = Projection::Perspective { field: 1.4, near: 0.1, far: 20.0 };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let camera = Viewpoint::looking_at(eye, DVec3::new(0.1, -0.15, 0.0), lens).unwrap_or(Viewpoint { eye, axes, lens });
    let stage = shop.stage(camera, [0.7, 0.7, 0.75]);
    DemoScene { frames: 8, orbit: 360.0, light_orbit: LightOrbit::WithCamera, ..stage }
}

/// The disc below the box.
fn disc() -> Mesh {
    let grid = SurfaceGrid { columns: 48, rows: 1, collapsed_top: true, collapsed_bottom: false };
    grid.mesh(|s, t| {
        let (sin, cos) = (libm::sin(2.0 * PI * s), libm::cos(2.0 * PI * s));
        SurfacePoint { position: DVec3::new(cos, 0.0, -sin) * (1.9 * t), normal: DVec3::Y, tangent: DVec3::X, uv: [s, t] }
    })
}
