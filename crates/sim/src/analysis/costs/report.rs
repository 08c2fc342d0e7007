//! Costs for the report.

use super::accumulator::ActivityCost;
use super::cycle_breakdown::CycleBreakdown;
use super::run_costs::RunCosts;
use super::step_polygons::by_polygon;
use basrelief_report::costs::{self as model, LISTED, ObjectCost, UnlistedCosts};
use basrelief_report::model::PathPolygons;
use std::cmp::Reverse;
use std::collections::BTreeMap;

impl From<CycleBreakdown> for model::CycleBreakdown {
    fn from(spent: CycleBreakdown) -> Self {
        let CycleBreakdown { busy, starved, memory, blocked } = spent;
        Self { cycles: spent.total(), busy, starved, memory, blocked }
    }
}

impl RunCosts {
    /// Returns the costs for the report, with these names of objects.
    pub fn report(&self, names: &BTreeMap<u32, String>) -> model::Costs {
        let (objects, other_objects) = split_listed(self.objects(names), |o| (o.fragments, o.breakdown));
        let polygons = self.polygons.iter().map(|p| model::PolygonCost {
            frame: p.frame,
            polygon: p.number,
            object: p.object,
            fragments: p.fragments,
            from: p.life[0],
            to: p.life[1],
            breakdown: p.spent.into(),
        });
        let (polygons, other_polygons) = split_listed(polygons.collect(), |p| (p.fragments, p.breakdown));
        model::Costs {
            unit_cycles: self.cycles * self.units.len() as u64,
            pixels: self.sum_over_units(|activity| activity.on_pixels),
            non_pixel: self.sum_over_units(|activity| activity.non_pixel),
            unattributed: self.sum_over_units(|activity| activity.unattributed),
            done: self.units.iter().map(|unit| unit.done).sum(),
            frames: self.frame_costs().into_iter().map(Into::into).collect(),
            objects,
            polygons,
            other_objects,
            other_polygons,
        }
    }

    /// Breaks the cycles of a critical path down by polygon. `cycles` contains numbers of polygons in the run with their cycles.
    pub(crate) fn path(&self, cycles: &[(u32, u64)]) -> PathPolygons {
        by_polygon(&self.polygons, cycles)
    }

    /// Sums the cycles that `of` returns, over all units.
    fn sum_over_units(&self, of: fn(&ActivityCost) -> u64) -> model::CycleBreakdown {
        let mut sum = CycleBreakdown::default();
        self.units.iter().flat_map(|unit| &unit.activities).for_each(|activity| sum.charge(activity.kind, of(activity)));
        sum.into()
    }

    /// Returns the cycles of each frame.
    fn frame_costs(&self) -> Vec<CycleBreakdown> {
        let mut frames = vec![CycleBreakdown::default(); self.frames as usize];
        let polygons = self.polygons.iter().map(|p| (p.frame, p.spent));
        let objects = self.objects.iter().map(|(&(frame, _), &spent)| (frame, spent));
        for (frame, spent) in polygons.chain(objects).chain(self.whole_frames.iter().map(|(&frame, &spent)| (frame, spent))) {
            if let Some(sum) = frames.get_mut(frame as usize) {
                *sum += spent;
            }
        }
        frames
    }

    /// Returns the costs of each object.
    fn objects(&self, names: &BTreeMap<u32, String>) -> Vec<ObjectCost> {
        let mut objects: BTreeMap<u32, (u64, u64, CycleBreakdown)> = BTreeMap::new();
        for polygon in &self.polygons {
            let Some(object) = polygon.object else { continue };
            let (polygons, fragments, spent) = objects.entry(object).or_default();
            *polygons += 1;
            *fragments += polygon.fragments;
            *spent += polygon.spent;
        }
        for (&(_, object), &own) in &self.objects {
            objects.entry(object).or_default().2 += own;
        }
        let object = |(object, (polygons, fragments, spent)): (u32, (u64, u64, CycleBreakdown))| {
            let name = names.get(&object).cloned().unwrap_or_default();
            ObjectCost { object, name, polygons, fragments, breakdown: spent.into() }
        };
        objects.into_iter().map(object).collect()
    }
}

/// Returns the most expensive elements, in descending order, and the sum of the others. Ties keep their order.
fn split_listed<T>(mut all: Vec<T>, of: fn(&T) -> (u64, model::CycleBreakdown)) -> (Vec<T>, UnlistedCosts) {
    all.sort_by_key(|one| Reverse(of(one).1.cycles));
    let mut others = UnlistedCosts::default();
    for (fragments, spent) in all.split_off(all.len().min(LISTED)).iter().map(of) {
        let UnlistedCosts { count, fragments: sum, breakdown: all } = &mut others;
        (*count, *sum) = (*count + 1, *sum + fragments);
        all.cycles += spent.cycles;
        all.busy += spent.busy;
        all.starved += spent.starved;
        all.memory += spent.memory;
        all.blocked += spent.blocked;
    }
    (all, others)
}
