//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::ShadeConfig;
use crate::counts::Counts;
use crate::problem::{ConfigProblem, Feed, line_is_power_of_two, problem};
use basrelief_figure_shading::Power;

/// Checks what spans parameters.
pub(super) fn check(c: &ShadeConfig) -> Result<(), ConfigProblem> {
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    if c.fifo.finished.depth < c.host.buffers {
        return problem(
            "fifo.finished.depth",
            format!(
                "is {}, but {} polygons can be under way and feedback must hold them all (law 7); set it to {} or more",
                c.fifo.finished.depth, c.host.buffers, c.host.buffers
            ),
        );
    }
    Ok(())
}

/// Exponent for which the rate of circuit (50) is looked at: the patent's largest.
const LARGEST_EXPONENT: f32 = 200.0;

/// FIFOs that cannot hold full rate (law 2): one sentence each, with the rate that they allow. Memory latency comes on
/// top and is not looked at here.
pub fn warnings(c: &ShadeConfig) -> Vec<String> {
    let f = &c.fifo;
    let power = Power::new(&c.normal_interpolation);
    let normalise = if c.shade.renormalise { c.normal_interpolation.normalise_latency } else { 0 };
    let highlight = c.normal_interpolation.inner_product_latency + normalise + power.latency(LARGEST_EXPONENT) as u32;
    let feed = |name, fifo, latency, occupancy| Feed { name, fifo, latency, occupancy };
    let (dot, circuit_21) = (c.microcomputer.dot_cycles, &c.interpolation);
    let feeds = [
        feed("polygons", &f.polygons, c.geometry.latency, c.geometry.cycles_per_polygon.max(1)),
        feed("flat_dots", &f.flat_dots, dot, dot),
        feed("constant_dots", &f.constant_dots, dot, dot),
        feed("interpolated", &f.interpolated, circuit_21.latency, circuit_21.initiation_interval),
        feed("brightness_dots", &f.brightness_dots, circuit_21.latency, circuit_21.initiation_interval),
        feed("highlights", &f.highlights, highlight, power.occupancy(LARGEST_EXPONENT) as u32),
        feed("gated", &f.gated, c.gate.latency, c.gate.initiation_interval),
        feed("sums", &f.sums, c.adder.latency, c.adder.initiation_interval),
        feed("selected", &f.selected, c.selector_53.latency, c.selector_53.initiation_interval),
        feed("pixels", &f.pixels, c.selector_28.latency, c.selector_28.initiation_interval),
        Feed::new("tested_pixels", &f.tested_pixels, c.depth.latency),
    ];
    feeds.iter().filter_map(Feed::warning).collect()
}

/// What the device could not draw as it was given: one sentence each.
pub fn input_warnings(counts: &Counts) -> Vec<String> {
    let textured = counts.number("polygons_textured");
    let dropped = counts.number("polygons_dropped");
    let sentences = [
        (textured, format!("{textured} polygons have a colour texture; the device has none, they take the base colour")),
        (dropped, format!("{dropped} polygons have fewer than three points and were not drawn")),
    ];
    sentences.into_iter().filter(|(count, _)| *count > 0).map(|(_, sentence)| sentence).collect()
}
