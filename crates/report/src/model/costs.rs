//! Cycles of units per object and polygon.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most objects, and most polygons, that a report lists; the others stand in a sum.
pub const LISTED: usize = 100;

/// Who the cycles of all units were for. `pixels` + `elsewhere` + `nobody` + `done` = `unit_cycles`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Costs {
    /// Units times cycles of the run.
    pub unit_cycles: u64,
    /// For pixels of the pictures.
    pub pixels: Spent,
    /// For polygons, objects and frames, and none of their pixels.
    pub elsewhere: Spent,
    /// For nobody: waits after a unit's last step.
    pub nobody: Spent,
    /// Cycles after a unit's last step in a complete run.
    pub done: u64,
    /// By frame, all that is for it.
    pub frames: Vec<Spent>,
    /// The most expensive objects, most first.
    pub objects: Vec<ObjectCost>,
    /// The most expensive polygons, most first.
    pub polygons: Vec<PolygonCost>,
    /// All other objects.
    pub other_objects: Others,
    /// All other polygons.
    pub other_polygons: Others,
}

/// Cycles of units. `busy` + `starved` + `memory` + `blocked` = `cycles`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Spent {
    /// All of them.
    pub cycles: u64,
    /// At work.
    pub busy: u64,
    /// Waiting for a token.
    pub starved: u64,
    /// Waiting for credits or answers of a memory.
    pub memory: u64,
    /// Waiting for a slot.
    pub blocked: u64,
}

impl Spent {
    /// Its figures by name.
    pub(crate) fn fields(&self) -> [(&'static str, u64); 5] {
        let &Self { cycles, busy, starved, memory, blocked } = self;
        [("cycles", cycles), ("busy", busy), ("starved", starved), ("memory", memory), ("blocked", blocked)]
    }
}

/// An object, over all frames.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ObjectCost {
    /// Its number, from 0.
    pub object: u32,
    /// Its name, where it comes from a scene that has one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Polygons that were drawn of it.
    pub polygons: u64,
    /// Fragments of these, hidden ones among them.
    pub fragments: u64,
    /// All that was for it, its polygons among it.
    pub spent: Spent,
}

/// A polygon.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PolygonCost {
    /// Number of its frame, from 0.
    pub frame: u32,
    /// Number in its frame, from 0, in the order of the display list.
    pub polygon: u32,
    /// Number of its object; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// Its fragments, hidden ones among them.
    pub fragments: u64,
    /// The cycle in which the first step for it began.
    #[serde(default)]
    pub from: u64,
    /// The cycle after its last step.
    #[serde(default)]
    pub to: u64,
    /// All that was for it, its pixels among it.
    pub spent: Spent,
}

/// Those that are not listed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Others {
    /// How many.
    pub count: u64,
    /// Their fragments.
    pub fragments: u64,
    /// What was for them.
    pub spent: Spent,
}
