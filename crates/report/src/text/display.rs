//! The display as a table.

use super::table::Align::{Left, Right};
use super::table::Table;
use crate::model::Report;
use crate::number::{percent, rounded, thousands};

/// Returns the scan-out and the flips of the display.
pub(crate) fn display(report: &Report) -> Table {
    let mut table = Table::new(&[
        ("Display", Left, 0),
        ("flips", Right, 0),
        ("shown", Right, 0),
        ("per s", Right, 1),
        ("flip latency", Right, 1),
        ("longest", Right, 2),
        ("reads", Right, 2),
        ("underruns", Right, 0),
        ("bus %", Right, 0),
    ]);
    let Some(d) = &report.display else { return table };
    let derived = |name: &str| report.derived.get(name).map_or(0.0, |derived| derived.value);
    table.row([
        d.memory.clone(),
        thousands(d.flips),
        thousands(d.pictures_shown),
        rounded(derived("display.pictures_per_s")),
        rounded(derived("display.flip_latency")),
        thousands(d.longest_flip_wait),
        thousands(d.reads),
        thousands(d.underruns),
        percent((1e6 * derived("display.bus_share")) as u64, 1_000_000),
    ]);
    table
}
