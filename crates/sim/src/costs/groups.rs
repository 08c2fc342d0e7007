//! For which polygon each step of each unit is, so that a critical path can be told by polygon.

use super::PolygonCost;
use crate::flow::Origin;
use crate::limits::EVENTS;
use basrelief_input::{Held, OverBudget};
use basrelief_kernel::StageGroups;
use basrelief_report::costs::LISTED;
use basrelief_report::model::{PathPolygon, PathPolygons};
use std::cmp::Reverse;

/// What a run of steps of one polygon takes \[bytes\].
const RUN_BYTES: u64 = 8;

/// The polygons of all steps so far, by stage; none once there are more steps than a path is looked for in.
pub(crate) struct StepGroups {
    pub(crate) stages: Vec<StageGroups>,
    steps: usize,
    held: Held,
}

impl StepGroups {
    pub(crate) fn new(stages: usize, held: Held) -> Self {
        Self { stages: vec![StageGroups::default(); stages], steps: 0, held }
    }

    /// The next step of a stage is for this.
    ///
    /// # Errors
    /// More than may be held.
    pub(super) fn step(&mut self, stage: usize, origin: &Origin) -> Result<(), OverBudget> {
        let Some(groups) = self.stages.get_mut(stage) else { return Ok(()) };
        let group = origin.polygon.and_then(|polygon| u32::try_from(polygon.run).ok()).unwrap_or(StageGroups::NONE);
        if groups.push(group) {
            self.held.grow(RUN_BYTES, "polygons of steps, for the critical path")?;
        }
        self.steps += 1;
        if self.steps > EVENTS {
            self.stages = vec![];
            self.held.shrink_to(0);
        }
        Ok(())
    }
}

/// A critical path by polygon, of which these are the cycles of each by its number in the run.
pub(super) fn by_polygon(polygons: &[PolygonCost], cycles: &[(u32, u64)]) -> PathPolygons {
    let mut told = PathPolygons::default();
    for &(group, cycles) in cycles {
        match polygons.get(group as usize) {
            Some(p) => told.listed.push(PathPolygon { frame: p.frame, polygon: p.number, object: p.object, cycles }),
            None => told.elsewhere += cycles,
        }
    }
    // Stable: of equals the first stays first.
    told.listed.sort_by_key(|polygon| Reverse(polygon.cycles));
    told.others = told.listed.split_off(told.listed.len().min(LISTED)).iter().map(|polygon| polygon.cycles).sum();
    told
}
