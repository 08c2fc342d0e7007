//! What no single parameter's range can say: parameters that do not fit together, and rates that FIFOs allow.

use super::DeferConfig;
use crate::memories::check_memories;
use crate::problem::{ConfigProblem, line_is_power_of_two, problem, slow_fifos};
use basrelief_deferred_renderer::{NumberFormat, RenderMode};
use basrelief_kernel::stats::UnitStats;

/// Latest time that a user acts at: three months \[ms\].
const LATEST_MS: f64 = 8e9;

/// Checks what spans parameters.
pub(super) fn check(c: &DeferConfig) -> Result<(), ConfigProblem> {
    check_memories(c)?;
    line_is_power_of_two("depth", c.cache.depth.line_bytes)?;
    line_is_power_of_two("texel", c.cache.texel.line_bytes)?;
    for (key, side) in [("tile.width", c.tile.width), ("tile.height", c.tile.height)] {
        if !side.is_power_of_two() {
            return problem(key, format!("is {side}, expected a power of two"));
        }
    }
    check_leaving(c)?;
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

/// Where and when viewpoints are left.
fn check_leaving(c: &DeferConfig) -> Result<(), ConfigProblem> {
    let times = &c.defer.left_at_ms;
    if !times.iter().all(|ms| (0.0..=LATEST_MS).contains(ms)) || !times.is_sorted() {
        return problem("defer.left_at_ms", format!("is {times:?}, expected rising times of 0 to {LATEST_MS} ms"));
    }
    for (key, is_given) in [("defer.left_at_ms", !times.is_empty()), ("defer.left_at_tile", !c.defer.left_at_tile.is_empty())] {
        if is_given && c.defer.mode != RenderMode::Progressive {
            let message = "is given, but only progressive pictures are left for better ones; set `defer.mode=progressive`";
            return problem(key, message.into());
        }
    }
    Ok(())
}

/// What the reader of a report should know, one sentence each: rates that FIFOs do not hold, requests that they do not let the path have,
/// and what of the input the machine has no use for.
pub fn warnings(c: &DeferConfig, facts: &UnitStats) -> Vec<String> {
    slow_fifos(facts).into_iter().chain(unused_requests(c)).chain(input_warnings(facts)).collect()
}

/// Each tile in flight has an order that waits for it.
fn unused_requests(c: &DeferConfig) -> Option<String> {
    let (orders, tiles) = (c.fifo.orders.depth, c.path.requests * c.path.tiles_per_request);
    (tiles > orders).then(|| {
        format!(
            "fifo.orders.depth = {orders} allows {orders} tiles in flight; path.requests x path.tiles_per_request are {tiles}"
        )
    })
}

/// What of the input the renderer has no use for: one sentence each.
fn input_warnings(facts: &UnitStats) -> Vec<String> {
    let none = facts.count("cells_direct") > 0 && facts.count("cells_textured") == 0;
    let unused = "no pixel has a colour texture: no tile was needed".to_owned();
    none.then_some(unused).into_iter().collect()
}
