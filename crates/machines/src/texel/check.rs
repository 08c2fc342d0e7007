//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::TexelMachineConfig;
use crate::counts::Counts;
use crate::problem::{ConfigProblem, Feed, line_is_power_of_two, problem};
use basrelief_signals::LINE_PIXELS;

/// Checks what spans parameters.
pub(super) fn check(c: &TexelMachineConfig) -> Result<(), ConfigProblem> {
    line_is_power_of_two("texture", c.cache.texture.line_bytes)?;
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    let depth_bytes = LINE_PIXELS * if c.scan.z_bits <= 16 { 2 } else { 4 };
    if c.cache.depth.line_bytes < depth_bytes {
        return problem(
            "cache.depth.line_bytes",
            format!(
                "is {}, but the depth of {LINE_PIXELS} pixels is tested in one look-up; set it to {depth_bytes} or more",
                c.cache.depth.line_bytes
            ),
        );
    }
    Ok(())
}

/// FIFOs that cannot hold full rate (law 2): one sentence each, with the rate that they allow. Memory latency comes on
/// top and is not looked at here.
pub fn warnings(c: &TexelMachineConfig) -> Vec<String> {
    let f = &c.fifo;
    let feed = |name, fifo, latency, occupancy| Feed { name, fifo, latency, occupancy };
    let root = if c.texel.step_table > 0 { c.texel.table_cycles } else { c.texel.root_cycles };
    // Two divisions keep so many dividers.
    let division = (2 * c.divider.initiation_interval).div_ceil(c.divider.count);
    let feeds = [
        feed("polygons", &f.polygons, c.geometry.latency, c.geometry.cycles_per_polygon.max(1)),
        feed("spans", &f.spans, c.scan.latency, c.scan.cycles_per_span),
        feed("points", &f.points, c.texel.latency + root, root),
        feed("segments", &f.segments, c.texel.latency + root, root),
        feed("quotients", &f.quotients, c.divider.latency, division),
        Feed::new("texels", &f.texels, c.approximation.latency),
        Feed::new("gradients", &f.gradients, c.approximation.latency),
        Feed::new("tested_texels", &f.tested_texels, c.depth.latency),
        Feed::new("levels", &f.levels, c.mip.latency),
        Feed::new("texture_values", &f.texture_values, c.look_up.latency),
        Feed::new("illuminances", &f.illuminances, c.illuminance.latency),
        Feed::new("pixels", &f.pixels, c.combiner.latency),
    ];
    feeds.iter().filter_map(Feed::warning).collect()
}

/// What of the input the system has no use for: one sentence each.
pub fn input_warnings(counts: &Counts) -> Vec<String> {
    let (fragments, textured) = (counts.number("fragments"), counts.number("textured_fragments"));
    let none = fragments > 0 && textured == 0;
    none.then(|| "no polygon has a colour texture: nothing was divided".to_owned()).into_iter().collect()
}
