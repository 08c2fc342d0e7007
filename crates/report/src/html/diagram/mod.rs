//! The block diagram of the patent, filled with where the cycles went.

#[cfg(test)]
mod tests;

use super::markup::{Html, el, el_text, text};
use super::svg::{percent_of, px, rect, stacked_rects, svg_sized};
use super::units::{self, breakdown_parts};
use crate::model::Report;
use crate::text::sections::{in_frames, mean_occupancy};
use basrelief_machines::{BlockDiagram, CellSide, PlacedText, WireCell};

/// Width and height of a cell of the grid.
const CELL: (f64, f64) = (8.0, 26.0);
/// Scale of the drawing, which gives letters of 15 pixels.
const ENLARGED: f64 = 1.15;
/// Between a box and the edge of its row.
const MARGIN: f64 = 1.0;
/// Height of the filled strip at the bottom of a box, and of the gauge under a name.
const STRIP: f64 = 6.5;
const GAUGE: f64 = 4.0;
/// Position of the text's baseline in its row.
const BASELINE: f64 = 13.0;
const MIDDLE: f64 = 17.0;

/// The block diagram with its legend; empty without a diagram.
pub(super) fn block_diagram(report: &Report, diagram: &str) -> Html {
    if diagram.is_empty() {
        return Html::default();
    }
    let mut says = String::from("Numbers in brackets are the patent's reference numerals.");
    if report.cycles.is_some() {
        says += " The strip in a box shows the cycle breakdown of the unit. The bar under the name of a FIFO shows its mean occupancy. \
                 The strip in a memory, a box with double sides, shows its bus utilization. A unit that is drawn twice is \
                 filled once. A unit that this run does not use is dashed.";
    }
    if !bottleneck_resources(report).is_empty() {
        says += " A heavy frame marks the measured bottleneck.";
    }
    let legend = if report.cycles.is_some() { diagram_legend() } else { Html::default() };
    [el_text("p", "quiet", says), legend, draw(diagram, report)].into_iter().collect()
}

/// Resources that limit the run: those that are saturated together, or the one whose relaxation saves most.
fn bottleneck_resources(report: &Report) -> Vec<String> {
    let Some(of) = &report.bottlenecks else { return vec![] };
    let single = || of.single.first().map(|best| best.resource.clone()).into_iter().collect();
    of.balanced.as_ref().map_or_else(single, |balanced| balanced.relaxed.clone())
}

/// Class of a group of shapes, with a mark for a bottleneck. `group` is empty for a unit, and otherwise the group of the resource's
/// parameters with a point.
fn marked(class: &str, group: &str, name: &str, report: &Report) -> String {
    let is_bottleneck = bottleneck_resources(report).iter().any(|resource| resource.strip_prefix(group) == Some(name));
    if is_bottleneck { format!("{class} limit") } else { class.to_owned() }
}

fn diagram_legend() -> Html {
    let more = [("fifo", "occupied FIFO slots")];
    units::legend(units::STATES.into_iter().chain(more))
}

/// The drawing of a machine, with the figures of a run.
fn draw(diagram: &str, report: &Report) -> Html {
    let sheet = BlockDiagram::read(diagram);
    let (width, height) = (sheet.columns as f64 * CELL.0 + 2.0, sheet.rows as f64 * CELL.1);
    let says = format!("Block diagram of {}. The tables of units, FIFOs and memories list its numbers", report.machine);
    let notes = sheet.notes.iter().map(|note| fitted_text("note", note, note.column, MIDDLE - 1.0));
    let shapes = std::iter::once(wires(&sheet))
        .chain(notes)
        .chain(sheet.clients.iter().map(|port| client(port, report)))
        .chain(with_first_mark(&sheet.fifos).map(|(name, first)| wire_name(name, first, report)))
        .chain(with_first_mark(&sheet.units).map(|(unit, first)| unit_box(unit, first, report)))
        .chain(with_first_mark(&sheet.memories).map(|(memory, first)| memory_box(memory, first, report)));
    let drawing = svg_sized("blocks", (width, height), ENLARGED, &says, shapes.collect());
    el("div", &[("class", "wide"), ("role", "group"), ("tabindex", "0"), ("aria-label", "Block diagram")], [drawing])
}

/// Marks each text with true if it is the first at its place.
fn with_first_mark(list: &[PlacedText]) -> impl Iterator<Item = (&PlacedText, bool)> {
    list.iter().enumerate().map(|(at, placed)| (placed, !list[..at].iter().any(|before| before.name() == placed.name())))
}

fn column_x(column: usize) -> f64 {
    column as f64 * CELL.0 + 1.0
}

fn row_y(row: usize) -> f64 {
    row as f64 * CELL.1
}

/// A text in its cells, however wide the letters of a font are.
fn fitted_text(class: &str, placed: &PlacedText, column: usize, baseline: f64) -> Html {
    let content = placed.text.trim();
    let length = px((content.chars().count() as f64 * CELL.0 - 2.0).max(1.0));
    let (x, y) = (px(column_x(column) + 1.0), px(row_y(placed.row) + baseline));
    let attributes = [
        ("class", class),
        ("x", x.as_str()),
        ("y", y.as_str()),
        ("textLength", length.as_str()),
        ("lengthAdjust", "spacingAndGlyphs"),
    ];
    el("text", &attributes, [text(content)])
}

/// Column at which the text of a box begins, behind its bracket and blanks.
fn text_column(placed: &PlacedText) -> usize {
    placed.column + 1 + placed.text.chars().take_while(|c| *c == ' ').count()
}

fn box_outline(placed: &PlacedText) -> [f64; 4] {
    [column_x(placed.column), row_y(placed.row) + MARGIN, placed.width as f64 * CELL.0, CELL.1 - 2.0 * MARGIN]
}

/// The strip at the bottom of a box.
fn box_strip(placed: &PlacedText) -> [f64; 4] {
    let [x, y, width, height] = box_outline(placed);
    [x + 3.0, y + height - STRIP - 2.0, width - 6.0, STRIP]
}

fn titled_group(class: &str, says: &str, shapes: impl IntoIterator<Item = Html>) -> Html {
    let title = el_text("title", "", says);
    el("g", &[("class", class)], std::iter::once(title).chain(shapes))
}

/// A unit; one that this run is without is drawn faintly.
fn unit_box(placed: &PlacedText, first: bool, report: &Report) -> Html {
    let written = |baseline| fitted_text("name", placed, text_column(placed), baseline);
    let frame = rect("frame", box_outline(placed), "");
    let Some(unit) = report.units.as_ref().and_then(|units| units.get(placed.name())) else {
        let class = if report.units.is_some() { "unit absent" } else { "unit" };
        return titled_group(class, placed.text.trim(), [frame, written(MIDDLE)]);
    };
    if !first {
        return titled_group("unit again", placed.text.trim(), [frame, written(MIDDLE)]);
    }
    let (parts, whole) = breakdown_parts(report, unit);
    let parts_text: Vec<String> = parts.iter().map(|(_, what, n)| format!("{what} {}", percent_of(*n, whole))).collect();
    let says = format!("{}: {}", placed.text.trim(), parts_text.join(", "));
    let class = marked("unit", "", placed.name(), report);
    titled_group(&class, &says, [frame, stacked_rects(&parts, whole, box_strip(placed)), written(BASELINE)])
}

/// Width of the doubled side of a memory.
const SIDE: f64 = 4.0;

/// A memory, its strip filled as far as its bus was busy.
fn memory_box(placed: &PlacedText, first: bool, report: &Report) -> Html {
    let frame = rect("frame", box_outline(placed), "");
    let [x, y, width, height] = box_outline(placed);
    let sides = format!("M{} {}v{height}M{} {}v{height}", px(x + SIDE), px(y), px(x + width - SIDE), px(y));
    let sides = el("path", &[("class", "wire"), ("d", &sides)], []);
    let [x, y, width, height] = box_strip(placed);
    let strip = [x + SIDE, y, width - 2.0 * SIDE, height];
    let busy = report.derived.get(&format!("{}.bus_utilization", placed.name())).map(|d| d.value).filter(|_| first);
    let name = fitted_text("name", placed, text_column(placed), if busy.is_some() { BASELINE } else { MIDDLE });
    let used = busy.map(|busy| [rect("done", strip, ""), rect("busy", [strip[0], strip[1], strip[2] * busy, strip[3]], "")]);
    let share = busy.map_or(String::new(), |busy| format!(": bus busy {} % of the time", px(100.0 * busy)));
    let says = format!("memory {}{share}", placed.text.trim());
    let class = marked("memory-box", "memory.", placed.name(), report);
    titled_group(&class, &says, [frame, sides].into_iter().chain(used.into_iter().flatten()).chain([name]))
}

/// The clients between a unit and a memory, on a double line.
fn client(placed: &PlacedText, report: &Report) -> Html {
    let y = row_y(placed.row) + CELL.1 / 2.0;
    let (from, to) = (column_x(placed.column), column_x(placed.column + placed.width));
    let ends = [(from - CELL.0, from + 2.0 * CELL.0 - 1.0), (to - 2.0 * CELL.0 + 1.0, to + CELL.0)];
    let line = |(a, b): (f64, f64), y: f64| format!("M{} {}H{}", px(a), px(y), px(b));
    let path: String = ends.iter().flat_map(|&end| [line(end, y - 2.0), line(end, y + 2.0)]).collect();
    let moved = |name: &str| {
        let client = report.memories.iter().flatten().find_map(|(_, memory)| memory.clients.get(name))?;
        Some(format!("{name}: {} bytes moved", crate::number::thousands(client.moved_bytes)))
    };
    let parts_text: Vec<String> = placed.text.split(", ").filter_map(moved).collect();
    let lines = el("path", &[("class", "wire"), ("d", &path)], []);
    titled_group("port", &parts_text.join(", "), [lines, fitted_text("note", placed, placed.column + 2, MIDDLE - 1.0)])
}

/// The name of a FIFO, and under it how full it was in the mean.
fn wire_name(placed: &PlacedText, first: bool, report: &Report) -> Html {
    let Some(fifo) = report.fifos.as_ref().and_then(|fifos| fifos.get(placed.name())) else {
        return fitted_text("note", placed, placed.column, MIDDLE - 1.0);
    };
    let name = fitted_text("name", placed, placed.column, MIDDLE - 1.0);
    if !first {
        return titled_group("fifo-name again", &placed.text, [name]);
    }
    let depth = fifo.depth;
    let mean = mean_occupancy(&in_frames(fifo, report.drain()));
    let place =
        [column_x(placed.column) + 1.0, row_y(placed.row) + CELL.1 - GAUGE - 1.0, placed.width as f64 * CELL.0 - 2.0, GAUGE];
    let filled = (mean / depth.max(1) as f64).clamp(0.0, 1.0);
    let says = format!("FIFO {}: {mean:.1} of {depth} slots held in the mean", placed.text);
    let gauge = [rect("gauge", place, ""), rect("fifo", [place[0], place[1], place[2] * filled, GAUGE], "")];
    titled_group(&marked("fifo-name", "fifo.", placed.name(), report), &says, gauge.into_iter().chain([name]))
}

/// All lines, and the heads of the arrows.
fn wires(sheet: &BlockDiagram) -> Html {
    let lines: String = sheet.wires.iter().flat_map(|wire| wire.sides.iter().map(|side| wire_line(sheet, wire, *side))).collect();
    let heads: String = sheet.wires.iter().filter_map(|wire| Some(arrowhead(sheet, wire, wire.arrow?))).collect();
    let path = |class, d: &str| el("path", &[("class", class), ("d", d)], []);
    [path("wire", &lines), path("head", &heads)].into_iter().collect()
}

/// Draws a line from the middle of a cell to one of its sides, or to the box that begins there.
fn wire_line(sheet: &BlockDiagram, wire: &WireCell, side: CellSide) -> String {
    let (x, y) = wire_end(sheet, wire, side);
    format!("M{} {}L{} {}", px(column_x(wire.column) + CELL.0 / 2.0), px(row_y(wire.row) + CELL.1 / 2.0), px(x), px(y))
}

/// Returns the end of a wire that leaves its cell on this side.
fn wire_end(sheet: &BlockDiagram, wire: &WireCell, side: CellSide) -> (f64, f64) {
    let (down, right) = side.step();
    let boxed = |distance: isize| {
        let (row, column) = (wire.row.wrapping_add_signed(down * distance), wire.column.wrapping_add_signed(right * distance));
        sheet.units.iter().any(|b| b.row == row && (b.column..b.column + b.width).contains(&column))
    };
    // Horizontally, a blank separates a line from its box.
    let beyond = match () {
        () if down != 0 && boxed(1) => MARGIN,
        () if right != 0 && boxed(2) => CELL.0,
        () => 0.0,
    };
    let middle = (column_x(wire.column) + CELL.0 / 2.0, row_y(wire.row) + CELL.1 / 2.0);
    (middle.0 + right as f64 * (CELL.0 / 2.0 + beyond), middle.1 + down as f64 * (CELL.1 / 2.0 + beyond))
}

/// Length and half the width of an arrowhead.
const HEAD: (f64, f64) = (8.0, 4.0);

fn arrowhead(sheet: &BlockDiagram, wire: &WireCell, side: CellSide) -> String {
    let (x, y) = wire_end(sheet, wire, side);
    let (down, right) = (side.step().0 as f64, side.step().1 as f64);
    let corner = |way: f64| (x - HEAD.0 * right + way * HEAD.1 * down, y - HEAD.0 * down + way * HEAD.1 * right);
    let ((ax, ay), (bx, by)) = (corner(1.0), corner(-1.0));
    // The shaft, to its tip.
    let shaft = (column_x(wire.column) + CELL.0 / 2.0, row_y(wire.row) + CELL.1 / 2.0);
    let [sx, sy, x, y, ax, ay, bx, by] = [shaft.0, shaft.1, x, y, ax, ay, bx, by].map(px);
    format!("M{sx} {sy}L{x} {y}L{ax} {ay}L{bx} {by}L{x} {y}Z")
}
