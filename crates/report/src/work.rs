//! What a device draws, in its own words: fragments, or dots on several paths.

use crate::model::{Figure, Report};

/// A way through a device on which it counts polygons and dots: figures `polygons_NAME` and `dots_NAME`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path<'a> {
    /// Name.
    pub name: &'a str,
    /// Polygons that took it.
    pub polygons: u64,
    /// Their dots.
    pub dots: u64,
}

fn count(figure: Option<&Figure>) -> u64 {
    match figure {
        Some(Figure::Count(n)) => *n,
        _ => 0,
    }
}

/// The paths of a device, in its order; none where it has only one.
pub fn paths(report: &Report) -> Vec<Path<'_>> {
    let named = report.device.iter().filter_map(|(key, figure)| Some((key.strip_prefix("dots_")?, figure)));
    let polygons = |name: &str| count(report.device.get(&format!("polygons_{name}")));
    named.map(|(name, figure)| Path { name, polygons: polygons(name), dots: count(Some(figure)) }).collect()
}

/// What cycles and bytes are divided by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Work {
    /// One of them: `fragment` or `dot`.
    pub one: &'static str,
    /// How many.
    pub count: u64,
    /// How many, in names of the report.
    pub formula: &'static str,
}

/// What a device draws: dots where it has paths, fragments otherwise.
pub fn work(report: &Report) -> Work {
    let paths = paths(report);
    if paths.is_empty() {
        return Work { one: "fragment", count: count(report.device.get("fragments")), formula: "device.fragments" };
    }
    let count = paths.iter().fold(0, |sum: u64, p| sum.saturating_add(p.dots));
    Work { one: "dot", count, formula: "sum(device.dots_*)" }
}

/// A circuit of which a device counts the cycles in which it was started: figure `NAME_started_cycles`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Circuit<'a> {
    /// Name.
    pub name: &'a str,
    /// Cycles of work whose result the picture needs, where the device tells them apart: figure `NAME_needed_cycles`.
    pub needed: Option<u64>,
    /// Cycles of work.
    pub started: u64,
}

/// The circuits of a device, in its order.
pub fn circuits(report: &Report) -> Vec<Circuit<'_>> {
    let named = report.device.iter().filter_map(|(key, figure)| Some((key.strip_suffix("_started_cycles")?, figure)));
    let needed = |name: &str| report.device.get(&format!("{name}_needed_cycles")).map(|f| count(Some(f)));
    named.map(|(name, figure)| Circuit { name, needed: needed(name), started: count(Some(figure)) }).collect()
}

/// Tables that a device tells as lists of one length, a figure per column: figures `TABLE_COLUMN`.
pub const LISTS: [(&str, &[&str]); 2] = [
    ("picture", &["frame", "round", "cycles", "ms", "psnr_db"]),
    ("layers", &["texture", "layer", "tiles", "loaded", "synthesized", "reused", "never_needed"]),
];

/// Columns of one of [`LISTS`] that the device has, in order: their names and figures.
pub fn columns<'a>(report: &'a Report, table: &str) -> Vec<(&'static str, &'a [Figure])> {
    let names = LISTS.iter().filter(|list| list.0 == table).flat_map(|list| list.1);
    let column = |name: &&'static str| match report.device.get(&format!("{table}_{name}"))? {
        Figure::List(list) => Some((*name, list.as_slice())),
        _ => None,
    };
    names.filter_map(column).collect()
}

/// A process of which a device counts runs and cycles: figures `NAME_runs` and `NAME_cycles`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Process<'a> {
    /// Name.
    pub name: &'a str,
    /// How often it ran.
    pub runs: u64,
    /// Cycles that all runs took.
    pub cycles: u64,
}

/// The processes of a device, in its order.
pub fn processes(report: &Report) -> Vec<Process<'_>> {
    let cycles = |name: &str| report.device.get(&format!("{name}_cycles"));
    let named = report.device.iter().filter_map(|(key, figure)| {
        let name = key.strip_suffix("_runs")?;
        cycles(name).map(|cycles| Process { name, runs: count(Some(figure)), cycles: count(Some(cycles)) })
    });
    named.collect()
}
