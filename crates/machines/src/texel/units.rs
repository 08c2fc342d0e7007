//! The boxes of the block diagram, in words: what `describe` prints.

use crate::unit_info::{UnitInfo, unit};

/// All stages of the machine, in the order of the wiring.
pub const UNITS: &[UnitInfo] = &[
    unit("host", "", "feeds the scene, one draw command per cycle", "crates/units/geometry-processor/src/scene_source.rs"),
    unit("geometry", "", "transforms, clips, culls, projects", "crates/units/geometry-processor"),
    unit(
        "display-list",
        "",
        "replays a recorded display list in their place",
        "crates/units/geometry-processor/src/display_list_source.rs",
    ),
    unit(
        "scan-converter",
        "",
        "finds spans with exact U, V, W at both ends",
        "crates/units/texel-value-generator/src/scan_converter.rs",
    ),
    unit(
        "step-calculator",
        "310",
        "chooses division points by the criterion in its storage element",
        "crates/units/texel-value-generator/src/step_calculator",
    ),
    unit("divider", "310", "exact u, v at ends and division points", "crates/units/texel-value-generator/src/divider.rs"),
    unit(
        "approximate-calculator",
        "310a",
        "interpolates u, v between division points",
        "crates/units/texel-value-generator/src/approximate_calculator",
    ),
    unit("mip-map-selector", "320", "selects a level by du, dv", "crates/units/texel-value-generator/src/mip_map_selector.rs"),
    unit(
        "depth-test",
        "",
        "tests depth in front of (330); owns the depth values",
        "crates/units/graphics-processor/src/depth_test.rs",
    ),
    unit(
        "texture-look-up",
        "330",
        "looks texels up and filters them",
        "crates/units/texel-value-generator/src/texture_look_up_table.rs",
    ),
    unit(
        "illuminance",
        "340",
        "interpolates brightness and colour",
        "crates/units/texel-value-generator/src/illuminance_value_generator.rs",
    ),
    unit(
        "combiner",
        "350",
        "texture times illuminance, with the old value where asked",
        "crates/units/texel-value-generator/src/combiner.rs",
    ),
    unit("pixel-value-buffer", "360", "keeps the picture", "crates/units/frame-buffer"),
    unit("dacs", "370", "read every finished frame once, for the display (380)", "crates/units/frame-buffer/src/video_out.rs"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texel::{DIAGRAM, TexelMachineConfig, TextureMappingSystem};

    fn without_depth_test() -> TexelMachineConfig {
        let mut config = TexelMachineConfig::default();
        config.pixel_value_buffer.depth_test = false;
        config
    }

    crate::unit_info::checks_the_table!(TextureMappingSystem, [TexelMachineConfig::default(), without_depth_test()]);
}
