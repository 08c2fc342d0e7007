//! State of the replacement unit (110) between steps.

use crate::NearestSearch;
use crate::clustering::Clustering;
use crate::gather::{GatheredBatch, TableLoad};
use crate::policy::FragmentHistory;
use basrelief_kernel::Cached;
use basrelief_shading::{LEVELS, TablePlaces};
use basrelief_signals::{MAX_SAMPLES, ObjectInfo, PseudoNormals};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::collections::VecDeque;
use std::sync::Arc;

/// Key of a VQ table: MIP level and number of entries.
pub(crate) type TableKey = (u8, u32);

/// Resident tables, the fragment that waits for a table, data gathered for a code book, and the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplacementState {
    /// Object of the current fragments.
    pub(crate) object: Option<Arc<ObjectInfo>>,
    /// Polygons since the object began.
    pub(crate) polygons: u64,
    /// Level of detail of the polygon of the current fragments.
    pub(crate) lod: u8,
    /// Fragments drawn per object, for a policy.
    pub(crate) history: FragmentHistory,
    /// Addresses of the tables.
    pub(crate) places: TablePlaces,
    /// Resident tables, most recently used first.
    pub(crate) resident: Vec<TableKey>,
    /// Tables being loaded, in order.
    pub(crate) loads: VecDeque<TableLoad>,
    /// Fragment that waits for the tables being loaded.
    pub(crate) pending: Option<PseudoNormals>,
    /// Data held for a code book.
    pub(crate) gather: GatheredBatch,
    /// Clustering in progress.
    pub(crate) clustering: Option<Clustering>,
    /// Search structures of the current code book.
    #[serde(skip)]
    pub(crate) book: Cached<Vec<NearestSearch>>,
    /// Levels of the samples of a stamp that found all tables resident. The same levels in the same order leave the order of use
    /// unchanged, so the next such stamp needs no look-up.
    #[serde(skip)]
    pub(crate) settled: Cached<SmallVec<[u8; MAX_SAMPLES]>>,
    /// Counters.
    pub counters: ReplacementCounters,
}

/// Counters of the replacement unit (110).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplacementCounters {
    /// Searches, one per sample.
    pub searches: u64,
    /// VQ tables loaded.
    pub table_loads: u64,
    /// Bytes read for table loads.
    pub table_load_bytes: u64,
    /// Code books built.
    pub code_books: u64,
    /// Cycles of clustering.
    pub clustering_cycles: u64,
    /// Passes over all gathered N'.
    pub clustering_passes: u64,
    /// Bytes of N' written for code books. Each later pass reads as many.
    pub gathered_bytes: u64,
    /// Bytes of fragments and control written beside N'. As many are read back.
    pub held_beside_bytes: u64,
    /// Indexes that occurred at each level, one bit each.
    used: [Vec<u64>; LEVELS],
}

impl ReplacementCounters {
    /// Returns the number of distinct indexes at each level: reference normals used. Code books share the numbering.
    pub fn reference_normals_used(&self) -> [u32; LEVELS] {
        std::array::from_fn(|k| self.used[k].iter().map(|word| word.count_ones()).sum())
    }

    /// Counts searches of a level with these results.
    #[inline(always)]
    pub(crate) fn count_searches(&mut self, level: u8, indexes: &[u16]) {
        self.searches += indexes.len() as u64;
        let used = &mut self.used[usize::from(level).min(LEVELS - 1)];
        for index in indexes {
            let word = usize::from(*index) / 64;
            if word >= used.len() {
                used.resize(word + 1, 0);
            }
            // In most cases the bit is set. A word that is not written causes no store-to-load stall.
            if used[word] >> (index % 64) & 1 == 0 {
                used[word] |= 1 << (index % 64);
            }
        }
    }
}
