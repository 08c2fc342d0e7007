//! What the brightness fetch unit (112) keeps between steps.

use crate::ClutKey;
use crate::sets::ClutSets;
use basrelief_signals::{Frame, NormalIndexes, ObjectInfo};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A recalculation under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Rebuild {
    /// Level being written.
    pub(crate) level: u8,
    /// Entries that it has.
    pub(crate) entries: usize,
    /// Reference normals read so far.
    pub(crate) read: usize,
    /// Entries of it written so far.
    pub(crate) written: usize,
}

/// Frame, object and what the next fragments ask for; the CLUTs and what they were calculated for; the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BrightnessFetchState {
    pub(crate) frame: Option<Arc<Frame>>,
    pub(crate) object: Option<Arc<ObjectInfo>>,
    /// What the fragments that come are to be lit with.
    pub(crate) wanted: ClutKey,
    /// `wanted.lights` is to be evaluated again: frame or object changed.
    pub(crate) lights_changed: bool,
    /// What memory (120) holds.
    pub(crate) sets: ClutSets,
    pub(crate) rebuild: Option<Rebuild>,
    /// The fragment that waits for it.
    pub(crate) pending: Option<NormalIndexes>,
    /// What it has counted.
    pub counters: BrightnessFetchCounters,
}

/// What the brightness fetch unit (112) has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrightnessFetchCounters {
    /// Fragments that got a brightness.
    pub fragments: u64,
    /// CLUT entries read, or computed where the source is direct.
    pub samples: u64,
    /// Times that the CLUT of a level was calculated.
    pub rebuilds: u64,
    /// Cycles of that.
    pub rebuild_cycles: u64,
    /// Bytes of entries written for that.
    pub rebuild_bytes: u64,
    /// Bytes of reference normals read for that.
    pub normal_bytes: u64,
}
