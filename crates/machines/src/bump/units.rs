//! The boxes of the block diagram, in words: what `describe` prints.

use crate::unit_info::{UnitInfo, unit};

/// All stages of the machine, in the order of the wiring.
pub const UNITS: &[UnitInfo] = &[
    unit("host", "", "feeds the scene, one draw command per cycle", "crates/geometry-processor/src/source.rs"),
    unit("geometry", "102", "transforms, clips, culls, projects; LOD; marks bump targets", "crates/geometry-processor"),
    unit("display-list", "", "replays a recorded display list in place of (102)", "crates/geometry-processor/src/source.rs"),
    unit("rasterizer", "", "polygons to fragments: exact coverage, top-left rule", "crates/rasterizer"),
    unit("depth-test", "", "z-test, early or late; owns the z-buffer", "crates/graphics-processor/src/depth.rs"),
    unit("distributor", "", "sends what is no bump target straight on to (104)", "crates/rasterizer/src/distributor.rs"),
    unit("normal-mapping", "108", "maps the normals of the selected MIP levels: pseudo-normals N'", "crates/normal-mapping"),
    unit("replacement", "110", "replaces N' by the index of the nearest reference normal", "crates/replacement"),
    unit("brightness", "112", "looks brightness up by index, interpolates between levels", "crates/brightness"),
    unit("graphics", "104", "texture RGB times brightness", "crates/graphics-processor"),
    unit("frame-buffer", "126", "keeps the picture, in memory (124)", "crates/frame-buffer"),
    unit("video-out", "", "reads every finished frame once", "crates/frame-buffer/src/video_out.rs"),
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
