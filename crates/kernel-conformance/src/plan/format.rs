//! The format of plans.

use basrelief_kernel::MemoryConfig;
use serde::{Deserialize, Serialize};

/// A whole plan.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Plan {
    /// The FIFOs.
    pub fifos: Vec<PlanFifo>,
    /// The memories, each with its ports in order of number.
    #[serde(default)]
    pub memories: Vec<PlanMemory>,
    /// The caches.
    #[serde(default)]
    pub caches: Vec<PlanCache>,
    /// The units; their order must not matter.
    pub units: Vec<PlannedUnit>,
}

/// A FIFO of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanFifo {
    /// Unique name.
    pub name: String,
    /// Slots, at least 1.
    pub depth: usize,
    /// Cycles from delivery to visibility, at least 1.
    pub latency: u64,
}

/// A memory of a plan. Its `outstanding` says nothing: each port has its own.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanMemory {
    /// Unique name.
    pub name: String,
    /// Its parameters, beside the name.
    #[serde(flatten)]
    pub config: MemoryConfig,
    /// Its ports, in order of number.
    pub ports: Vec<PlanPort>,
}

/// A port of a memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanPort {
    /// Unique name.
    pub name: String,
    /// Requests in flight.
    pub outstanding: u32,
}

/// A cache of a plan; fields as in [`CacheConfig`](basrelief_kernel::CacheConfig).
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the names are those of CacheConfig")]
pub struct PlanCache {
    pub name: String,
    pub port: String,
    pub line_bytes: u32,
    pub sets: u32,
    pub ways: u32,
    pub hit_latency: u32,
    pub lookups_per_cycle: u32,
}

/// A unit of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlannedUnit {
    /// Unique name.
    pub name: String,
    /// Its kind.
    #[serde(flatten)]
    pub kind: Kind,
    /// Names of the FIFOs it pops from.
    #[serde(rename = "in")]
    pub inputs: Vec<String>,
    /// Names of the FIFOs it pushes to.
    #[serde(rename = "out")]
    pub outputs: Vec<String>,
    /// Occupancy by id modulo length \[cycles\].
    pub occupancy: Vec<u64>,
    /// Latency by id modulo length \[cycles\].
    pub latency: Vec<u64>,
}

/// Kind of a unit of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Kind {
    /// Emits tokens 0, 1, ..; the final one has last.
    Source {
        /// How many.
        tokens: u64,
    },
    /// Hands its token on.
    Work,
    /// Hands its token to every output.
    Fork,
    /// Takes a token of every input; emits the first, last if any has last.
    Join,
    /// Emits to output id mod (number of outputs) only.
    Route,
    /// Takes input k mod n at step k; ids renumbered.
    Merge {
        /// How many pass.
        tokens: u64,
    },
    /// Emits `factor` children, one per step.
    Expand {
        /// Children per token.
        factor: u64,
    },
    /// Emits one token for `size`, and on last.
    Gather {
        /// Tokens per token.
        size: u64,
    },
    /// Hands its token on; each step issues requests.
    Access {
        /// The requests.
        requests: Vec<PlanRequest>,
    },
    /// Hands its token on; each step looks up lines.
    Cached {
        /// Name of its cache.
        cache: String,
        /// The look-ups.
        lookups: Vec<PlanLookUp>,
    },
    /// Swallows its token.
    Sink,
}

/// A request at address (id * stride + offset) mod span.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the formula says all")]
pub struct PlanRequest {
    pub port: String,
    pub write: bool,
    pub bytes: u32,
    pub stride: u64,
    pub offset: u64,
    pub span: u64,
}

/// A look-up at address (id * stride + offset) mod span.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the formula says all")]
pub struct PlanLookUp {
    pub stride: u64,
    pub offset: u64,
    pub span: u64,
}
