//! Tables of the hardware.

use super::style::TextStyle;
use super::table::{Align, Table};
use crate::model::{Hardware, Report};
use crate::number::thousands;
use Align::{Left, Right};
use basrelief_kernel::HardwareKind;

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

/// Everything, piece by piece.
pub fn hardware(all: &[Hardware], style: TextStyle) -> String {
    hardware_table(all).render(style)
}

/// A row for each piece.
pub(crate) fn hardware_table(all: &[Hardware]) -> Table {
    let columns =
        [("Where", Left, 0), ("", Left, 0), ("for", Left, 1), ("pieces", Right, 0), ("wide", Right, 0), ("bits", Right, 0)];
    let mut table = Table::new(&columns);
    let mut before = "";
    for h in all {
        let place = if h.place == before { String::new() } else { h.place.clone() };
        before = &h.place;
        let bits = if h.kind.computes() { String::new() } else { thousands(h.bits()) };
        table.row([place, h.kind.to_string(), h.about.clone(), thousands(h.count), h.width.to_string(), bits]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    fn piece(place: &str, kind: HardwareKind, count: u64, width: u32) -> Hardware {
        Hardware { place: place.into(), kind, about: "what for".into(), count, width }
    }

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
        let text = hardware(&report.hardware, TextStyle::default());
        assert!(text.contains("256    48  12,288"), "{text}");
    }
}
