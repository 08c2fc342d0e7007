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
    use crate::bump::{BumpProcessor, BumpProcessorConfig, DIAGRAM, FrontEnd, SceneFront, TraceFront};
    use crate::unit_info::tests::{code_is_there, diagram_is_complete, names_the_stages};
    use basrelief_kernel::{StageTopology, topology};
    use basrelief_signals::{Control, Draw};

    fn stages<F: FrontEnd>(front: F, config: &BumpProcessorConfig) -> Vec<StageTopology> {
        topology(&mut BumpProcessor::new(front, config).unwrap())
    }

    /// All stages, whichever way in and with early and late z.
    fn all() -> Vec<StageTopology> {
        let early = BumpProcessorConfig::default();
        let mut late = early.clone();
        late.rasterizer.early_z = false;
        let trace = || std::iter::empty::<Result<(Control, Option<u64>), String>>();
        let mut all = stages(SceneFront::new(std::iter::empty::<Draw>(), &early), &early);
        all.extend(stages(TraceFront::new(trace(), &late), &late));
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
