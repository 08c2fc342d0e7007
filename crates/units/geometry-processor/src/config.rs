//! Parameters of the geometry processor (102), of the bump decision and of the display-list source.

use basrelief_parameters::parameters;
use serde::{Deserialize, Serialize};

/// Which surfaces are candidates for bump mapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Targets {
    /// Surfaces with a normal map.
    #[default]
    Mapped,
    /// Every surface; where there is no map, its normals are taken as they are.
    All,
}

/// When a replayed display list delivers its commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Arrival {
    /// At the recorded cycles, later only when blocked.
    #[default]
    Recorded,
    /// One per cycle.
    Asap,
}

parameters! {
    /// Geometry processor (102).
    pub struct GeometryConfig {
        /// The unit is kept this long by each vertex that is transformed.
        cycles_per_vertex: u32 = 4, unit: "cycles", Assumed("four multiply-add units, one row of the matrix per cycle"), range: 0..=65_536;
        /// The unit is kept this long by each triangle: clip, cull, set-up, LOD.
        cycles_per_polygon: u32 = 4, unit: "cycles", Assumed("as much as one vertex"), range: 0..=65_536;
        /// Transformed vertices that are kept, first in, first out; a vertex found there costs nothing.
        vertex_cache: u32 = 16, unit: "vertices", Assumed("common; 0.6 to 0.7 vertices per triangle on strips and optimised lists"), range: 0..=1024;
        /// From start to delivery.
        latency: u32 = 32, unit: "cycles", Assumed("transformation, clipping and one division per vertex"), range: 0..=65_536;
        /// Back faces of double-sided materials are lit with reversed normals, as glTF asks; off: normals as stored.
        two_sided_lighting: bool = false, unit: "", Assumed("off, as in the exact picture it is compared with");
    }
}

parameters! {
    /// Which polygons are bump targets. What an object's model says goes first.
    pub struct BumpConfig {
        /// Candidates: mapped (surfaces with a normal map) or all.
        targets: Targets = Targets::Mapped, unit: "", Stated("a polygon is marked as bump target in advance by its model");
        /// A candidate is a bump target while its LOD is at or below this; small LOD is fine detail.
        max_lod: u8 = 63, unit: "LOD", Assumed("all; the patent states that a threshold of the LOD may decide while drawing, not its value"), range: 0..=63;
    }
}

parameters! {
    /// Replay of a recorded display list in place of the geometry processor (102).
    pub struct DisplayListConfig {
        /// When commands are delivered: recorded or asap.
        arrival: Arrival = Arrival::Recorded, unit: "", Assumed("polygons come as an unblocked geometry processor would deliver them, so a replay takes about the cycles of the run it was recorded from");
    }
}
