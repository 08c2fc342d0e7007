//! The polygons of a run, and what each has cost.

use super::Spent;
use super::origin::Origin;
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
}

/// What a polygon takes, and its place in the index \[bytes\].
const POLYGON_BYTES: u64 = 2 * size_of::<PolygonCost>() as u64;

/// The polygons so far, and what is for none of them.
#[derive(Default)]
pub(super) struct Polygons {
    pub(super) list: Vec<PolygonCost>,
    /// Which of them lies at a place in the host's memory: the last that has entered there, since one that is under way keeps its place.
    at: BTreeMap<u64, usize>,
    /// For an object of a frame, and none of its polygons.
    pub(super) objects: BTreeMap<(u32, u32), Spent>,
    /// For a frame, and none of its objects.
    pub(super) frames: BTreeMap<u32, Spent>,
    /// For no frame.
    unframed: Spent,
}

impl Polygons {
    /// A polygon of this object enters.
    ///
    /// # Errors
    /// More than may be held.
    pub(super) fn enter(&mut self, place: u64, of: &Origin, held: &mut Held) -> Result<Origin, OverBudget> {
        held.grow(POLYGON_BYTES, "costs of polygons")?;
        let frame = of.frame.unwrap_or_default();
        let number = self.list.last().filter(|last| last.frame == frame).map_or(0, |last| last.number + 1);
        self.list.push(PolygonCost { frame, number, object: of.object, ..PolygonCost::default() });
        let polygon = self.list.len() - 1;
        self.at.insert(place, polygon);
        Ok(Origin { object: of.object, polygon: Some(polygon), ..Origin::whole(of.frame) })
    }

    /// Of the polygon that lies there now.
    pub(super) fn origin(&self, place: u64) -> Option<Origin> {
        let &polygon = self.at.get(&place)?;
        let PolygonCost { frame, object, .. } = self.list[polygon];
        Some(Origin { object, polygon: Some(polygon), ..Origin::whole(Some(frame)) })
    }

    pub(super) fn draw(&mut self, origin: &Origin) {
        let fragments = origin.pixels.map_or(0, |pixels| pixels.count() as u64);
        if let Some(polygon) = origin.polygon.and_then(|n| self.list.get_mut(n)) {
            polygon.fragments += fragments;
        }
    }

    /// Where cycles are charged that are for this.
    pub(super) fn spent(&mut self, origin: &Origin) -> &mut Spent {
        match *origin {
            Origin { polygon: Some(polygon), .. } => &mut self.list[polygon].spent,
            Origin { frame: Some(frame), object: Some(object), .. } => self.objects.entry((frame, object)).or_default(),
            Origin { frame: Some(frame), .. } => self.frames.entry(frame).or_default(),
            Origin { .. } => &mut self.unframed,
        }
    }
}
