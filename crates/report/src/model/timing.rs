//! Cycles of units, occupancy of FIFOs, bottlenecks and the critical path.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where a unit's cycles went. busy + starved + blocked + memory + done = `cycles.total`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Unit {
    /// The patent's reference numeral.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub numeral: Option<u32>,
    /// Steps made.
    pub steps: u64,
    /// Tokens emitted, over all outputs; of a unit without outputs, tokens taken.
    pub tokens: u64,
    /// Cycles at work.
    pub busy: u64,
    /// Cycles without a visible token, by input FIFO; every input is listed.
    pub starved: IndexMap<String, u64>,
    /// Cycles without a free slot, by output FIFO; every output is listed.
    pub blocked: IndexMap<String, u64>,
    /// Cycles waiting for credits or answers, by memory client; every client is listed.
    pub memory: IndexMap<String, u64>,
    /// Cycles after its last step.
    pub done: u64,
}

/// How full a FIFO was.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Fifo {
    /// Slots.
    pub depth: u64,
    /// Tokens that were pushed.
    pub tokens: u64,
    /// Most slots ever held.
    pub high_water: u64,
    /// `histogram[k]` = cycles with k slots held, k = 0 ..= depth; sums to `cycles.total`.
    pub histogram: Vec<u64>,
}

/// A chain of work and waits, without gap or overlap, from the first cycle to the end of the last frame. Another may be as long:
/// what something costs is told by [`Limit`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CriticalPath {
    /// The sum over all parts.
    pub cycles: u64,
    /// Longest first.
    pub parts: Vec<PathPart>,
    /// The same cycles by polygon, where costs were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PathPolygons>,
}

/// Cycles of a critical path by polygon: a stretch is for what the step is for that it begins with. `listed` + `others` + `elsewhere` =
/// `cycles` of the path.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPolygons {
    /// Those with most of it, most first.
    pub listed: Vec<PathPolygon>,
    /// Cycles for all other polygons.
    pub others: u64,
    /// Cycles for objects and frames, and none of their polygons; and for nobody.
    pub elsewhere: u64,
}

/// A polygon's part of a critical path.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPolygon {
    /// Number of its frame, from 0.
    pub frame: u32,
    /// Number in its frame, from 0, in the order of the display list.
    pub polygon: u32,
    /// Number of its object; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// \[cycles\]
    pub cycles: u64,
}

/// All stretches of a critical path that are spent on one thing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPart {
    /// Name of a unit, FIFO or memory client; empty for what is left in flight at the end.
    pub resource: String,
    /// Of a unit `occupancy` or `latency`; of a FIFO `FIFO`, which is its latency and one token per cycle, or `slot`; of a request
    /// `arrival`, `bus`, `bank`, `data`, `order` or `cache`; or `rest`.
    pub what: String,
    /// \[cycles\]
    pub cycles: u64,
    /// Of these, those within each frame.
    pub frames: Vec<u64>,
}

/// What a run would take with something made ideal: cycles of its frames, without the drain behind the last. A full run with `set`
/// takes exactly these.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Limit {
    /// What is made ideal: name of a unit, FIFO, memory or cache; or two of them.
    pub resource: String,
    /// How.
    pub what: String,
    /// Parameters, as `--set` takes them.
    pub set: Vec<String>,
    /// Cycles of the frames then.
    pub cycles: u64,
    /// Cycles fewer than as it was.
    pub saved: u64,
}
