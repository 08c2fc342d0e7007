//! The polygons of a run, and what each has cost.

use super::Spent;
use crate::flow::{Origin, Polygon};
use basrelief_input::{Held, OverBudget};
use std::collections::BTreeMap;

/// A polygon of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PolygonCost {
    /// Number of its frame.
    pub frame: u32,
    /// Number in its frame, from 0.
    pub number: u32,
    /// Number of its object, where it has one.
    pub object: Option<u32>,
    /// Fragments that it was drawn as, hidden ones among them.
    pub fragments: u64,
    /// Cycles of units, those for its pixels among them.
    pub spent: Spent,
    /// The cycle in which the first step for it began, and the one after its last.
    pub life: [u64; 2],
}

/// The polygons so far, and what is for none of them.
#[derive(Default)]
pub(super) struct Polygons {
    pub(super) list: Vec<PolygonCost>,
    /// For an object of a frame, and none of its polygons.
    pub(super) objects: BTreeMap<(u32, u32), Spent>,
    /// For a frame, and none of its objects.
    pub(super) frames: BTreeMap<u32, Spent>,
    /// For no frame.
    unframed: Spent,
}

impl Polygons {
    /// A polygon enters.
    ///
    /// # Errors
    /// More than may be held.
    pub(super) fn enter(&mut self, origin: &Origin, held: &mut Held) -> Result<(), OverBudget> {
        let Origin { frame, object, polygon: Some(Polygon { frame: number, .. }), .. } = *origin else { return Ok(()) };
        held.room(&mut self.list, 1, "costs of polygons")?;
        self.list.push(PolygonCost { frame: frame.unwrap_or_default(), number, object, ..PolygonCost::default() });
        Ok(())
    }

    pub(super) fn draw(&mut self, origin: &Origin) {
        let fragments = origin.pixels.map_or(0, |pixels| pixels.count() as u64);
        if let Some(polygon) = origin.polygon.and_then(|polygon| self.list.get_mut(polygon.run)) {
            polygon.fragments += fragments;
        }
    }

    /// A step was for this, in these cycles. (A step takes a cycle at least: where its end is 0, there was none yet.)
    pub(super) fn live(&mut self, origin: &Origin, from: u64, to: u64) {
        if let Some(polygon) = origin.polygon.and_then(|polygon| self.list.get_mut(polygon.run)) {
            let [first, last] = polygon.life;
            polygon.life = [if last == 0 { from } else { first.min(from) }, last.max(to)];
        }
    }

    /// Where cycles are charged that are for this.
    pub(super) fn spent(&mut self, origin: &Origin) -> &mut Spent {
        match *origin {
            Origin { polygon: Some(polygon), .. } => &mut self.list[polygon.run].spent,
            Origin { frame: Some(frame), object: Some(object), .. } => self.objects.entry((frame, object)).or_default(),
            Origin { frame: Some(frame), .. } => self.frames.entry(frame).or_default(),
            Origin { .. } => &mut self.unframed,
        }
    }
}
