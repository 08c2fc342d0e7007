//! Parameters of the geometry processor (102), of the bump decision and of the display-list source.

use basrelief_kernel::Work;
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

/// What has one LOD, and so one set of tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BumpUnit {
    /// Each polygon.
    #[default]
    Polygon,
    /// All polygons of an object.
    Object,
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
        /// Multipliers.
        multipliers: u32 = 4, unit: "operators", Assumed("a row of a matrix at a time, as the four FMACs of the vector units of the Emotion Engine (2000)"), range: 1..=256;
        /// Adders.
        adders: u32 = 4, unit: "operators", Assumed("one behind each multiplier"), range: 1..=256;
        /// Dividers.
        dividers: u32 = 2, unit: "operators", Assumed("a vertex with a tangent takes three reciprocals: with two dividers they take as long as its two roots in one unit for roots"), range: 1..=256;
        /// Units for square roots.
        square_roots: u32 = 1, unit: "operators", Assumed("one beside the dividers, where the vector units had one FDIV for both"), range: 1..=256;
        /// Units for powers.
        powers: u32 = 1, unit: "operators", Assumed("highlights at vertices are ordinary drawing, the exception here: one, as the elementary function unit of the Emotion Engine"), range: 1..=256;
        /// Vertices and indices are fetched at this rate, whatever is computed meanwhile.
        fetch_bytes_per_cycle: u32 = 16, unit: "bytes/cycle", Assumed("128 bits, the main bus of the Emotion Engine (2000)"), range: 1..=4096;
        /// Polygons are handed on at this rate, by a display list, too.
        link_bytes: u32 = 16, unit: "bytes/cycle", Assumed("(102) and (106) stand in one device: as wide as the bus that vertices come by"), range: 1..=4096;
        /// Transformed vertices that are kept, first in, first out; of a vertex found there only the index is fetched.
        vertex_cache: u32 = 16, unit: "vertices", Assumed("common; 0.6 to 0.7 vertices per triangle on strips and optimised lists"), range: 0..=1024;
        /// Back faces of double-sided materials are lit with reversed normals, as glTF asks; off: normals as stored.
        two_sided_lighting: bool = false, unit: "", Assumed("off, as in the exact picture it is compared with");
    }
}

impl GeometryConfig {
    /// Its operators.
    pub fn operators(&self) -> Work {
        let Self { multipliers, adders, dividers, square_roots, powers, .. } = *self;
        Work { multiply: multipliers, add: adders, divide: dividers, square_root: square_roots, power: powers }
    }
}

parameters! {
    /// Which polygons are bump targets. What an object's model says goes first.
    pub struct BumpConfig {
        /// Candidates: mapped (surfaces with a normal map) or all.
        targets: Targets = Targets::Mapped, unit: "", Stated("a polygon is marked as bump target in advance by its model");
        /// What has one LOD, and so one decision and one set of tables: polygon or object.
        unit: BumpUnit = BumpUnit::Polygon, unit: "", Stated("bump mapping may be switched per object instead of per polygon, as a larger unit");
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
