//! The polygons of a run: numbers, and where they lie.

use super::{Origin, Polygon};
use basrelief_input::{Budget, Held, OverBudget};
use std::collections::BTreeMap;

/// What a place takes in the index \[bytes\].
const PLACE_BYTES: u64 = 2 * size_of::<(u64, Origin)>() as u64;

/// The polygons that have entered so far.
pub(super) struct Entered {
    /// Which of them lies at a place in the host's memory: the last that has entered there, since one that is under way keeps its place.
    at: BTreeMap<u64, Origin>,
    count: usize,
    /// Frame and number there of the last.
    last: Option<(u32, u32)>,
    held: Held,
}

impl Entered {
    pub(super) fn new(budget: &Budget) -> Self {
        Self { at: BTreeMap::new(), count: 0, last: None, held: budget.nothing() }
    }

    /// A polygon of this object enters.
    ///
    /// # Errors
    /// More than may be held.
    pub(super) fn enter(&mut self, place: u64, of: &Origin) -> Result<Origin, OverBudget> {
        let frame = of.frame.unwrap_or_default();
        let number = self.last.filter(|(last, _)| *last == frame).map_or(0, |(_, number)| number + 1);
        self.last = Some((frame, number));
        let polygon = Polygon { run: self.count, frame: number };
        self.count += 1;
        let origin = Origin { object: of.object, polygon: Some(polygon), ..Origin::whole(of.frame) };
        if self.at.insert(place, origin).is_none() {
            self.held.grow(PLACE_BYTES, "polygons under way")?;
        }
        Ok(origin)
    }

    /// Of the polygon that lies there now.
    pub(super) fn origin(&self, place: u64) -> Option<Origin> {
        self.at.get(&place).copied()
    }
}
