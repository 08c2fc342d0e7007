//! Checks across parameters, and warnings for the report.

use super::BumpProcessorConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, problem, slow_fifos};
use crate::spec::MachineSpec;
use basrelief_brightness::{BrightnessSource, Components};
use basrelief_graphics_processor::{GraphicsProcessor, HeldEntry};
use basrelief_kernel::Unit;
use basrelief_kernel::stats::UnitStats;
use basrelief_normal_mapping::NormalMapping;
use basrelief_replacement::CodeBookMode;
use basrelief_signals::width::count;
use basrelief_signals::{MAX_SAMPLES, SignalWidths};

/// Converts an error of the configured VQ tables.
pub(super) fn no_table(e: basrelief_shading::TableError) -> ConfigProblem {
    ConfigProblem { key: "replacement.entries".into(), message: e.to_string() }
}

/// Checks that the parameters fit together.
pub(super) fn check(c: &BumpProcessorConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    c.swap_chain().check("graphics", &c.memory.graphics)?;
    c.texture.check()?;
    let samples = c.normal_mapping.samples(c.brightness.levels) as usize;
    if samples > MAX_SAMPLES {
        return problem(
            "normal_mapping.filter_at",
            format!(
                "needs {samples} pseudo-normals per fragment, but a token holds {MAX_SAMPLES}; set brightness.levels to 2 or less, or normal_mapping.filter_at = normal"
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

/// Returns the maximum number of fragments of a stamp: the configured number, limited by the credits of the ports, because one step looks
/// up the lines of all fragments (law 3). With few credits, the machine is slower but still runs.
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

/// Returns the widths of the signals, with `stamp` fragments per stamp.
pub(super) fn widths(config: &BumpProcessorConfig, stamp: u32) -> SignalWidths {
    let most = config.replacement.entries.levels().into_iter().max().unwrap_or(1);
    let values = if config.brightness.components == Components::Separate { 2 } else { 1 };
    SignalWidths {
        depth: config.rasterizer.z_bits,
        stamp,
        samples: config.normal_mapping.samples(config.brightness.levels),
        normal: config.normal_mapping.normal_bits,
        index: count(most.max(2) - 1),
        brightness: values * config.brightness.bits,
        polygon: config.front().taken.triangle_bits(),
        ..SignalWidths::default()
    }
}

/// Returns the size of a deferred fragment of a bump target \[bits\].
pub(super) fn entry_bits(c: &BumpProcessorConfig) -> u32 {
    let widths = widths(c, 1);
    match c.graphics.held {
        HeldEntry::Brightness => widths.brightness,
        HeldEntry::Index => widths.samples * widths.index,
        HeldEntry::Normal => widths.samples * 3 * widths.normal,
    }
}

/// Returns warnings for the report: FIFOs that limit the throughput, reduced stamps, and violations of claim 3.
pub fn warnings(c: &BumpProcessorConfig, facts: &UnitStats) -> Vec<String> {
    let fewer = stamp(c);
    let stamps = (fewer < c.rasterizer.stamp).then(|| {
        format!("stamps have {fewer} instead of {} fragments, because larger ones need more requests in flight; raise memory.*.outstanding", c.rasterizer.stamp)
    });
    slow_fifos(facts).into_iter().chain(stamps).chain(few_tables(c)).chain(claim_3_warning(c, facts)).collect()
}

/// Warns if the unit holds fewer tables than a fragment has levels, because it then loads the tables for every fragment.
fn few_tables(c: &BumpProcessorConfig) -> Option<String> {
    let (needed, held) = (u32::from(c.brightness.levels), c.replacement.resident_tables);
    let searches_tables = c.replacement.codebook == CodeBookMode::Fixed;
    (searches_tables && held < needed).then(|| {
        format!("a fragment with {needed} levels needs {needed} VQ tables, but the unit holds {held} and reloads them for every fragment; raise replacement.resident_tables")
    })
}

/// Warns if a table has as many reference normals as the surface has distinct pseudo-normals. Claim 3 requires fewer; otherwise
/// quantization saves nothing.
fn claim_3_warning(c: &BumpProcessorConfig, facts: &UnitStats) -> Option<String> {
    let (distinct, searches) = (facts.count("distinct_pseudo_normals"), facts.count("searches"));
    let entries = c.replacement.entries.levels().into_iter().max().unwrap_or(0);
    (searches > 0 && distinct <= u64::from(entries)).then(|| {
        let normals = if distinct == 1 { "pseudo-normal" } else { "pseudo-normals" };
        format!("the surface has {distinct} distinct {normals}, and a VQ table has {entries} entries; claim 3 requires fewer entries (replacement.entries)")
    })
}
