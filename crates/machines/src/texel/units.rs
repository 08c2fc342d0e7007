//! The boxes of the block diagram, in words: what `describe` prints.

use crate::unit_info::{UnitInfo, unit};

/// All stages of the machine, in the order of the wiring.
pub const UNITS: &[UnitInfo] = &[
    unit("host", "", "feeds the scene, one draw command per cycle", "crates/geometry-processor/src/source.rs"),
    unit("geometry", "", "transforms, clips, culls, projects", "crates/geometry-processor"),
    unit("display-list", "", "replays a recorded display list in their place", "crates/geometry-processor/src/source.rs"),
    unit(
        "scan-converter",
        "",
        "finds spans with exact U, V, W at both ends",
        "crates/texel-value-generator/src/scan_converter.rs",
    ),
    unit(
        "step-calculator",
        "310",
        "chooses division points by the criterion in its storage element",
        "crates/texel-value-generator/src/step_calculator",
    ),
    unit("divider", "310", "exact u, v at ends and division points", "crates/texel-value-generator/src/divider.rs"),
    unit(
        "approximate-calculator",
        "310a",
        "interpolates u, v between division points",
        "crates/texel-value-generator/src/approximate_calculator",
    ),
    unit("mip-map-selector", "320", "selects a level by du, dv", "crates/texel-value-generator/src/mip_map_selector.rs"),
    unit("depth-test", "", "tests depth in front of (330); owns the depth values", "crates/graphics-processor/src/depth.rs"),
    unit(
        "texture-look-up",
        "330",
        "looks texels up and filters them",
        "crates/texel-value-generator/src/texture_look_up_table.rs",
    ),
    unit(
        "illuminance",
        "340",
        "interpolates brightness and colour",
        "crates/texel-value-generator/src/illuminance_value_generator.rs",
    ),
    unit(
        "combiner",
        "350",
        "texture times illuminance, with the old value where asked",
        "crates/texel-value-generator/src/combiner.rs",
    ),
    unit("pixel-value-buffer", "360", "keeps the picture", "crates/frame-buffer"),
    unit("dacs", "370", "read every finished frame once, for the display (380)", "crates/frame-buffer/src/video_out.rs"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texel::{DIAGRAM, FrontEnd, SceneFront, TexelMachineConfig, TextureMappingSystem, TraceFront};
    use crate::unit_info::tests::{code_is_there, diagram_is_complete, names_the_stages};
    use basrelief_kernel::{StageTopology, topology};
    use basrelief_signals::{Control, Draw};

    fn stages<F: FrontEnd>(front: F, config: &TexelMachineConfig) -> Vec<StageTopology> {
        topology(&mut TextureMappingSystem::new(front, config).unwrap())
    }

    /// All stages, whichever way in.
    fn all() -> Vec<StageTopology> {
        let config = TexelMachineConfig::default();
        let trace = std::iter::empty::<Result<(Control, Option<u64>), String>>();
        let mut all = stages(SceneFront::new(std::iter::empty::<Draw>(), &config), &config);
        all.extend(stages(TraceFront::new(trace, &config), &config));
        all
    }

    #[test]
    fn the_table_names_exactly_the_stages_that_are_wired() {
        names_the_stages(UNITS, &all());
    }

    #[test]
    fn the_diagram_shows_every_fifo_every_client_and_every_numeral() {
        diagram_is_complete(DIAGRAM, UNITS, &all());
    }

    #[test]
    fn the_code_is_where_the_table_says() {
        code_is_there(UNITS);
    }
}
