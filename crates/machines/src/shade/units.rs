//! The boxes of the block diagram, in words: what `describe` prints.

use crate::unit_info::{UnitInfo, unit};

/// All stages of the machine, in the order of the wiring.
pub const UNITS: &[UnitInfo] = &[
    unit("host", "100", "feeds the scene, one draw command per cycle", "crates/units/geometry-processor/src/scene_source.rs"),
    unit("geometry", "", "transforms, clips, culls, projects, in the host computer", "crates/units/geometry-processor"),
    unit(
        "display-list",
        "",
        "replays a recorded display list in their place",
        "crates/units/geometry-processor/src/display_list_source.rs",
    ),
    unit("host-interface", "", "transfers polygons, one or two at a time", "crates/units/figure-shading/src/host_interface.rs"),
    unit(
        "microcomputer",
        "10",
        "decides, shades sample points, draws flat polygons",
        "crates/units/figure-shading/src/microcomputer",
    ),
    unit(
        "interpolation",
        "21",
        "interpolates brightness: all terms but the specular",
        "crates/units/figure-shading/src/brightness_interpolation.rs",
    ),
    unit(
        "normal-interpolation",
        "50",
        "interpolates normals: the specular term",
        "crates/units/figure-shading/src/normal_interpolation.rs",
    ),
    unit("gate", "51", "holds the specular term back where it is negligible", "crates/units/figure-shading/src/gate.rs"),
    unit("adder", "52", "adds the specular term", "crates/units/figure-shading/src/adder.rs"),
    unit("selector-53", "53", "flat or not: process 24 or the adder", "crates/units/figure-shading/src/selector_53.rs"),
    unit(
        "selector-28",
        "28",
        "by the mode: (53), (21) or process 24; saturates",
        "crates/units/figure-shading/src/selector_28.rs",
    ),
    unit(
        "depth-test",
        "",
        "tests depth in front of (300); owns the depth values",
        "crates/units/graphics-processor/src/depth_test.rs",
    ),
    unit("frame-memory", "300", "keeps the picture", "crates/units/frame-buffer"),
    unit("video-out", "", "reads every finished frame once, for the CRT (400)", "crates/units/frame-buffer/src/video_out.rs"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::{DIAGRAM, FigureShadingDevice, ShadeConfig};

    fn without_depth_test() -> ShadeConfig {
        let mut config = ShadeConfig::default();
        config.frame_memory.depth_test = false;
        config
    }

    crate::unit_info::checks_the_table!(FigureShadingDevice, [ShadeConfig::default(), without_depth_test()]);
}
