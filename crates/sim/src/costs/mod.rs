//! What each pixel, polygon, object and frame costs: every cycle of every unit, at work or waiting, is charged to the token whose step
//! ends it, and so to the pixels that the token is about. Nothing is estimated and nothing is lost: what was charged to pixels, to
//! the rest, and what was for nobody sum to the accounts of the units (law 9), to the part of a cycle.

mod drawing;
mod groups;
mod ledger;
mod polygons;
mod probe;
mod report;

pub(crate) use groups::StepGroups;
pub use ledger::{CostKind, PARTS, UnitCost, WayCost};
pub use polygons::PolygonCost;
pub(crate) use probe::CostProbe;

use basrelief_input::Held;
use drawing::Drawing;
use std::collections::BTreeMap;
use std::ops::AddAssign;

/// Where in a machine fragments come into being and where they end, by the names of its FIFOs.
#[derive(Clone, Copy, Debug)]
pub struct CostPoints {
    /// The FIFO that each fragment enters first.
    pub drawn: &'static str,
    /// The FIFO that visible pixels end in: the first of these that the machine has as it is configured.
    pub shown: &'static [&'static str],
}

/// Cycles of units, by what they were spent on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// At work.
    pub busy: u64,
    /// Waiting for a token.
    pub starved: u64,
    /// Waiting for credits or answers.
    pub memory: u64,
    /// Waiting for a slot.
    pub blocked: u64,
}

impl Spent {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.busy + self.starved + self.memory + self.blocked
    }

    fn charge(&mut self, kind: CostKind, cycles: u64) {
        *match kind {
            CostKind::Busy => &mut self.busy,
            CostKind::Starved => &mut self.starved,
            CostKind::Memory => &mut self.memory,
            CostKind::Blocked => &mut self.blocked,
        } += cycles;
    }
}

impl AddAssign for Spent {
    fn add_assign(&mut self, other: Self) {
        self.busy += other.busy;
        self.starved += other.starved;
        self.memory += other.memory;
        self.blocked += other.blocked;
    }
}

/// What a run has cost, for whom. Pixels are those of all its frames, one upon the other.
#[derive(Debug)]
pub struct Costs {
    /// Cycles of the run: each unit has as many.
    pub cycles: u64,
    /// Frames that were begun.
    pub frames: u64,
    /// The units, in the order of the wiring.
    pub units: Vec<UnitCost>,
    /// The polygons, in the order in which they entered.
    pub polygons: Vec<PolygonCost>,
    drawing: Drawing,
    /// By frame and object, for the object and none of its polygons; by frame, for none of its objects.
    objects: BTreeMap<(u32, u32), Spent>,
    whole_frames: BTreeMap<u32, Spent>,
    _held: Held,
}

/// What one unit spent on a pixel, on one thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelWay<'a> {
    /// Name of the unit.
    pub unit: &'a str,
    /// On what.
    pub kind: CostKind,
    /// Name of the FIFO or the memory client that was waited for; empty at work.
    pub of: &'a str,
    /// \[cycles\]
    pub cycles: f64,
}

/// A pixel, and what it has cost.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelCost<'a> {
    /// Cycles of units, at work and waiting; those of a token of several pixels are shared evenly.
    pub cycles: f64,
    /// What these consist of, most first.
    pub ways: Vec<PixelWay<'a>>,
    /// Fragments drawn there, hidden ones among them.
    pub overdraw: u32,
    /// MIP level of the fragment that came last, the one with the larger share where it has two; of a machine that has levels.
    pub level: Option<u8>,
    /// Index of its reference normal; of a machine that has them.
    pub entry: Option<u32>,
    /// The polygon that it shows.
    pub polygon: Option<PolygonCost>,
}

impl Costs {
    /// Width and height \[pixels\]; 0 where no frame was begun.
    pub fn size(&self) -> [u32; 2] {
        self.drawing.size
    }

    /// What is known of a pixel; none outside of the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<PixelCost<'_>> {
        let at = [u16::try_from(x).ok()?, u16::try_from(y).ok()?];
        let place = self.drawing.place(at)?;
        let mut ways: Vec<PixelWay<'_>> = self.ways_at(place).collect();
        ways.sort_by(|a, b| b.cycles.total_cmp(&a.cycles));
        Some(PixelCost {
            cycles: self.cycles_at(place, None),
            ways,
            overdraw: self.drawing.overdraw(place),
            level: self.drawing.level(place),
            entry: self.drawing.entry(place),
            polygon: self.drawing.polygon(place).and_then(|n| self.polygons.get(n).copied()),
        })
    }

    fn ways_at(&self, place: usize) -> impl Iterator<Item = PixelWay<'_>> {
        let all = self.units.iter().flat_map(|unit| unit.ways.iter().map(|way| (unit.unit.as_str(), way)));
        all.filter_map(move |(unit, way)| {
            let parts = way.parts.get(place).copied().filter(|parts| *parts > 0)?;
            Some(PixelWay { unit, kind: way.kind, of: &way.of, cycles: in_cycles(parts) })
        })
    }

    /// Cycles of a pixel, of one kind or of all, by its place row by row.
    fn cycles_at(&self, place: usize, kind: Option<CostKind>) -> f64 {
        let ways = self.units.iter().flat_map(|unit| &unit.ways).filter(|way| kind.is_none_or(|kind| way.kind == kind));
        in_cycles(ways.filter_map(|way| way.parts.get(place)).sum())
    }

    /// Cycles by pixel, row by row, of one kind or of all; not a number where nothing was drawn.
    pub fn picture(&self, kind: Option<CostKind>) -> Vec<f32> {
        self.values(|place| Some(self.cycles_at(place, kind) as f32))
    }

    /// Fragments by pixel.
    pub fn overdraw(&self) -> Vec<f32> {
        self.values(|place| Some(self.drawing.overdraw(place) as f32))
    }

    /// MIP level by pixel.
    pub fn levels(&self) -> Vec<f32> {
        self.values(|place| self.drawing.level(place).map(f32::from))
    }

    /// Index of the reference normal by pixel.
    pub fn entries(&self) -> Vec<f32> {
        self.values(|place| self.drawing.entry(place).map(|entry| entry as f32))
    }

    fn values(&self, value: impl Fn(usize) -> Option<f32>) -> Vec<f32> {
        let [width, height] = self.size();
        let drawn = |place: &usize| self.drawing.overdraw(*place) > 0;
        let places = 0..width as usize * height as usize;
        places.map(|place| Some(place).filter(drawn).and_then(&value).unwrap_or(f32::NAN)).collect()
    }
}

fn in_cycles(parts: u64) -> f64 {
    parts as f64 / PARTS as f64
}
