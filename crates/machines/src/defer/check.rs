//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::DeferConfig;
use crate::Counts;
use crate::problem::{ConfigProblem, Feed, line_is_power_of_two, problem};
use basrelief_deferred_renderer::NumberFormat;

/// Checks what spans parameters.
pub(super) fn check(c: &DeferConfig) -> Result<(), ConfigProblem> {
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    line_is_power_of_two("texel", c.cache.texel.line_bytes)?;
    for (key, side) in [("tile.width", c.tile.width), ("tile.height", c.tile.height)] {
        if !side.is_power_of_two() {
            return problem(key, format!("is {side}, expected a power of two"));
        }
    }
    let cell = &c.cell;
    let fields = [
        ("cell.coordinate_fraction_bits", cell.coordinate_format, cell.coordinate_bits, cell.coordinate_fraction_bits),
        ("cell.depth_fraction_bits", cell.depth_format, cell.depth_bits, cell.depth_fraction_bits),
    ];
    for (key, format, bits, fraction) in fields {
        // The sign, and for a layer depth or a coordinate something in front of the point.
        if format == NumberFormat::Fixed && fraction + 5 > bits {
            return problem(
                key,
                format!(
                    "is {fraction}, but the field has {bits} bits, 5 of them in front of the point; set it to {} or less",
                    bits.saturating_sub(5)
                ),
            );
        }
    }
    Ok(())
}

/// FIFOs that cannot hold full rate (law 2): one sentence each, with the rate that they allow. Memory latency comes on
/// top and is not looked at here.
pub fn warnings(c: &DeferConfig) -> Vec<String> {
    let (f, latency) = (&c.fifo, c.engine.latency);
    let blocks = |name, fifo, per_cycle: u32| Feed { name, fifo, latency, occupancy: 16_u32.div_ceil(per_cycle) };
    let feeds = [
        Feed::new("fragments", &f.fragments, c.rasterizer.latency),
        Feed::new("tested_fragments", &f.tested_fragments, c.depth.latency),
        Feed::new("cells", &f.cells, latency),
        blocks("marking", &f.marking, c.engine.scan_rate),
        blocks("colouring", &f.colouring, c.engine.scan_rate),
        blocks("pixels", &f.pixels, c.engine.interpolation_rate),
    ];
    feeds.iter().filter_map(Feed::warning).collect()
}

/// What of the input the renderer has no use for: one sentence each.
pub fn input_warnings(counts: &Counts) -> Vec<String> {
    let none = counts.number("cells_direct") > 0 && counts.number("cells_textured") == 0;
    none.then(|| "no pixel has a colour texture: no tile was needed".to_owned()).into_iter().collect()
}
