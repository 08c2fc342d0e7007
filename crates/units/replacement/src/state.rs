//! What the replacement unit (110) keeps between steps.

use crate::clustering::Clustering;
use crate::policy::History;
use crate::{Gather, NearestSearch};
use basrelief_kernel::Derived;
use basrelief_shading::LEVELS;
use basrelief_signals::{MAX_SAMPLES, ObjectInfo, PseudoNormals};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::collections::VecDeque;
use std::sync::Arc;

/// A VQ table as the unit knows it: MIP level and number of entries.
pub(crate) type TableKey = (u8, u32);

/// What is left to read, or to write, of a VQ table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct TableLoad {
    pub(crate) address: u64,
    pub(crate) bytes: u64,
}

impl TableLoad {
    /// The next piece of at most `most` bytes: its address and size.
    pub(crate) fn next(&mut self, most: u64) -> (u64, u32) {
        let (address, bytes) = (self.address, self.bytes.min(most).max(1));
        self.address += bytes;
        self.bytes = self.bytes.saturating_sub(bytes);
        (address, bytes as u32)
    }
}

/// Resident tables, what waits for a table, what is gathered for a code book, and the counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplacementState {
    /// The object that the fragments belong to.
    pub(crate) object: Option<Arc<ObjectInfo>>,
    /// Polygons since the object began.
    pub(crate) polygons: u64,
    /// Level of detail of the polygon that the fragments belong to.
    pub(crate) lod: u8,
    /// What objects drew, for a policy.
    pub(crate) history: History,
    /// Tables held, most recently used first.
    pub(crate) resident: Vec<TableKey>,
    /// Tables being loaded, in order.
    pub(crate) loads: VecDeque<TableLoad>,
    /// The fragment that waits for them.
    pub(crate) pending: Option<PseudoNormals>,
    /// Code books: what is held back.
    pub(crate) gather: Gather,
    /// The clustering under way.
    pub(crate) clustering: Option<Clustering>,
    /// Search structures of the current code book.
    #[serde(skip)]
    pub(crate) book: Derived<Vec<NearestSearch>>,
    /// Levels of the samples of a stamp that found all tables resident: using them again in the same order leaves their order of
    /// use as it is, so the next stamp of the kind need not look.
    #[serde(skip)]
    pub(crate) settled: Derived<SmallVec<[u8; MAX_SAMPLES]>>,
    /// What it has counted.
    pub counters: ReplacementCounters,
}

/// What the replacement unit (110) has counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplacementCounters {
    /// Searches made, one per sample.
    pub searches: u64,
    /// VQ tables loaded.
    pub table_loads: u64,
    /// Bytes read for that.
    pub table_load_bytes: u64,
    /// Code books built.
    pub code_books: u64,
    /// Cycles of clustering.
    pub clustering_cycles: u64,
    /// Passes over all gathered N' that this took.
    pub clustering_passes: u64,
    /// Bytes of N' written for code books; as many are read back, and as many in every pass.
    pub gathered_bytes: u64,
    /// Bytes of fragments and control written beside them; as many are read back.
    pub held_beside_bytes: u64,
    /// Which indexes occurred at each level, one bit each.
    used: [Vec<u64>; LEVELS],
}

impl ReplacementCounters {
    /// Distinct indexes that occurred at each level: reference normals used. Code books share the numbering.
    pub fn reference_normals_used(&self) -> [u32; LEVELS] {
        std::array::from_fn(|k| self.used[k].iter().map(|word| word.count_ones()).sum())
    }

    /// Searches of a level found these.
    #[inline(always)]
    pub(crate) fn count_searches(&mut self, level: u8, indexes: &[u16]) {
        self.searches += indexes.len() as u64;
        let used = &mut self.used[usize::from(level).min(LEVELS - 1)];
        for index in indexes {
            let word = usize::from(*index) / 64;
            if word >= used.len() {
                used.resize(word + 1, 0);
            }
            // Mostly it is known, and a word that is not written need not be waited for when it is read again.
            if used[word] >> (index % 64) & 1 == 0 {
                used[word] |= 1 << (index % 64);
            }
        }
    }
}
