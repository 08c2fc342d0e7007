//! Cycles of units, occupancy of FIFOs, bottlenecks and the critical path.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Cycle breakdown of a unit. busy + starved + blocked + memory + done = `cycles.total`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Unit {
    /// Reference numeral in the patent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub numeral: Option<u32>,
    /// Executed steps.
    pub steps: u64,
    /// Tokens pushed to all outputs. For a unit without outputs, tokens taken.
    pub tokens: u64,
    /// Busy cycles.
    pub busy: u64,
    /// Cycles stalled on an empty input FIFO, by FIFO. Lists every input.
    pub starved: IndexMap<String, u64>,
    /// Cycles stalled on a full output FIFO, by FIFO. Lists every output.
    pub blocked: IndexMap<String, u64>,
    /// Cycles stalled on memory credits or responses, by client. Lists every client.
    pub memory: IndexMap<String, u64>,
    /// Cycles after the last step.
    pub done: u64,
}

/// Occupancy of a FIFO.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Fifo {
    /// Depth \[slots\].
    pub depth: u64,
    /// Pushed tokens.
    pub tokens: u64,
    /// Largest number of occupied slots.
    pub high_water: u64,
    /// `histogram[k]` = cycles with k occupied slots, k = 0 ..= depth. Sums to `cycles.total`.
    pub histogram: Vec<u64>,
}

/// Chain of work and stalls from the first cycle to the end of the last frame, without gap or overlap. Other paths may tie.
/// `bottlenecks` lists the cycles that a change would save.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CriticalPath {
    /// Sum over all parts.
    pub cycles: u64,
    /// Longest first.
    pub parts: Vec<PathPart>,
    /// The same cycles by polygon, with `--costs`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PathPolygons>,
}

/// Cycles of a critical path by polygon. A segment counts for the polygon of its first step. `listed` + `others` + `no_polygon` =
/// `cycles` of the path.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPolygons {
    /// Polygons with most cycles, largest first.
    pub listed: Vec<PathPolygon>,
    /// Cycles of all other polygons.
    pub others: u64,
    /// Cycles that belong to no polygon: of objects, of frames, or unattributed.
    #[serde(rename = "no_polygon", alias = "elsewhere")]
    pub elsewhere: u64,
}

/// Part of a critical path that belongs to one polygon.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPolygon {
    /// Frame, from 0.
    pub frame: u32,
    /// Number in the frame, from 0, in the order of the display list.
    pub polygon: u32,
    /// Object; absent if the polygon has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// \[cycles\]
    pub cycles: u64,
}

/// All segments of a critical path of one kind at one resource.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPart {
    /// Unit, FIFO or memory client, or `display`. Empty for the tokens in flight at the end.
    pub resource: String,
    /// For a unit: `occupancy` or `latency`. For a FIFO: `FIFO` (its latency and one token per cycle) or `slot`. For a request:
    /// `arrival`, `bus`, `bank`, `data`, `order` or `cache`. For the display: `refresh`. Otherwise `rest`.
    #[serde(rename = "kind", alias = "what")]
    pub what: String,
    /// \[cycles\]
    pub cycles: u64,
    /// The same cycles by entry of `cycles.frames`.
    pub frames: Vec<u64>,
}

/// Relaxation of a unit: it starts a step in every cycle.
pub const FULLY_PIPELINED: &str = "fully pipelined (II = 1)";
/// Relaxation of a FIFO: it is never full.
pub const UNBOUNDED_FIFO: &str = "unbounded FIFO";

/// Relaxation of a memory: the part `ideal`, as in the presets of ideal machines.
pub const IDEAL_MEMORY: &str = "ideal memory";
/// Relaxation of the display: nothing waits for its refresh, and it reads no pictures.
pub const NO_DISPLAY: &str = "no display";
/// Relaxation of a cache.
pub const ALWAYS_HITS: &str = "a hit on every lookup";

/// Measured bottlenecks of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bottlenecks {
    /// Resources that are saturated together: none of them saves much alone. Absent if one resource alone limits the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balanced: Option<RelaxedSet>,
    /// Bottleneck ladder, from first to last rung. Each rung relaxes the resources of the rung before it, and the resource that holds
    /// most of the critical path then, together with units that are busy equally long. The last rung relaxes all other resources, once
    /// they save at most a twentieth of the savings of all resources.
    pub ladder: Vec<RelaxedSet>,
    /// Cycles saved when one resource is relaxed, largest saving first.
    pub single: Vec<RelaxedCycles>,
}

/// Render cycles with several resources relaxed. A full run with the options of `set` takes exactly these cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RelaxedSet {
    /// Relaxed resources in the order of their relaxation, with names as in `bottlenecks.single[].resource`.
    pub relaxed: Vec<String>,
    /// Parameters, as `--set` takes them.
    pub set: Vec<String>,
    /// Render cycles with all of them relaxed.
    pub cycles: u64,
    /// Saved share of the render cycles, 0 to 1.
    pub saved: f64,
    /// True for the last rung of a ladder, which relaxes all resources.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub relaxes_all: bool,
}

/// Reads bottlenecks. Reports of schema 2 list single relaxations only.
pub(super) fn read_bottlenecks<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Bottlenecks>, D::Error> {
    struct BottleneckVisitor;
    impl<'de> Visitor<'de> for BottleneckVisitor {
        type Value = Bottlenecks;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an object with `ladder` and `single`")
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            Bottlenecks::deserialize(MapAccessDeserializer::new(map))
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
            let mut single: Vec<RelaxedCycles> = Vec::deserialize(SeqAccessDeserializer::new(list))?;
            // Version 0.1 listed pairs of relaxations, too.
            single.retain(|relaxed| !relaxed.resource.contains(" and "));
            Ok(Bottlenecks { single, ..Bottlenecks::default() })
        }
    }
    from.deserialize_any(BottleneckVisitor).map(Some)
}

/// Render cycles with one resource relaxed. A full run with the options of `set` takes exactly these cycles.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Limit")]
pub struct RelaxedCycles {
    /// Relaxed resource. A unit has its name. FIFOs, memories and caches have the names of their parameters, such as
    /// `memory.graphics`, because a unit may have the same name.
    pub resource: String,
    /// Relaxation, such as `fully pipelined (II = 1)`.
    #[serde(rename = "relaxation", alias = "what")]
    pub what: String,
    /// Parameters, as `--set` takes them.
    pub set: Vec<String>,
    /// Render cycles with the relaxation.
    pub cycles: u64,
    /// Saved render cycles.
    pub saved: u64,
}
