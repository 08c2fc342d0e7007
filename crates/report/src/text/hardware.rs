//! Tables of the hardware.

use super::style::TextStyle;
use super::table::{Align, Table};
use crate::area::{PlaceArea, by_place, depth_warnings};
use crate::model::{Hardware, HardwareArea, Report};
use crate::number::thousands;
use Align::{Left, Right};
use basrelief_kernel::{HardwareKind, OperandFormat};

/// Totals by kind: number of operators, or bits of storage; and the unit that has most.
pub(crate) fn totals(report: &Report) -> Table {
    let mut table = Table::new(&[("Hardware", Left, 0), ("pieces", Right, 1), ("bits", Right, 0), ("most of it", Left, 2)]);
    for kind in HardwareKind::ALL {
        let of_kind: Vec<&Hardware> = report.hardware.iter().filter(|h| h.kind == kind).collect();
        let size = |h: &Hardware| if kind.computes() { h.count } else { h.bits() };
        let Some(most) = of_kind.iter().copied().rev().max_by_key(|h| size(h)) else { continue };
        let sum = |of: &dyn Fn(&Hardware) -> u64| thousands(of_kind.iter().fold(0, |sum, h| sum.saturating_add(of(h))));
        let [pieces, bits] = if kind.computes() { [sum(&|h| h.count), String::new()] } else { [String::new(), sum(&size)] };
        table.row([kind.to_string(), pieces, bits, most.place.clone()]);
    }
    table
}

/// Longest bar of a place \[characters\].
const BAR: u64 = 20;

/// Area by place, then everything piece by piece, then operators that are slower than a cycle of `cycle_fo4`.
pub fn hardware(all: &[Hardware], cycle_fo4: f64, style: TextStyle) -> String {
    let warnings = depth_warnings(all, cycle_fo4).into_iter().map(|warning| format!("\n\nWarning: {warning}"));
    let depth = HardwareArea::sum(all).depth_fo4;
    format!(
        "{}\n\n{}\n\nThe slowest operator takes {depth} FO4 per cycle; a cycle has {cycle_fo4:.0}.{}",
        places(all).render(style),
        hardware_table(all).render(style),
        warnings.collect::<String>()
    )
}

/// Area by unit, FIFO, cache and port, largest first, and the sum.
pub(crate) fn places(all: &[Hardware]) -> Table {
    let mut table = Table::new(&[
        ("Where", Left, 0),
        ("kind", Left, 0),
        ("area GE", Right, 0),
        ("%", Right, 0),
        ("", Left, 2),
        ("logic GE", Right, 1),
        ("register bits", Right, 1),
        ("memory bits", Right, 1),
    ]);
    let (sum, places) = (HardwareArea::sum(all), by_place(all));
    let most = places.first().map_or(0, |of| of.area.area_ge);
    for PlaceArea { place, kind, area } in places.into_iter().chain([PlaceArea { place: "total", kind: "", area: sum }]) {
        let bar = if place == "total" { 0 } else { (BAR * area.area_ge).checked_div(most).unwrap_or(0) };
        let percent = 100.0 * area.area_ge as f64 / sum.area_ge.max(1) as f64;
        let counts = [area.logic_ge, area.register_bits, area.memory_bits].map(thousands);
        let bar = "█".repeat(usize::try_from(bar).unwrap_or(0));
        let cells = [place.to_owned(), kind.to_owned(), thousands(area.area_ge), format!("{percent:.1}"), bar];
        table.row(cells.into_iter().chain(counts));
    }
    table
}

/// A row for each piece.
pub(crate) fn hardware_table(all: &[Hardware]) -> Table {
    let mut table = Table::new(&[
        ("Where", Left, 0),
        ("", Left, 0),
        ("for", Left, 1),
        ("pieces", Right, 0),
        ("wide", Right, 0),
        ("bits", Right, 1),
        ("ports", Right, 2),
        ("port bits", Right, 2),
        ("area GE", Right, 0),
    ]);
    let mut before = "";
    for h in all {
        let place = if h.place == before { String::new() } else { h.place.clone() };
        before = &h.place;
        let bits = if h.kind.computes() { String::new() } else { thousands(h.bits()) };
        let ports = h.ports.map_or_else(String::new, |ports| ports.to_string());
        let port_bits = h.port_bits.map_or_else(String::new, thousands);
        let kind = h.kind.to_string();
        let about = h.about.clone();
        table.row([place, kind, about, thousands(h.count), width(h), bits, ports, port_bits, thousands(h.area.area_ge)]);
    }
    table
}

/// Width of a word, or widths of the operands and their format.
fn width(piece: &Hardware) -> String {
    match (piece.by, piece.format) {
        (_, Some(OperandFormat::Single)) => format!("{} float", piece.width),
        (Some(by), _) if by != piece.width => format!("{} x {by}", piece.width),
        _ => piece.width.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{self, piece};

    #[test]
    fn operators_are_counted_and_bits_added_up() {
        let mut report = samples::balanced();
        report.hardware = vec![
            piece("search", HardwareKind::Multiplier, 12, 16),
            piece("search", HardwareKind::Table, 256, 48),
            piece("filter", HardwareKind::Multiplier, 32, 8),
            piece("wire", HardwareKind::Fifo, 4, 100),
        ];
        let text = totals(&report).render(TextStyle::default());
        let lines: Vec<Vec<&str>> = text.lines().skip(2).map(|l| l.split_whitespace().collect()).collect();
        assert_eq!(
            lines,
            [vec!["multipliers", "44", "filter"], vec!["tables", "12,288", "search"], vec!["FIFOs", "400", "wire"]]
        );
        report.hardware[1].area.area_ge = 30_000;
        report.hardware[3].area.area_ge = 10_000;
        let text = hardware(&report.hardware, 83.0, TextStyle { width: 200, color: false });
        assert!(text.contains("256    48  12,288"), "{text}");
        let has = |line: &str| assert!(text.lines().any(|l| l.split_whitespace().eq(line.split(' '))), "{line}: {text}");
        has("search unit 30,000 75.0 ████████████████████ 0 0 0");
        has("wire FIFO 10,000 25.0 ██████ 0 0 0");
        has("total 40,000 100.0 0 0 0");
    }
}
