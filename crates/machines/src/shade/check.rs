//! Checks across parameters, and warnings for the report.

use super::ShadeConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, problem, slow_fifos, unused_normal_maps};
use basrelief_kernel::stats::UnitStats;

/// Checks that the parameters fit together.
pub(super) fn check(c: &ShadeConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    c.swap_chain().check("frame", &c.memory.frame)?;
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    if c.fifo.finished.depth < c.host.buffers {
        return problem(
            "fifo.finished.depth",
            format!(
                "is {}, but {} polygons can be in flight and the feedback FIFO must hold all of them (law 7); set it to {} or more",
                c.fifo.finished.depth, c.host.buffers, c.host.buffers
            ),
        );
    }
    Ok(())
}

/// Returns warnings for the report: FIFOs that limit the throughput, and input that the machine cannot use.
pub fn warnings(facts: &UnitStats) -> Vec<String> {
    slow_fifos(facts).into_iter().chain(unused_normal_maps(facts)).chain(input_warnings(facts)).collect()
}

/// Returns warnings about input that the device cannot draw as given.
fn input_warnings(facts: &UnitStats) -> Vec<String> {
    let textured = facts.count("polygons_textured");
    let dropped = facts.count("polygons_dropped");
    let sentences = [
        (textured, format!("{textured} polygons have a colour texture; the device has no textures and uses the base colour")),
        (dropped, format!("{dropped} polygons have fewer than three points and were not drawn")),
    ];
    sentences.into_iter().filter(|(count, _)| *count > 0).map(|(_, sentence)| sentence).collect()
}
