//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::ShadeConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, problem, slow_fifos};
use basrelief_kernel::stats::UnitStats;

/// Checks what spans parameters.
pub(super) fn check(c: &ShadeConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
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

/// What the reader of a report should know, one sentence each: rates that FIFOs do not hold, and what of the input the machine
/// has no use for.
pub fn warnings(facts: &UnitStats) -> Vec<String> {
    slow_fifos(facts).into_iter().chain(input_warnings(facts)).collect()
}

/// What the device could not draw as it was given: one sentence each.
fn input_warnings(facts: &UnitStats) -> Vec<String> {
    let textured = facts.count("polygons_textured");
    let dropped = facts.count("polygons_dropped");
    let sentences = [
        (textured, format!("{textured} polygons have a colour texture; the device has none, they take the base colour")),
        (dropped, format!("{dropped} polygons have fewer than three points and were not drawn")),
    ];
    sentences.into_iter().filter(|(count, _)| *count > 0).map(|(_, sentence)| sentence).collect()
}
