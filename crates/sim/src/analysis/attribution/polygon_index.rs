//! Index of the polygons of a run by their addresses.

use super::origin::{PolygonNumbers, TokenOrigin};
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use std::collections::BTreeMap;

/// Size of an entry \[bytes\].
const ENTRY_BYTES: u64 = 2 * size_of::<(u64, TokenOrigin)>() as u64;

/// Polygons that have entered the machine.
pub(super) struct PolygonIndex {
    /// Polygon by its address in the host's memory: the last one that entered there, because a polygon in flight keeps its address.
    by_address: BTreeMap<u64, TokenOrigin>,
    count: usize,
    /// Frame of the last polygon, and its number within the frame.
    last: Option<(u32, u32)>,
    held: MemoryReservation,
}

impl PolygonIndex {
    pub(super) fn new(budget: &MemoryPool) -> Self {
        Self { by_address: BTreeMap::new(), count: 0, last: None, held: budget.empty_reservation() }
    }

    /// Adds a polygon of an object.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(super) fn enter(&mut self, address: u64, object: &TokenOrigin) -> Result<TokenOrigin, OverBudget> {
        let frame = object.frame.unwrap_or_default();
        let number = self.last.filter(|(last, _)| *last == frame).map_or(0, |(_, number)| number + 1);
        self.last = Some((frame, number));
        let polygon = PolygonNumbers { run: self.count, frame: number };
        self.count += 1;
        let origin = TokenOrigin { object: object.object, polygon: Some(polygon), ..TokenOrigin::whole(object.frame) };
        if self.by_address.insert(address, origin).is_none() {
            self.held.try_grow(ENTRY_BYTES, "polygons in flight")?;
        }
        Ok(origin)
    }

    /// Returns the polygon at an address.
    pub(super) fn origin(&self, address: u64) -> Option<TokenOrigin> {
        self.by_address.get(&address).copied()
    }
}
