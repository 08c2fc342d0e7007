//! Checks across parameters, and warnings for the report.

use super::DeferConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, longer_part, problem, slow_fifos, unused_normal_maps};
use basrelief_deferred_renderer::{LightingMode, NumberFormat, RenderMode};
use basrelief_kernel::stats::UnitStats;

/// Latest time of a user action: three months \[ms\].
const LATEST_MS: f64 = 8e9;

/// Size of a single-precision number \[bytes\].
const SINGLE_BYTES: u32 = 4;

/// Checks that the parameters fit together.
pub(super) fn check(c: &DeferConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    c.swap_chain().check("pixel_depth", &c.memory.pixel_depth)?;
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    line_is_power_of_two("texel", c.cache.texel.line_bytes)?;
    for (key, side) in [("tile.width", c.tile.width), ("tile.height", c.tile.height)] {
        if !side.is_power_of_two() {
            return problem(key, format!("is {side}, expected a power of two"));
        }
    }
    if (1..SINGLE_BYTES).contains(&c.path.number_bytes) {
        let message = format!(
            "is {}, but a single-precision number takes {SINGLE_BYTES} bytes; set it to {SINGLE_BYTES} or more, or to 0 if the device has \
             all meshes",
            c.path.number_bytes
        );
        return problem("path.number_bytes", message);
    }
    check_leaving(c)?;
    let cell = &c.cell;
    let fields = [
        ("cell.coordinate_fraction_bits", cell.coordinate_format, cell.coordinate_bits, cell.coordinate_fraction_bits),
        ("cell.depth_fraction_bits", cell.depth_format, cell.depth_bits, cell.depth_fraction_bits),
    ];
    for (key, format, bits, fraction) in fields {
        // One bit is the sign; a layer depth or a coordinate needs some integer bits.
        if format == NumberFormat::Fixed && fraction + 5 > bits {
            return problem(
                key,
                format!(
                    "is {fraction}, but the field has {bits} bits, 5 of them before the point; set it to {} or less",
                    bits.saturating_sub(5)
                ),
            );
        }
    }
    Ok(())
}

/// Checks the times and tile counts at which views are left.
fn check_leaving(c: &DeferConfig) -> Result<(), ConfigProblem> {
    let times = &c.defer.left_at_ms;
    if !times.iter().all(|ms| (0.0..=LATEST_MS).contains(ms)) || !times.is_sorted() {
        return problem("defer.left_at_ms", format!("is {times:?}, expected ascending times from 0 to {LATEST_MS} ms"));
    }
    let tiles = &c.defer.left_at_tile;
    // Times may come from a file of views.
    for (key, how, is_given) in [
        ("defer.left_at_ms", "set, or views have `at_ms`", !times.is_empty()),
        ("defer.left_at_tile", "set", !tiles.is_empty()),
        ("defer.pictures_per_view", "set", c.defer.pictures_per_view > 0),
    ] {
        if is_given && c.defer.mode != RenderMode::Progressive {
            let message = format!("is {how}, but a view can be left only in progressive mode; set `defer.mode=progressive`");
            return problem(key, message);
        }
    }
    Ok(())
}

/// Returns warnings for the report: FIFOs that limit the throughput or the requests in flight, and input that the machine cannot use.
pub fn warnings(c: &DeferConfig, facts: &UnitStats) -> Vec<String> {
    slow_fifos(facts)
        .into_iter()
        .chain(unused_requests(c))
        .chain(longer_part(("engine.filter_latency", c.engine.filter_latency), ("engine.latency", c.engine.latency)))
        .chain(unused_early_z(c))
        .chain(clamped_coordinates(facts))
        .chain(unused_normal_maps(facts))
        .chain(input_warnings(c, facts))
        .collect()
}

/// Warns if the FIFO of orders limits the tiles in flight, because each tile in flight has a waiting order.
fn unused_requests(c: &DeferConfig) -> Option<String> {
    let (orders, tiles) = (c.fifo.orders.depth, c.path.requests * c.path.tiles_per_request);
    (tiles > orders).then(|| {
        format!(
            "fifo.orders.depth = {orders} allows {orders} tiles in flight; path.requests x path.tiles_per_request are {tiles}"
        )
    })
}

/// Warns if the parameter for a later depth test is set, which only other machines have.
fn unused_early_z(c: &DeferConfig) -> Option<String> {
    let text =
        "rasterizer.early_z = false has no effect: this machine tests the depth of fragments before it makes cells of them";
    (!c.rasterizer.early_z).then(|| text.to_owned())
}

/// Warns if texture coordinates exceed their fields, because the picture then shows other texels.
fn clamped_coordinates(facts: &UnitStats) -> Option<String> {
    let (clamped, all) = (facts.count("cells_clamped"), facts.count("cells_textured"));
    (clamped > 0).then(|| {
        format!(
            "the texture coordinates of {clamped} of {all} cells exceed their fields and are clamped; lower \
             cell.coordinate_fraction_bits, or raise cell.coordinate_bits"
        )
    })
}

/// Returns warnings about input that the renderer cannot use.
fn input_warnings(c: &DeferConfig, facts: &UnitStats) -> Vec<String> {
    if facts.count("cells_direct") == 0 || facts.count("cells_textured") > 0 {
        return Vec::new();
    }
    let unlit = match c.defer.lighting {
        LightingMode::None => {
            ". `defer.lighting = none` computes no light, so each surface has one colour; `gouraud` lights vertices"
        }
        LightingMode::Gouraud => "",
    };
    vec![format!("no pixel has a colour texture, so no tile was needed{unlit}")]
}
