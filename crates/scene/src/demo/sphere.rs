//! The benchmark W1: a sphere of 20,000 triangles with a repeating normal map of 512 x 512 texels.

use super::pattern::weave;
use super::stage::{DemoBuilder, DemoScene, framing, sphere};
use glam::DMat4;

/// A woven ball: fine, regular relief that uses every direction a normal can have.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let map = shop.heights("weave", 512, 14.0, |u, v| weave(u, v, 12.0));
    let material = shop.material("wicker", [0.85, 0.68, 0.42], None, Some(map));
    // 125 columns x 81 rows of two triangles, but one at the poles: 2 * 125 * 80 = 20,000.
    shop.place("sphere", sphere(125, 81, [4.0, 2.0]), DMat4::IDENTITY, &material);
    shop.stage(framing([-0.6; 3], [0.6; 3], 30.0, 20.0), [0.4, 0.8, 0.45])
}
