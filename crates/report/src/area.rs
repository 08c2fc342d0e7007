//! Area of a machine by place, and operators that are too slow for the clock.

use crate::model::{Hardware, HardwareArea};
use indexmap::IndexMap;

/// Returns the area of each unit, FIFO, cache and port, largest first.
pub(crate) fn by_place(all: &[Hardware]) -> Vec<(&str, HardwareArea)> {
    let mut places: IndexMap<&str, HardwareArea> = IndexMap::new();
    for piece in all {
        let sum = places.entry(&piece.place).or_default();
        *sum = sum.and(piece.area);
    }
    let mut places: Vec<_> = places.into_iter().collect();
    // The sort is stable.
    places.sort_by_key(|(_, area)| std::cmp::Reverse(area.area_ge));
    places
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
    use basrelief_kernel::HardwareKind;

    #[test]
    fn places_are_listed_by_area_with_their_sums() {
        let mut all = vec![piece("a", HardwareKind::Adder, 1, 8), piece("b", HardwareKind::Table, 1, 8)];
        all.push(piece("a", HardwareKind::Table, 2, 8));
        for (piece, ge) in all.iter_mut().zip([10, 25, 20]) {
            piece.area.area_ge = ge;
        }
        let found: Vec<_> = by_place(&all).into_iter().map(|(place, area)| (place, area.area_ge)).collect();
        assert_eq!(found, [("a", 30), ("b", 25)]);
        assert_eq!(HardwareArea::sum(&all).area_ge, 55);
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
