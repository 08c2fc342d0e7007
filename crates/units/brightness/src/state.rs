//! State of the brightness fetch unit (112) between steps.

use crate::ClutKey;
use crate::sets::ClutSets;
use basrelief_shading::TablePlaces;
use basrelief_signals::{Frame, NormalIndexes, ObjectInfo};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A recalculation in progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ClutRebuild {
    /// Level being written.
    pub(crate) level: u8,
    /// Entries of the level.
    pub(crate) entries: usize,
    /// Reference normals read so far.
    pub(crate) read: usize,
    /// Entries calculated so far.
    pub(crate) calculated: usize,
    /// Entries of the level written so far.
    pub(crate) written: usize,
}

/// Frame, object and lighting of the next fragments, the CLUTs with their keys, and the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BrightnessFetchState {
    pub(crate) frame: Option<Arc<Frame>>,
    pub(crate) object: Option<Arc<ObjectInfo>>,
    /// Addresses of the VQ tables (121).
    pub(crate) places: TablePlaces,
    /// Lighting of the next fragments.
    pub(crate) wanted: ClutKey,
    /// True if frame or object changed, so that `wanted.lights` must be evaluated again.
    pub(crate) lights_changed: bool,
    /// Sets in memory (120).
    pub(crate) sets: ClutSets,
    pub(crate) rebuild: Option<ClutRebuild>,
    /// Fragment that waits for a recalculation.
    pub(crate) pending: Option<NormalIndexes>,
    /// Counters.
    pub counters: BrightnessFetchCounters,
}

/// Counters of the brightness fetch unit (112).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrightnessFetchCounters {
    /// Fragments shaded.
    pub fragments: u64,
    /// CLUT entries read, or computed if the source is direct.
    pub samples: u64,
    /// Calculations of the CLUT of a level.
    pub rebuilds: u64,
    /// Cycles of recalculation.
    pub rebuild_cycles: u64,
    /// Bytes of entries written by recalculation.
    pub rebuild_bytes: u64,
    /// Bytes of reference normals read by recalculation.
    pub normal_bytes: u64,
}
