//! Costs of a run by pixel, polygon, object and frame.

use super::accumulator::{PARTS, UnitCost};
use super::cycle_breakdown::{CostKind, CycleBreakdown};
use super::pixels::PixelRecords;
use super::polygons::PolygonCost;
use basrelief_input::MemoryReservation;
use std::collections::BTreeMap;

/// Costs of a run by pixel, polygon, object and frame. A pixel sums its costs over all frames.
#[derive(Debug)]
pub struct RunCosts {
    /// Cycles of the run.
    pub cycles: u64,
    /// Number of frames.
    pub frames: u64,
    /// Costs of each unit, in the order of the block diagram.
    pub units: Vec<UnitCost>,
    /// Costs of each polygon, in the order of entry.
    pub polygons: Vec<PolygonCost>,
    pub(super) pixels: PixelRecords,
    /// Costs of objects, without those of their polygons, by frame and object.
    pub(super) objects: BTreeMap<(u32, u32), CycleBreakdown>,
    /// Costs of frames, without those of their objects.
    pub(super) whole_frames: BTreeMap<u32, CycleBreakdown>,
    pub(super) _held: MemoryReservation,
}

/// Cycles that one unit spent on a pixel, in one activity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelActivity<'a> {
    /// Name of the unit.
    pub unit: &'a str,
    /// Activity.
    pub kind: CostKind,
    /// FIFO or memory client that the unit waited for; empty if busy.
    pub of: &'a str,
    /// Cycles.
    pub cycles: f64,
}

/// Costs of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelCost<'a> {
    /// Unit cycles, busy and waiting. Cycles of a token with several pixels are divided evenly.
    pub cycles: f64,
    /// Breakdown of the cycles, largest first.
    pub activities: Vec<PixelActivity<'a>>,
    /// Number of fragments, including hidden ones.
    pub overdraw: u32,
    /// MIP level of the last fragment, the one with the larger weight if it has two; `None` if the machine has no levels.
    pub level: Option<u8>,
    /// Index of the reference normal; `None` if the machine has none.
    pub entry: Option<u32>,
    /// The visible polygon.
    pub polygon: Option<PolygonCost>,
}

impl RunCosts {
    /// Returns width and height \[pixels\]; 0 if there was no frame.
    pub fn size(&self) -> [u32; 2] {
        self.pixels.size
    }

    /// Returns the costs of a pixel; `None` outside of the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<PixelCost<'_>> {
        let at = [u16::try_from(x).ok()?, u16::try_from(y).ok()?];
        let place = self.pixels.index_of(at)?;
        let mut activities: Vec<PixelActivity<'_>> = self.activities_at(place).collect();
        activities.sort_by(|a, b| b.cycles.total_cmp(&a.cycles));
        Some(PixelCost {
            cycles: self.cycles_at(place, None),
            activities,
            overdraw: self.pixels.overdraw(place),
            level: self.pixels.level(place),
            entry: self.pixels.entry(place),
            polygon: self.pixels.polygon(place).and_then(|n| self.polygons.get(n).copied()),
        })
    }

    fn activities_at(&self, place: usize) -> impl Iterator<Item = PixelActivity<'_>> {
        let all = self.units.iter().flat_map(|unit| unit.activities.iter().map(|activity| (unit.unit.as_str(), activity)));
        all.filter_map(move |(unit, activity)| {
            let parts = activity.parts.get(place).copied().filter(|parts| *parts > 0)?;
            Some(PixelActivity { unit, kind: activity.kind, of: &activity.of, cycles: in_cycles(parts) })
        })
    }

    /// Returns the cycles of a pixel by its index, in one activity or in all.
    fn cycles_at(&self, place: usize, kind: Option<CostKind>) -> f64 {
        let activities =
            self.units.iter().flat_map(|unit| &unit.activities).filter(|activity| kind.is_none_or(|kind| activity.kind == kind));
        in_cycles(activities.filter_map(|activity| activity.parts.get(place)).sum())
    }

    /// Returns the cycles of each pixel, row by row, in one activity or in all. Pixels without fragments are NaN.
    pub fn cycles_by_pixel(&self, kind: Option<CostKind>) -> Vec<f32> {
        self.values(|place| Some(self.cycles_at(place, kind) as f32))
    }

    /// Returns the number of fragments of each pixel, row by row. Pixels without fragments are NaN.
    pub fn overdraw(&self) -> Vec<f32> {
        self.values(|place| Some(self.pixels.overdraw(place) as f32))
    }

    /// Returns the MIP level of each pixel, row by row. Pixels without a level are NaN.
    pub fn levels(&self) -> Vec<f32> {
        self.values(|place| self.pixels.level(place).map(f32::from))
    }

    /// Returns the index of each pixel's reference normal, row by row. Pixels without one are NaN.
    pub fn entries(&self) -> Vec<f32> {
        self.values(|place| self.pixels.entry(place).map(|entry| entry as f32))
    }

    fn values(&self, value: impl Fn(usize) -> Option<f32>) -> Vec<f32> {
        let [width, height] = self.size();
        let drawn = |place: &usize| self.pixels.overdraw(*place) > 0;
        let places = 0..width as usize * height as usize;
        places.map(|place| Some(place).filter(drawn).and_then(&value).unwrap_or(f32::NAN)).collect()
    }
}

fn in_cycles(parts: u64) -> f64 {
    parts as f64 / PARTS as f64
}
