//! What the normal-vector mapping unit (108) keeps between steps.

use crate::DistinctCounter;
use basrelief_shading::LevelSet;
use basrelief_signals::{MAX_SAMPLES, Polygon};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The polygon being mapped, what follows from it, and the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalMappingState {
    /// The fragments that come are of this polygon.
    pub polygon: Option<Arc<Polygon>>,
    /// MIP levels that its LOD selects.
    pub levels: LevelSet,
    /// Where each selected level of its normal map starts \[texels\].
    pub base: [u64; MAX_SAMPLES],
    /// What was counted.
    pub counters: Counters,
}

/// What the unit counts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counters {
    /// Fragments mapped.
    pub fragments: u64,
    /// Of these, fragments of bump targets.
    pub bump_fragments: u64,
    /// Texels used; several may lie in one cache line.
    pub texels: u64,
    /// Pseudo-normals handed on.
    pub pseudo_normals: u64,
    /// How many of them were distinct.
    pub distinct: DistinctCounter,
}
