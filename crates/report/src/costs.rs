//! What objects and polygons cost: cycles of units, at work and waiting, charged to what the step was for that ended them.

use crate::model::Report;
use crate::text::number::{percent, thousands};
use crate::text::{Align, Table};
use Align::{Left, Right};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most objects, and most polygons, that a report lists; the others stand in a sum.
pub const LISTED: usize = 100;
/// Most rows of either on a terminal.
const SHOWN: usize = 5;

/// Who the cycles of all units were for. `pixels` + `elsewhere` + `nobody` + `done` = `unit_cycles`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Costs {
    /// Units times cycles of the run.
    pub unit_cycles: u64,
    /// For pixels of the pictures.
    pub pixels: Spent,
    /// For polygons, objects and frames, and none of their pixels.
    pub elsewhere: Spent,
    /// For nobody: waits after a unit's last step.
    pub nobody: Spent,
    /// Cycles after a unit's last step in a complete run.
    pub done: u64,
    /// By frame, all that is for it.
    pub frames: Vec<Spent>,
    /// The most expensive objects, most first.
    pub objects: Vec<ObjectCost>,
    /// The most expensive polygons, most first.
    pub polygons: Vec<PolygonCost>,
    /// All other objects.
    pub other_objects: Others,
    /// All other polygons.
    pub other_polygons: Others,
}

/// Cycles of units. `busy` + `starved` + `memory` + `blocked` = `cycles`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Spent {
    /// All of them.
    pub cycles: u64,
    /// At work.
    pub busy: u64,
    /// Waiting for a token.
    pub starved: u64,
    /// Waiting for credits or answers of a memory.
    pub memory: u64,
    /// Waiting for a slot.
    pub blocked: u64,
}

/// An object, over all frames.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ObjectCost {
    /// Its number, from 0.
    pub object: u32,
    /// Its name, where it comes from a scene that has one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Polygons that were drawn of it.
    pub polygons: u64,
    /// Fragments of these, hidden ones among them.
    pub fragments: u64,
    /// All that was for it, its polygons among it.
    pub spent: Spent,
}

/// A polygon.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PolygonCost {
    /// Number of its frame, from 0.
    pub frame: u32,
    /// Number in its frame, from 0, in the order of the display list.
    pub polygon: u32,
    /// Number of its object; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// Its fragments, hidden ones among them.
    pub fragments: u64,
    /// The cycle in which the first step for it began.
    #[serde(default)]
    pub from: u64,
    /// The cycle after its last step.
    #[serde(default)]
    pub to: u64,
    /// All that was for it, its pixels among it.
    pub spent: Spent,
}

/// Those that are not listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Others {
    /// How many.
    pub count: u64,
    /// Their fragments.
    pub fragments: u64,
    /// What was for them.
    pub spent: Spent,
}

impl Spent {
    /// Its figures by name.
    pub(crate) fn fields(&self) -> [(&'static str, u64); 5] {
        let &Self { cycles, busy, starved, memory, blocked } = self;
        [("cycles", cycles), ("busy", busy), ("starved", starved), ("memory", memory), ("blocked", blocked)]
    }

    /// Cells of a table.
    fn cells(&self, all: u64) -> [String; 6] {
        let &Self { cycles, busy, starved, memory, blocked } = self;
        let [busy, starved, memory, blocked] = [busy, starved, memory, blocked].map(|n| percent(n, cycles));
        [thousands(cycles), percent(cycles, all), busy, starved, memory, blocked]
    }
}

/// Titles of [`Spent::cells`], each with the order in which it goes where the width does not hold all.
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

fn row(table: &mut Table, cells: impl IntoIterator<Item = String>, (spent, all): (&Spent, u64)) {
    table.row(cells.into_iter().chain(spent.cells(all)));
}

/// For whom the cycles were.
pub(crate) fn whom(report: &Report) -> Table {
    let mut whom = table(&[("Cycles of all units for", Left, 0)]);
    let Some(costs) = &report.costs else { return whom };
    let done = Spent { cycles: costs.done, ..Spent::default() };
    let rows = [
        ("pixels", &costs.pixels),
        ("polygons, objects, frames", &costs.elsewhere),
        ("nobody: waits at the end", &costs.nobody),
        ("nobody: done", &done),
    ];
    for (name, spent) in rows.into_iter().filter(|(_, spent)| spent.cycles > 0) {
        row(&mut whom, [name.to_owned()], (spent, costs.unit_cycles));
    }
    whom
}

/// The most expensive objects; `most` of them.
pub(crate) fn objects(report: &Report, most: usize) -> Table {
    let mut objects = table(&[("Object", Left, 0), ("name", Left, 2), ("polygons", Right, 0), ("fragments", Right, 0)]);
    let Some(costs) = &report.costs else { return objects };
    for o in costs.objects.iter().take(most) {
        let cells = [o.object.to_string(), o.name.clone(), thousands(o.polygons), thousands(o.fragments)];
        row(&mut objects, cells, (&o.spent, costs.unit_cycles));
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
        let cells = [p.polygon.to_string(), p.frame.to_string(), object, thousands(p.fragments), from, to];
        row(&mut polygons, cells, (&p.spent, costs.unit_cycles));
    }
    polygons
}

/// What a terminal shows of it.
pub(crate) fn tables(report: &Report) -> [Table; 3] {
    [whom(report), objects(report, SHOWN), polygons(report, SHOWN)]
}
