//! Checks across parameters, and warnings for the report.

use super::TexelMachineConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, longer_part, problem, slow_fifos, unused_normal_maps};
use basrelief_kernel::stats::UnitStats;
use basrelief_signals::LINE_PIXELS;

/// Checks that the parameters fit together.
pub(super) fn check(c: &TexelMachineConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    c.swap_chain().check("pixel", &c.memory.pixel)?;
    c.texture.check()?;
    line_is_power_of_two("texture", c.cache.texture.line_bytes)?;
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    let depth_bytes = LINE_PIXELS * if c.scan.z_bits <= 16 { 2 } else { 4 };
    if c.cache.depth.line_bytes < depth_bytes {
        return problem(
            "cache.depth.line_bytes",
            format!(
                "is {}, but one look-up tests the depth of {LINE_PIXELS} pixels; set it to {depth_bytes} or more",
                c.cache.depth.line_bytes
            ),
        );
    }
    Ok(())
}

/// Returns warnings for the report: FIFOs that limit the throughput, parts longer than their latency, and input that the machine cannot
/// use.
pub fn warnings(c: &TexelMachineConfig, facts: &UnitStats) -> Vec<String> {
    let parts = [
        longer_part(("look_up.filter_latency", c.look_up.filter_latency), ("look_up.latency", c.look_up.latency)),
        longer_part(("combiner.blend_latency", c.combiner.blend_latency), ("combiner.latency", c.combiner.latency)),
    ];
    let parts = parts.into_iter().flatten();
    slow_fifos(facts).into_iter().chain(parts).chain(unused_normal_maps(facts)).chain(input_warnings(facts)).collect()
}

/// Returns warnings about input that the system cannot use.
fn input_warnings(facts: &UnitStats) -> Vec<String> {
    let (fragments, textured) = (facts.count("fragments"), facts.count("textured_fragments"));
    let none = fragments > 0 && textured == 0;
    none.then(|| "no polygon has a colour texture: nothing was divided".to_owned()).into_iter().collect()
}
