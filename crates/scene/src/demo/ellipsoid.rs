//! Figure 3 of the shading device: sample points on an ellipsoid.

use super::stage::{DemoBuilder, DemoScene, framing, sphere};
use crate::camera::turn;
use basrelief_signals::Lighting;
use glam::{DMat4, DVec3};

/// Half the axes.
const AXES: DVec3 = DVec3::new(1.0, 0.66, 0.6);

/// An ellipsoid in red lacquer, sampled along meridians and parallels, at tessellation 4 every 11 and every 9 degrees:
/// few sample points lie in the highlight, and how they are interpolated shows.
pub(super) fn build(tessellation: u32) -> DemoScene {
    let mut shop = DemoBuilder::default();
    let lacquer = shop.lacquer("red lacquer", [0.78, 0.13, 0.10], Lighting { ka: 0.12, kd: 0.72, ks: 0.65, n: 60.0 });
    let mesh = sphere(8 * tessellation, 5 * tessellation, [1.0; 2]);
    shop.place("ellipsoid", mesh, turn(-20.0) * DMat4::from_scale(AXES), &lacquer);
    shop.stage(framing([-0.66, -0.46, -0.46], [0.66, 0.46, 0.46], 10.0, 18.0), [0.45, 0.75, 0.6])
}
