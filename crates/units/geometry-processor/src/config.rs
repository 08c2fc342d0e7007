//! Parameters of the geometry processor (102), of the bump decision and of the display-list source.

use basrelief_kernel::OperatorCounts;
use basrelief_parameters::parameters;
use serde::{Deserialize, Serialize};

/// Surfaces that are candidates for bump mapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BumpTargets {
    /// Surfaces with a normal map.
    #[default]
    Mapped,
    /// Every surface. Without a map, the normals are used unchanged.
    All,
}

/// Scope of one LOD, and so of one set of tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BumpUnit {
    /// Each polygon.
    #[default]
    Polygon,
    /// All polygons of an object.
    Object,
}

/// Delivery times of the commands of a replayed display list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CommandArrival {
    /// At the recorded cycles, or later if blocked.
    #[default]
    Recorded,
    /// One command per cycle.
    Asap,
}

parameters! {
    /// Geometry processor (102).
    pub struct GeometryConfig {
        /// Multipliers of the unit.
        multipliers: u32 = 4, unit: "operators", Assumed("a row of a matrix at a time, as the four FMACs of the vector units of the Emotion Engine (2000)"), range: 1..=256;
        /// Adders of the unit.
        adders: u32 = 4, unit: "operators", Assumed("one behind each multiplier"), range: 1..=256;
        /// Dividers of the unit.
        dividers: u32 = 2, unit: "operators", Assumed("a vertex with a tangent takes three reciprocals: with two dividers they take as long as its two roots in one unit for roots"), range: 1..=256;
        /// Square-root units.
        square_roots: u32 = 1, unit: "operators", Assumed("one beside the dividers, where the vector units had one FDIV for both"), range: 1..=256;
        /// Power units.
        powers: u32 = 1, unit: "operators", Assumed("highlights at vertices are ordinary drawing, the exception here: one, as the elementary function unit of the Emotion Engine"), range: 1..=256;
        /// Bandwidth for vertices and indices, which are fetched during arithmetic.
        fetch_bytes_per_cycle: u32 = 16, unit: "bytes/cycle", Assumed("128 bits, the main bus of the Emotion Engine (2000)"), range: 1..=4096;
        /// Bandwidth of the link for polygons, also when a display list is replayed.
        link_bytes: u32 = 16, unit: "bytes/cycle", Assumed("(102) and (106) stand in one device: as wide as the bus that vertices come by"), range: 1..=4096;
        /// Vertices in the cache of transformed vertices (first in, first out). A hit fetches only the index.
        vertex_cache: u32 = 16, unit: "vertices", Assumed("common; 0.6 to 0.7 vertices per triangle on strips and optimised lists"), range: 0..=1024;
        /// True if back faces of double-sided materials are lit with reversed normals, as in glTF. False: normals as stored.
        two_sided_lighting: bool = false, unit: "", Assumed("off, as in the reference image it is compared with");
    }
}

impl GeometryConfig {
    /// Returns the unit's operators.
    pub fn operators(&self) -> OperatorCounts {
        let Self { multipliers, adders, dividers, square_roots, powers, .. } = *self;
        OperatorCounts {
            multiply: multipliers,
            add: adders,
            divide: dividers,
            square_root: square_roots,
            power: powers,
            ..OperatorCounts::NONE
        }
    }
}

parameters! {
    /// Selection of bump targets. An object's model overrides it.
    pub struct BumpConfig {
        /// Candidates: mapped (surfaces with a normal map) or all.
        targets: BumpTargets = BumpTargets::Mapped, unit: "", Stated("a polygon is marked as bump target in advance by its model");
        /// Scope of one LOD, and so of one bump decision and one set of tables: polygon or object.
        unit: BumpUnit = BumpUnit::Polygon, unit: "", Stated("bump mapping may be switched per object instead of per polygon, as a larger unit");
        /// Largest LOD at which a candidate is a bump target. Small LOD means fine detail.
        max_lod: u8 = 63, unit: "LOD", Assumed("all; the patent states that a threshold of the LOD may decide while drawing, not its value"), range: 0..=63;
    }
}

parameters! {
    /// Replay of a recorded display list instead of the geometry processor (102).
    pub struct DisplayListConfig {
        /// Delivery times of commands: recorded or asap.
        arrival: CommandArrival = CommandArrival::Recorded, unit: "", Assumed("polygons come as an unblocked geometry processor would deliver them, so a replay takes about the cycles of the run it was recorded from");
    }
}
