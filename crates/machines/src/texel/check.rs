//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::TexelMachineConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, problem, slow_fifos};
use basrelief_kernel::stats::UnitStats;
use basrelief_signals::LINE_PIXELS;

/// Checks what spans parameters.
pub(super) fn check(c: &TexelMachineConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    c.texture.check()?;
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

/// What the reader of a report should know, one sentence each: rates that FIFOs do not hold, and what of the input the machine
/// has no use for.
pub fn warnings(facts: &UnitStats) -> Vec<String> {
    slow_fifos(facts).into_iter().chain(input_warnings(facts)).collect()
}

/// What of the input the system has no use for: one sentence each.
fn input_warnings(facts: &UnitStats) -> Vec<String> {
    let (fragments, textured) = (facts.count("fragments"), facts.count("textured_fragments"));
    let none = fragments > 0 && textured == 0;
    none.then(|| "no polygon has a colour texture: nothing was divided".to_owned()).into_iter().collect()
}
