//! The JSON format of plans.

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
    /// The units. The result must not depend on their order.
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
    /// Tokens become visible in multiples of this cycle, at least 1.
    #[serde(default = "one")]
    pub period: u64,
}

fn one() -> u64 {
    1
}

/// A memory of a plan. Its `outstanding` is ignored, because each port has its own.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanMemory {
    /// Unique name.
    pub name: String,
    /// Its parameters except the name.
    #[serde(flatten)]
    pub config: MemoryConfig,
    /// Its ports, in order of number.
    pub ports: Vec<PlanPort>,
    /// Its periodic clients, in order of number.
    #[serde(default)]
    pub periodic: Vec<PlanPeriodic>,
}

/// A periodic client of a memory. It reads `bytes` at address (k * stride) mod span in cycle k * period.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs, reason = "the formula says all")]
pub struct PlanPeriodic {
    pub name: String,
    pub period: u64,
    pub bytes: u32,
    pub stride: u64,
    pub span: u64,
}

/// A port of a memory.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanPort {
    /// Unique name.
    pub name: String,
    /// Maximum number of requests in flight.
    pub outstanding: u32,
    /// Its requests are flips.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flips: Option<PlanFlips>,
}

/// The flips of a port.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanFlips {
    /// Name of the periodic client of the same memory.
    pub of: String,
    /// Flips take effect in multiples of these cycles, at least 1.
    pub period: u64,
    /// Cycles for which the client reads from the address of a flip. 0: until the next flip.
    pub hold: u64,
    /// True if the requests are no flips, but wait for the end of the hold of the last flip.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub wait: bool,
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
    /// True if all look-ups of a step are made at its start.
    #[serde(default)]
    pub at_once: bool,
    /// True if every look-up hits.
    #[serde(default)]
    pub always_hits: bool,
}

/// A unit of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlannedUnit {
    /// Unique name.
    pub name: String,
    /// Its kind.
    #[serde(flatten)]
    pub kind: UnitKind,
    /// Names of the FIFOs it pops from.
    #[serde(rename = "in")]
    pub inputs: Vec<String>,
    /// Names of the FIFOs it pushes to.
    #[serde(rename = "out")]
    pub outputs: Vec<String>,
    /// Occupancy of each step, indexed by id modulo length \[cycles\].
    pub occupancy: Vec<u64>,
    /// Latency of each step, indexed by id modulo length \[cycles\].
    pub latency: Vec<u64>,
    /// Work after data of each step, indexed by id modulo length \[cycles\]; empty for none.
    #[serde(default)]
    pub after: Vec<u32>,
    /// True if its steps keep it until their last answer.
    #[serde(default)]
    pub blocking: bool,
    /// Requests of a step that arrive per cycle on each port; 0 for all at once.
    #[serde(default)]
    pub issue: u32,
    /// True if it is fully pipelined for a relaxation.
    #[serde(default)]
    pub ideal: bool,
}

/// Kind of a unit of a plan.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum UnitKind {
    /// Emits tokens 0, 1, .. The final token has `last` set.
    Source {
        /// Number of tokens.
        tokens: u64,
    },
    /// Forwards its token.
    Work,
    /// Forwards its token to every output.
    Fork,
    /// Pops a token from every input and emits the first. Sets `last` if any popped token has it.
    Join,
    /// Forwards its token to output id mod (number of outputs) only.
    Route,
    /// Pops from input k mod n at step k, and renumbers the tokens.
    Merge {
        /// Number of tokens.
        tokens: u64,
    },
    /// Emits `factor` children, one per step.
    Expand {
        /// Children per token.
        factor: u64,
    },
    /// Emits one token per `size` popped tokens, and one on `last`.
    Gather {
        /// Popped tokens per emitted token.
        size: u64,
    },
    /// Forwards its token. Each step issues requests.
    Access {
        /// Requests per step.
        requests: Vec<PlanRequest>,
    },
    /// Forwards its token. Each step looks up cache lines.
    Cached {
        /// Name of its cache.
        cache: String,
        /// Look-ups per step.
        lookups: Vec<PlanLookUp>,
    },
    /// Forwards its token. Some steps look up cache lines, some issue requests, and some block.
    Mixed {
        /// Requests.
        requests: Vec<PlanRequest>,
        /// Request i belongs to steps whose id is a multiple of entry i modulo length.
        every: Vec<u64>,
        /// Name of its cache.
        cache: String,
        /// Look-ups.
        lookups: Vec<PlanLookUp>,
        /// The look-ups belong to steps whose id is a multiple of this number.
        look_up_every: u64,
        /// True for steps that block, indexed by id modulo length.
        blocks: Vec<bool>,
    },
    /// Forwards `size` tokens of its first input, then consumes a token of its second input, and starts again.
    Gate {
        /// Forwarded tokens per consumed token.
        size: u64,
    },
    /// Forwards its token to its first output, and every `size`-th token to its second output, too.
    Tap {
        /// Tokens per token of the second output.
        size: u64,
    },
    /// Consumes its token.
    Sink,
}

impl UnitKind {
    /// Returns the requests of its largest step.
    pub(super) fn requests(&self) -> &[PlanRequest] {
        match self {
            Self::Access { requests } | Self::Mixed { requests, .. } => requests,
            _ => &[],
        }
    }

    /// Returns the look-ups of its largest step.
    pub(super) fn look_ups(&self) -> &[PlanLookUp] {
        match self {
            Self::Cached { lookups, .. } | Self::Mixed { lookups, .. } => lookups,
            _ => &[],
        }
    }

    /// Returns the name of its cache.
    pub(super) fn cache(&self) -> Option<&str> {
        match self {
            Self::Cached { cache, .. } | Self::Mixed { cache, .. } => Some(cache),
            _ => None,
        }
    }
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
