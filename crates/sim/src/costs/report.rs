//! Costs as a report tells them.

use super::groups::by_polygon;
use super::ledger::WayCost;
use super::{Costs, Spent};
use basrelief_report::costs::{self as told, LISTED, ObjectCost, Others};
use basrelief_report::model::PathPolygons;
use std::cmp::Reverse;
use std::collections::BTreeMap;

impl From<Spent> for told::Spent {
    fn from(spent: Spent) -> Self {
        let Spent { busy, starved, memory, blocked } = spent;
        Self { cycles: spent.total(), busy, starved, memory, blocked }
    }
}

impl Costs {
    /// As a report tells them, with these names of objects.
    pub fn report(&self, names: &BTreeMap<u32, String>) -> told::Costs {
        let (objects, other_objects) = listed(self.objects(names), |o| (o.fragments, o.spent));
        let polygons = self.polygons.iter().map(|p| told::PolygonCost {
            frame: p.frame,
            polygon: p.number,
            object: p.object,
            fragments: p.fragments,
            from: p.life[0],
            to: p.life[1],
            spent: p.spent.into(),
        });
        let (polygons, other_polygons) = listed(polygons.collect(), |p| (p.fragments, p.spent));
        told::Costs {
            unit_cycles: self.cycles * self.units.len() as u64,
            pixels: self.all(|way| way.on_pixels),
            elsewhere: self.all(|way| way.elsewhere),
            nobody: self.all(|way| way.for_nobody),
            done: self.units.iter().map(|unit| unit.done).sum(),
            frames: self.frame_costs().into_iter().map(Into::into).collect(),
            objects,
            polygons,
            other_objects,
            other_polygons,
        }
    }

    /// A critical path by polygon: `cycles` of each by its number in the run.
    pub(crate) fn path(&self, cycles: &[(u32, u64)]) -> PathPolygons {
        by_polygon(&self.polygons, cycles)
    }

    /// Cycles of all units, of each way those that `of` tells.
    fn all(&self, of: fn(&WayCost) -> u64) -> told::Spent {
        let mut sum = Spent::default();
        self.units.iter().flat_map(|unit| &unit.ways).for_each(|way| sum.charge(way.kind, of(way)));
        sum.into()
    }

    /// All that is for each frame.
    fn frame_costs(&self) -> Vec<Spent> {
        let mut frames = vec![Spent::default(); self.frames as usize];
        let polygons = self.polygons.iter().map(|p| (p.frame, p.spent));
        let objects = self.objects.iter().map(|(&(frame, _), &spent)| (frame, spent));
        for (frame, spent) in polygons.chain(objects).chain(self.whole_frames.iter().map(|(&frame, &spent)| (frame, spent))) {
            if let Some(sum) = frames.get_mut(frame as usize) {
                *sum += spent;
            }
        }
        frames
    }

    /// All that is for each object.
    fn objects(&self, names: &BTreeMap<u32, String>) -> Vec<ObjectCost> {
        let mut objects: BTreeMap<u32, (u64, u64, Spent)> = BTreeMap::new();
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
        let object = |(object, (polygons, fragments, spent)): (u32, (u64, u64, Spent))| {
            let name = names.get(&object).cloned().unwrap_or_default();
            ObjectCost { object, name, polygons, fragments, spent: spent.into() }
        };
        objects.into_iter().map(object).collect()
    }
}

/// The most expensive, most first, of equals the first; and the sum of the others.
fn listed<T>(mut all: Vec<T>, of: fn(&T) -> (u64, told::Spent)) -> (Vec<T>, Others) {
    all.sort_by_key(|one| Reverse(of(one).1.cycles));
    let mut others = Others::default();
    for (fragments, spent) in all.split_off(all.len().min(LISTED)).iter().map(of) {
        let Others { count, fragments: sum, spent: all } = &mut others;
        (*count, *sum) = (*count + 1, *sum + fragments);
        all.cycles += spent.cycles;
        all.busy += spent.busy;
        all.starved += spent.starved;
        all.memory += spent.memory;
        all.blocked += spent.blocked;
    }
    (all, others)
}
