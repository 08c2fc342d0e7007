//! Costs of polygons.

use super::cycle_breakdown::CycleBreakdown;
use crate::analysis::attribution::{PolygonNumbers, TokenOrigin};
use basrelief_input::{MemoryReservation, OverBudget};
use std::collections::BTreeMap;

/// Costs of a polygon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PolygonCost {
    /// Frame number.
    pub frame: u32,
    /// Number within the frame, from 0.
    pub number: u32,
    /// Object number, if known.
    pub object: Option<u32>,
    /// Number of fragments, including hidden ones.
    pub fragments: u64,
    /// Unit cycles, including those for its pixels.
    pub spent: CycleBreakdown,
    /// First cycle of its first step, and the cycle after its last step.
    pub life: [u64; 2],
}

/// Costs of polygons so far, and costs without a polygon.
#[derive(Default)]
pub(super) struct PolygonCosts {
    pub(super) list: Vec<PolygonCost>,
    /// Costs by frame and object, without polygons.
    pub(super) objects: BTreeMap<(u32, u32), CycleBreakdown>,
    /// Costs by frame, without objects.
    pub(super) frames: BTreeMap<u32, CycleBreakdown>,
    /// Costs without a frame.
    unframed: CycleBreakdown,
}

impl PolygonCosts {
    /// Adds a polygon.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(super) fn enter(&mut self, origin: &TokenOrigin, held: &mut MemoryReservation) -> Result<(), OverBudget> {
        let TokenOrigin { frame, object, polygon: Some(PolygonNumbers { frame: number, .. }), .. } = *origin else {
            return Ok(());
        };
        held.make_room(&mut self.list, 1, "costs of polygons")?;
        self.list.push(PolygonCost { frame: frame.unwrap_or_default(), number, object, ..PolygonCost::default() });
        Ok(())
    }

    pub(super) fn draw(&mut self, origin: &TokenOrigin) {
        let fragments = origin.pixels.map_or(0, |pixels| pixels.count() as u64);
        if let Some(polygon) = origin.polygon.and_then(|polygon| self.list.get_mut(polygon.run)) {
            polygon.fragments += fragments;
        }
    }

    /// Extends the life of a polygon by a step. An end of 0 means that there was no step yet, because a step takes at least one cycle.
    pub(super) fn extend_lifetime(&mut self, origin: &TokenOrigin, from: u64, to: u64) {
        if let Some(polygon) = origin.polygon.and_then(|polygon| self.list.get_mut(polygon.run)) {
            let [first, last] = polygon.life;
            polygon.life = [if last == 0 { from } else { first.min(from) }, last.max(to)];
        }
    }

    /// Returns the breakdown that cycles of this origin are charged to.
    pub(super) fn breakdown_of(&mut self, origin: &TokenOrigin) -> &mut CycleBreakdown {
        match *origin {
            TokenOrigin { polygon: Some(polygon), .. } => &mut self.list[polygon.run].spent,
            TokenOrigin { frame: Some(frame), object: Some(object), .. } => self.objects.entry((frame, object)).or_default(),
            TokenOrigin { frame: Some(frame), .. } => self.frames.entry(frame).or_default(),
            TokenOrigin { .. } => &mut self.unframed,
        }
    }
}
