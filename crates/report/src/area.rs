//! Area of a machine by place, and operators that are too slow for the clock.

use crate::model::{Hardware, HardwareArea};
use basrelief_kernel::HardwareKind;
use indexmap::IndexMap;
use std::collections::BTreeSet;

/// Begin of the warning of a machine with ideal parts. The parts follow.
pub const NO_AREA: &str = "the area has no meaning";

/// Area of a unit, FIFO, cache or memory port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PlaceArea<'a> {
    pub(crate) place: &'a str,
    /// `unit`, `FIFO`, `cache` or `memory port`.
    pub(crate) kind: &'static str,
    pub(crate) area: HardwareArea,
}

/// Returns the area of each place, largest first. A unit and a FIFO with one name are two places.
pub(crate) fn by_place(all: &[Hardware]) -> Vec<PlaceArea<'_>> {
    let is_request_table = |piece: &&Hardware| piece.kind == HardwareKind::RequestTable;
    let ports: BTreeSet<&str> = all.iter().filter(is_request_table).map(|piece| &*piece.place).collect();
    let mut places: IndexMap<(&str, &str), PlaceArea<'_>> = IndexMap::new();
    for piece in all {
        let (place, kind) = (&*piece.place, kind_of_place(piece, ports.contains(&*piece.place)));
        let sum = places.entry((place, kind)).or_insert(PlaceArea { place, kind, area: HardwareArea::default() });
        sum.area = sum.area.and(piece.area);
    }
    let mut places: Vec<_> = places.into_values().collect();
    // The sort is stable.
    places.sort_by_key(|of| std::cmp::Reverse(of.area.area_ge));
    places
}

/// Returns the kind of place that a piece belongs to. Ports and units have line buffers; `of_port` is true if a port has the name of the
/// place.
fn kind_of_place(piece: &Hardware, of_port: bool) -> &'static str {
    match piece.kind {
        HardwareKind::Fifo => "FIFO",
        HardwareKind::CacheData | HardwareKind::CacheTags | HardwareKind::TagComparator => "cache",
        HardwareKind::RequestTable => "memory port",
        HardwareKind::LineBuffer if of_port => "memory port",
        _ => "unit",
    }
}

/// Returns a warning for each kind of operator that needs more time per cycle than the clock leaves: `cycle_fo4` delays of an
/// inverter that drives four.
pub fn depth_warnings(all: &[Hardware], cycle_fo4: f64) -> Vec<String> {
    let slow = all.iter().filter(|piece| piece.area.depth_fo4 as f64 > cycle_fo4);
    let warning = |piece: &Hardware| {
        format!(
            "{}: {} ({}) take {} FO4 per cycle, and a cycle has {:.0} (clock.hz, area.gate_length); raise their latency, compute fewer \
             bits per cycle, or lower the clock",
            piece.place, piece.kind, piece.about, piece.area.depth_fo4, cycle_fo4
        )
    };
    slow.map(warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::piece;

    #[test]
    fn places_are_listed_by_area_with_their_sums() {
        let mut all = vec![piece("a", HardwareKind::Adder, 1, 8), piece("b", HardwareKind::Table, 1, 8)];
        all.push(piece("a", HardwareKind::Table, 2, 8));
        for (piece, ge) in all.iter_mut().zip([10, 25, 20]) {
            piece.area.area_ge = ge;
        }
        let found: Vec<_> = by_place(&all).into_iter().map(|of| (of.place, of.area.area_ge)).collect();
        assert_eq!(found, [("a", 30), ("b", 25)]);
        assert_eq!(HardwareArea::sum(&all).area_ge, 55);
    }

    #[test]
    fn kind_of_a_place_follows_from_its_pieces() {
        use HardwareKind::{Adder, CacheData, CacheTags, Fifo, LineBuffer, RequestTable, Table};
        let kinds = |pieces: &[HardwareKind]| {
            let all: Vec<_> = pieces.iter().map(|kind| piece("a", *kind, 1, 8)).collect();
            by_place(&all).into_iter().map(|of| of.kind).collect::<Vec<_>>()
        };
        assert_eq!(kinds(&[Adder, Table, LineBuffer]), ["unit"]);
        assert_eq!(kinds(&[CacheData, CacheTags]), ["cache"]);
        assert_eq!(kinds(&[LineBuffer, RequestTable]), ["memory port"]);
        assert_eq!(kinds(&[Adder, Fifo]), ["unit", "FIFO"], "a unit and a FIFO with one name");
    }

    #[test]
    fn operator_slower_than_the_clock_is_a_warning() {
        let mut divider = piece("divider", HardwareKind::Divider, 2, 24);
        divider.area.depth_fo4 = 186;
        assert_eq!(depth_warnings(&[divider.clone()], 186.0), [""; 0]);
        let warnings = depth_warnings(&[divider], 83.3);
        assert!(
            warnings[0].starts_with("divider: dividers (what for) take 186 FO4 per cycle, and a cycle has 83 "),
            "{warnings:?}"
        );
    }
}
