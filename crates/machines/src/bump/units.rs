//! The boxes of the block diagram, in words: what `describe` prints.

use crate::unit_info::{UnitInfo, unit};

/// All stages of the machine, in the order of the wiring.
pub const UNITS: &[UnitInfo] = &[
    unit("host", "", "feeds the scene, one draw command per cycle", "crates/units/geometry-processor/src/scene_source.rs"),
    unit("geometry", "102", "transforms, clips, culls, projects; LOD; marks bump targets", "crates/units/geometry-processor"),
    unit(
        "display-list",
        "",
        "replays a recorded display list in place of (102)",
        "crates/units/geometry-processor/src/display_list_source.rs",
    ),
    unit("rasterizer", "", "polygons to fragments: exact coverage, top-left rule", "crates/units/rasterizer"),
    unit("depth-test", "", "z-test, early or late; owns the z-buffer", "crates/units/graphics-processor/src/depth_test.rs"),
    unit("distributor", "", "sends what is no bump target straight on to (104)", "crates/units/rasterizer/src/distributor.rs"),
    unit(
        "normal-mapping",
        "108",
        "maps the normals of the selected MIP levels: pseudo-normals N'",
        "crates/units/normal-mapping",
    ),
    unit("replacement", "110", "replaces N' by the index of the nearest reference normal", "crates/units/replacement"),
    unit("brightness", "112", "looks brightness up by index, interpolates between levels", "crates/units/brightness"),
    unit("graphics", "104", "texture RGB times brightness", "crates/units/graphics-processor"),
    unit("frame-buffer", "126", "keeps the picture, in memory (124)", "crates/units/frame-buffer"),
    unit("video-out", "", "reads every finished frame once", "crates/units/frame-buffer/src/video_out.rs"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bump::{BumpProcessor, BumpProcessorConfig, DIAGRAM};

    fn late_z() -> BumpProcessorConfig {
        let mut config = BumpProcessorConfig::default();
        config.rasterizer.early_z = false;
        config
    }

    crate::unit_info::checks_the_table!(BumpProcessor, [BumpProcessorConfig::default(), late_z()]);
}
