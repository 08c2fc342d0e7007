//! Cycles of units per object and polygon.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest number of objects, and of polygons, that a report lists. It adds up the others.
pub const LISTED: usize = 100;

/// Attribution of the cycles of all units. `pixels` + `non_pixel` + `unattributed` + `done` = `unit_cycles`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Costs {
    /// Number of units times cycles of the run.
    pub unit_cycles: u64,
    /// Cycles for pixels of the images.
    pub pixels: CycleBreakdown,
    /// Cycles for polygons, objects and frames, without their pixels.
    #[serde(alias = "elsewhere")]
    pub non_pixel: CycleBreakdown,
    /// Unattributed cycles: stalls after the last step of a unit.
    #[serde(alias = "nobody")]
    pub unattributed: CycleBreakdown,
    /// Cycles after the last step of a unit in a complete run.
    pub done: u64,
    /// Cycles for each frame.
    pub frames: Vec<CycleBreakdown>,
    /// Objects with most cycles, largest first.
    pub objects: Vec<ObjectCost>,
    /// Polygons with most cycles, largest first.
    pub polygons: Vec<PolygonCost>,
    /// Sum over all other objects.
    pub other_objects: UnlistedCosts,
    /// Sum over all other polygons.
    pub other_polygons: UnlistedCosts,
}

/// Cycle breakdown, added up over units. `busy` + `starved` + `memory` + `blocked` = `cycles`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Spent")]
pub struct CycleBreakdown {
    /// All cycles.
    pub cycles: u64,
    /// Busy cycles.
    pub busy: u64,
    /// Cycles stalled on an empty input FIFO.
    pub starved: u64,
    /// Cycles stalled on memory.
    pub memory: u64,
    /// Cycles stalled on a full output FIFO.
    pub blocked: u64,
}

impl CycleBreakdown {
    /// Returns the figures with their names.
    pub(crate) fn fields(&self) -> [(&'static str, u64); 5] {
        let &Self { cycles, busy, starved, memory, blocked } = self;
        [("cycles", cycles), ("busy", busy), ("starved", starved), ("memory", memory), ("blocked", blocked)]
    }
}

/// Cycles of an object, over all frames.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ObjectCost {
    /// Number of the object, from 0.
    pub object: u32,
    /// Name of the object in its scene, if any.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Drawn polygons.
    pub polygons: u64,
    /// Fragments of the polygons, including hidden fragments.
    pub fragments: u64,
    /// Cycles for the object, including its polygons.
    #[serde(alias = "spent")]
    pub breakdown: CycleBreakdown,
}

/// Cycles of a polygon.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PolygonCost {
    /// Frame, from 0.
    pub frame: u32,
    /// Number in the frame, from 0, in the order of the display list.
    pub polygon: u32,
    /// Object; absent if the polygon has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// Fragments, including hidden fragments.
    pub fragments: u64,
    /// First cycle of its first step.
    #[serde(default)]
    pub from: u64,
    /// First cycle after its last step.
    #[serde(default)]
    pub to: u64,
    /// Cycles for the polygon, including its pixels.
    #[serde(alias = "spent")]
    pub breakdown: CycleBreakdown,
}

/// Sum over the objects or polygons that are not listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Others")]
pub struct UnlistedCosts {
    /// Number of objects or polygons.
    pub count: u64,
    /// Fragments.
    pub fragments: u64,
    /// Cycles.
    #[serde(alias = "spent")]
    pub breakdown: CycleBreakdown,
}
