//! The boxes of the block diagram, in words: what `describe` prints.

use crate::unit_info::{UnitInfo, unit};

/// All stages of the machine, in the order of the wiring.
pub const UNITS: &[UnitInfo] = &[
    unit("host", "", "feeds the scene, one draw command per cycle", "crates/units/geometry-processor/src/scene_source.rs"),
    unit("geometry", "453", "transforms, clips, culls, projects", "crates/units/geometry-processor"),
    unit(
        "display-list",
        "",
        "replays a recorded display list in their place",
        "crates/units/geometry-processor/src/display_list_source.rs",
    ),
    unit(
        "server",
        "110",
        "has polygons (112) and textures (114); sends tiles on request",
        "crates/units/deferred-renderer/src/server.rs",
    ),
    unit("path", "106", "network (106), I/O port (104), bus (108): rate, latency", "crates/units/deferred-renderer/src/path.rs"),
    unit("expander", "", "expands compressed tiles", "crates/units/deferred-renderer/src/expander.rs"),
    unit("rasterizer", "454", "finds the pixels of polygons", "crates/units/rasterizer"),
    unit("z-test", "", "hidden-surface removal, with (124) as depth buffer", "crates/units/graphics-processor/src/depth_test.rs"),
    unit(
        "cells",
        "",
        "texture, coordinates, layer depth, brightness of a pixel; sets pages (132) up",
        "crates/units/deferred-renderer/src/cells.rs",
    ),
    unit(
        "reference-buffer",
        "126",
        "one cell per pixel: filled, then passed over",
        "crates/units/deferred-renderer/src/reference_buffer.rs",
    ),
    unit(
        "identification",
        "461",
        "marks the tiles that pixels need (Figures 5A, 5B)",
        "crates/units/deferred-renderer/src/identification.rs",
    ),
    unit(
        "tile-lists",
        "136",
        "N, L or E per tile; loads or synthesizes (Figure 6)",
        "crates/units/deferred-renderer/src/tile_lists.rs",
    ),
    unit(
        "final-rasterization",
        "463",
        "keeps pyramids (134) in (130), interpolates in and between layers (Figures 7A, 7B)",
        "crates/units/deferred-renderer/src/rasterization/unit.rs",
    ),
    unit(
        "pixel-buffer",
        "124",
        "keeps the picture where the depth values were, and shows it",
        "crates/units/frame-buffer/src/pixel_buffer.rs",
    ),
    unit(
        "video-out",
        "116",
        "reads every picture shown once, for the monitor (150)",
        "crates/units/frame-buffer/src/video_out.rs",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defer::{DIAGRAM, DeferConfig, DeferredRenderer};

    crate::unit_info::checks_the_table!(DeferredRenderer, [DeferConfig::default()]);
}
