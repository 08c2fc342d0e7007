//! Polygon of each step, so that the critical path can be broken down by polygon.

use super::polygons::PolygonCost;
use crate::analysis::attribution::TokenOrigin;
use crate::analysis::resimulations::MOST_STEPS;
use basrelief_input::{MemoryReservation, OverBudget};
use basrelief_kernel::StageGroups;
use basrelief_report::costs::LISTED;
use basrelief_report::model::{PathPolygon, PathPolygons};
use std::cmp::Reverse;

/// Memory for consecutive steps of one polygon \[bytes\].
const RUN_BYTES: u64 = 8;

/// Polygons of all steps so far, by stage; empty if there are too many steps for a critical path.
pub(crate) struct StepPolygons {
    pub(crate) stages: Vec<StageGroups>,
    steps: usize,
    held: MemoryReservation,
}

impl StepPolygons {
    pub(crate) fn new(stages: usize, held: MemoryReservation) -> Self {
        Self { stages: vec![StageGroups::default(); stages], steps: 0, held }
    }

    /// Adds the next step of a stage.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(super) fn step(&mut self, stage: usize, origin: &TokenOrigin) -> Result<(), OverBudget> {
        let Some(groups) = self.stages.get_mut(stage) else { return Ok(()) };
        let group = origin.polygon.and_then(|polygon| u32::try_from(polygon.run).ok()).unwrap_or(StageGroups::NONE);
        if groups.push(group) {
            self.held.try_grow(RUN_BYTES, "polygons of steps, for the critical path")?;
        }
        self.steps += 1;
        if self.steps > MOST_STEPS {
            self.stages = vec![];
            self.held.shrink_to(0);
        }
        Ok(())
    }
}

/// Breaks the cycles of a critical path down by polygon. `cycles` contains numbers of polygons in the run with their cycles.
pub(super) fn by_polygon(polygons: &[PolygonCost], cycles: &[(u32, u64)]) -> PathPolygons {
    let mut path = PathPolygons::default();
    for &(group, cycles) in cycles {
        match polygons.get(group as usize) {
            Some(p) => path.listed.push(PathPolygon { frame: p.frame, polygon: p.number, object: p.object, cycles }),
            None => path.elsewhere += cycles,
        }
    }
    // The sort is stable: ties keep their order.
    path.listed.sort_by_key(|polygon| Reverse(polygon.cycles));
    path.others = path.listed.split_off(path.listed.len().min(LISTED)).iter().map(|polygon| polygon.cycles).sum();
    path
}
