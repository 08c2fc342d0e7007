//! Work, routes, circuits, processes and tables of a machine, grouped by the legend of its figures.

use crate::model::{Figure, FigureGroup, Legend, Report};

/// The figures of a machine that belong to a group: name, value, unit of measure, group.
fn grouped_figures(report: &Report) -> impl Iterator<Item = (&str, &Figure, &str, &FigureGroup)> {
    report.figures.iter().filter_map(|(name, figure)| {
        let Legend { unit, part, .. } = report.legend.get(name)?;
        Some((name.as_str(), figure, unit.as_str(), part.as_ref()?))
    })
}

fn count(figure: &Figure) -> u64 {
    if let Figure::Count(n) = figure { *n } else { 0 }
}

/// Returns the entry of this name, and creates it if it is missing.
fn entry<T>(list: &mut Vec<T>, is: impl Fn(&T) -> bool, new: impl FnOnce() -> T) -> &mut T {
    let at = list.iter().position(is).unwrap_or(list.len());
    if at == list.len() {
        list.push(new());
    }
    &mut list[at]
}

/// Divisor of cycles and bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkCount {
    /// One of them: `fragment` or `dot`.
    pub one: String,
    /// Number of items.
    pub count: u64,
    /// Formula of the number, in names of the report.
    pub formula: String,
}

/// Returns the work of a machine; 0 fragments if the machine has no figure of work.
pub fn work(report: &Report) -> WorkCount {
    let named = grouped_figures(report).find(|(.., part)| **part == FigureGroup::Work);
    let (name, count, unit) = named.map_or(("fragments", 0, "fragments"), |(name, figure, unit, _)| (name, count(figure), unit));
    WorkCount { one: unit.strip_suffix('s').unwrap_or(unit).into(), count, formula: format!("figures.{name}") }
}

/// A way through a machine on which it counts polygons and dots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Route<'a> {
    /// Name.
    pub name: &'a str,
    /// Polygons that took it.
    pub polygons: u64,
    /// Their dots.
    pub dots: u64,
}

/// Returns the routes of a machine in its order; empty if it has only one.
pub fn routes(report: &Report) -> Vec<Route<'_>> {
    let mut routes = vec![];
    for (_, figure, unit, part) in grouped_figures(report) {
        let FigureGroup::Route(name) = part else { continue };
        let route = entry(&mut routes, |r: &Route<'_>| r.name == name, || Route { name, polygons: 0, dots: 0 });
        *(if unit == "polygons" { &mut route.polygons } else { &mut route.dots }) = count(figure);
    }
    routes
}

/// A circuit of which a machine counts the cycles in which it was started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Circuit<'a> {
    /// Name.
    pub name: &'a str,
    /// Cycles whose result the picture needs, if the machine counts them.
    pub needed: Option<u64>,
    /// Cycles of work.
    pub started: u64,
    /// Figure of the machine that says so.
    pub figure: &'a str,
}

/// The circuits of a machine, in its order.
pub fn circuits(report: &Report) -> Vec<Circuit<'_>> {
    let mut circuits = vec![];
    for (figure, started, _, part) in grouped_figures(report) {
        let FigureGroup::Started(name) = part else { continue };
        let of_it = |other: &FigureGroup| matches!(other, FigureGroup::Needed(other) if other == name);
        let needed = grouped_figures(report).find(|(.., part)| of_it(part)).map(|(_, figure, ..)| count(figure));
        circuits.push(Circuit { name, needed, started: count(started), figure });
    }
    circuits
}

/// A process of which a machine counts runs and cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Process<'a> {
    /// Name.
    pub name: &'a str,
    /// Number of executions.
    pub runs: u64,
    /// Cycles that all runs took.
    pub cycles: u64,
}

/// The processes of a machine, in its order.
pub fn processes(report: &Report) -> Vec<Process<'_>> {
    let mut processes = vec![];
    for (_, figure, unit, part) in grouped_figures(report) {
        let FigureGroup::Process(name) = part else { continue };
        let process = entry(&mut processes, |p: &Process<'_>| p.name == name, || Process { name, runs: 0, cycles: 0 });
        *(if unit == "runs" { &mut process.runs } else { &mut process.cycles }) = count(figure);
    }
    processes
}

/// A table of a machine: titles and values of its columns.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnTable<'a> {
    /// Name.
    pub name: &'a str,
    /// In order.
    pub columns: Vec<(&'a str, &'a [Figure])>,
}

/// The tables of a machine, in its order.
pub fn tables(report: &Report) -> Vec<ColumnTable<'_>> {
    let mut tables = vec![];
    for (_, figure, _, part) in grouped_figures(report) {
        let (FigureGroup::Column { table, title }, Figure::List(list)) = (part, figure) else { continue };
        let table = entry(&mut tables, |t: &ColumnTable<'_>| t.name == table, || ColumnTable { name: table, columns: vec![] });
        table.columns.push((title, list));
    }
    tables
}
