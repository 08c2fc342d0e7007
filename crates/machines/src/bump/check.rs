//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::BumpProcessorConfig;
use super::machine::widths;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, problem, slow_fifos};
use basrelief_brightness::BrightnessSource;
use basrelief_graphics_processor::{GraphicsProcessor, HeldEntry};
use basrelief_kernel::Unit;
use basrelief_kernel::stats::UnitStats;
use basrelief_normal_mapping::NormalMapping;
use basrelief_replacement::CodeBookMode;
use basrelief_signals::MAX_SAMPLES;

/// There is no VQ table as configured.
pub(super) fn no_table(e: basrelief_shading::TableError) -> ConfigProblem {
    ConfigProblem { key: "replacement.entries".into(), message: e.to_string() }
}

/// Checks what spans parameters.
pub(super) fn check(c: &BumpProcessorConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    c.texture.check()?;
    let samples = c.normal_mapping.samples(c.brightness.levels) as usize;
    if samples > MAX_SAMPLES {
        return problem(
            "normal_mapping.filter_at",
            format!(
                "{samples} pseudo-normals per fragment, a token holds {MAX_SAMPLES}; set brightness.levels to 2 or less, or normal_mapping.filter_at = normal"
            ),
        );
    }
    c.replacement.table_set().check().map_err(no_table)?;
    for (name, line_bytes) in [
        ("normal_map", c.cache.normal_map.line_bytes),
        ("clut", c.cache.clut.line_bytes),
        ("color_texture", c.cache.color_texture.line_bytes),
        ("depth", c.cache.depth.line_bytes),
    ] {
        line_is_power_of_two(name, line_bytes)?;
    }
    Ok(())
}

/// Most fragments of a stamp: as configured, but no more than ports have credits for, as a step looks up the lines of all
/// of them (law 3). So few credits cost time, and never keep a machine from running that could run with single fragments.
pub(super) fn stamp(c: &BumpProcessorConfig) -> u32 {
    let (levels, line_bytes) = (c.brightness.levels, c.cache.normal_map.line_bytes);
    let mapping = NormalMapping::new(c.normal_mapping.clone(), &c.operators, levels, 1, line_bytes).largest_step(0);
    let lines = if c.brightness.source == BrightnessSource::Direct { 2 } else { 1 };
    let brightness = lines * c.normal_mapping.samples(levels);
    let sizes = [1, c.cache.color_texture.line_bytes, entry_bits(c)];
    let graphics = GraphicsProcessor::new(c.graphics.clone(), c.operators.clone(), false, sizes);
    let graphics = graphics.largest_step(0).max(graphics.largest_step(1));
    let memory = &c.memory;
    [
        (memory.normal_map.outstanding, mapping),
        (memory.quantization.outstanding, brightness),
        (memory.graphics.outstanding, graphics),
    ]
    .into_iter()
    .map(|(credits, of_a_fragment)| credits / of_a_fragment.max(1))
    .fold(c.rasterizer.stamp, u32::min)
    .max(1)
}

/// What waits of a fragment of a bump target until the list is drawn \[bits\].
pub(super) fn entry_bits(c: &BumpProcessorConfig) -> u32 {
    let widths = widths(c, 1);
    match c.graphics.held {
        HeldEntry::Brightness => widths.brightness,
        HeldEntry::Index => widths.samples * widths.index,
        HeldEntry::Normal => widths.samples * 3 * widths.normal,
    }
}

/// What the reader of a report should know, one sentence each: rates that FIFOs do not hold, smaller stamps, and where claim 3 was
/// not met.
pub fn warnings(c: &BumpProcessorConfig, facts: &UnitStats) -> Vec<String> {
    let fewer = stamp(c);
    let stamps = (fewer < c.rasterizer.stamp).then(|| {
        format!("stamps of {fewer} instead of {} fragments: a step of more needs more requests in flight (memory.*.outstanding) than there may be", c.rasterizer.stamp)
    });
    slow_fifos(facts).into_iter().chain(stamps).chain(few_tables(c)).chain(claim_3_warning(c, facts)).collect()
}

/// A fragment needs a table for each level that it is interpolated from: a unit that holds fewer loads them anew for each.
fn few_tables(c: &BumpProcessorConfig) -> Option<String> {
    let (needed, held) = (u32::from(c.brightness.levels), c.replacement.resident_tables);
    let searches_tables = c.replacement.codebook == CodeBookMode::Fixed;
    (searches_tables && held < needed).then(|| {
        format!("a fragment of {needed} levels needs as many VQ tables, and the unit holds {held}: it loads them anew for every fragment (replacement.resident_tables)")
    })
}

/// Claim 3 wants fewer reference normals in a table than distinct pseudo-normals on the surface: says where a run was
/// otherwise. Quantizing then costs tables without saving anything.
fn claim_3_warning(c: &BumpProcessorConfig, facts: &UnitStats) -> Option<String> {
    let (distinct, searches) = (facts.count("distinct_pseudo_normals"), facts.count("searches"));
    let entries = c.replacement.entries.levels().into_iter().max().unwrap_or(0);
    (searches > 0 && distinct <= u64::from(entries)).then(|| {
        format!("the surface has {distinct} distinct pseudo-normals, a VQ table {entries} entries: claim 3 wants fewer entries (replacement.entries)")
    })
}
