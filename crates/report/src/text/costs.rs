//! Tables of the cycles per object and polygon.

use super::table::{Align, Table};
use crate::model::{CycleBreakdown, Report};
use crate::number::{percent, thousands};
use Align::{Left, Right};

/// Maximum number of rows of each table on a terminal.
const SHOWN: usize = 5;

/// Cells of a row.
fn breakdown_cells(spent: &CycleBreakdown, all: u64) -> [String; 6] {
    let &CycleBreakdown { cycles, busy, starved, memory, blocked } = spent;
    let [busy, starved, memory, blocked] = [busy, starved, memory, blocked].map(|n| percent(n, cycles));
    [thousands(cycles), percent(cycles, all), busy, starved, memory, blocked]
}

/// Titles of [`cells`]. The number is the order in which a narrow terminal drops columns.
const SPENT: [(&str, Align, u8); 6] = [
    ("unit-cycles", Right, 0),
    ("%", Right, 0),
    ("busy %", Right, 1),
    ("starved %", Right, 1),
    ("memory %", Right, 1),
    ("blocked %", Right, 1),
];

fn table(titles: &[(&'static str, Align, u8)]) -> Table {
    let columns: Vec<_> = titles.iter().copied().chain(SPENT).collect();
    Table::new(&columns)
}

fn add_row(table: &mut Table, cells: impl IntoIterator<Item = String>, spent: &CycleBreakdown, all: u64) {
    table.row(cells.into_iter().chain(self::breakdown_cells(spent, all)));
}

/// Cycles per object and polygon.
pub(crate) fn attribution(report: &Report) -> Table {
    let mut table = table(&[("Cycles spent on", Left, 0)]);
    let Some(costs) = &report.costs else { return table };
    let done = CycleBreakdown { cycles: costs.done, ..CycleBreakdown::default() };
    let rows = [
        ("pixels", &costs.pixels),
        ("polygons, objects, frames", &costs.non_pixel),
        ("unattributed: stalls at the end", &costs.unattributed),
        ("idle after the last step", &done),
    ];
    for (name, spent) in rows.into_iter().filter(|(_, spent)| spent.cycles > 0) {
        add_row(&mut table, [name.to_owned()], spent, costs.unit_cycles);
    }
    table
}

/// The most expensive objects; `most` of them.
pub(crate) fn objects(report: &Report, most: usize) -> Table {
    let mut objects = table(&[("Object", Left, 0), ("name", Left, 2), ("polygons", Right, 0), ("fragments", Right, 0)]);
    let Some(costs) = &report.costs else { return objects };
    for o in costs.objects.iter().take(most) {
        let cells = [o.object.to_string(), o.name.clone(), thousands(o.polygons), thousands(o.fragments)];
        add_row(&mut objects, cells, &o.breakdown, costs.unit_cycles);
    }
    objects
}

/// The most expensive polygons; `most` of them.
pub(crate) fn polygons(report: &Report, most: usize) -> Table {
    let mut polygons = table(&[
        ("Polygon", Left, 0),
        ("frame", Right, 0),
        ("object", Right, 0),
        ("fragments", Right, 0),
        ("from cycle", Right, 2),
        ("to cycle", Right, 2),
    ]);
    let Some(costs) = &report.costs else { return polygons };
    for p in costs.polygons.iter().take(most) {
        let object = p.object.map_or(String::new(), |object| object.to_string());
        let [from, to] = [p.from, p.to].map(thousands);
        let cells = [p.polygon.to_string(), (p.frame + 1).to_string(), object, thousands(p.fragments), from, to];
        add_row(&mut polygons, cells, &p.breakdown, costs.unit_cycles);
    }
    polygons
}

/// Tables for the terminal.
pub(crate) fn tables(report: &Report) -> [Table; 3] {
    [attribution(report), objects(report, SHOWN), polygons(report, SHOWN)]
}
