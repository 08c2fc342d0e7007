//! Policies that change the number of reference normals while the machine runs (stated: "dynamically").
//!
//! A policy depends on the fragments that an object drew in the last frame, never on cycles, because the picture must not depend
//! on time (law 6).

use crate::{ReplacementConfig, TablePolicy};
use basrelief_shading::ReferenceNormals;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Maximum number of objects that are remembered. Further objects have the configured number.
pub(crate) const MOST_OBJECTS: usize = 256;

/// Fragments of an object in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ObjectFragments {
    fragments: u64,
    /// Sum of the level of detail over the fragments.
    lod: u64,
}

/// Fragments of each object in the last frame and in the current one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FragmentHistory {
    last: BTreeMap<u32, ObjectFragments>,
    now: BTreeMap<u32, ObjectFragments>,
}

impl FragmentHistory {
    /// Begins a frame.
    pub(crate) fn begin_frame(&mut self) {
        self.last = std::mem::take(&mut self.now);
    }

    /// Counts fragments of an object at this level of detail.
    pub(crate) fn count(&mut self, object: u32, fragments: u64, lod: u8) {
        if self.now.len() < MOST_OBJECTS || self.now.contains_key(&object) {
            let seen = self.now.entry(object).or_default();
            seen.fragments += fragments;
            seen.lod += fragments * u64::from(lod);
        }
    }

    /// Returns the number of reference normals that the policy gives an object. `None` leaves it as configured.
    pub(crate) fn entries(&self, object: u32, config: &ReplacementConfig) -> Option<u32> {
        let seen = self.last.get(&object).filter(|seen| seen.fragments > 0)?;
        let most = config.entries.levels()[0];
        let wanted = match config.policy {
            TablePolicy::Fixed => return None,
            TablePolicy::ByLod => most >> (seen.lod / seen.fragments / 8),
            TablePolicy::ByFragments => u32::try_from(seen.fragments / u64::from(config.fragments_per_entry))
                .unwrap_or(u32::MAX)
                .checked_next_power_of_two()?,
        };
        Some(there_is(wanted.max(config.least_entries).min(most), config.table))
    }
}

/// Returns the size of the largest table of at most `entries` entries.
fn there_is(entries: u32, table: ReferenceNormals) -> u32 {
    match table {
        ReferenceNormals::Fibonacci => entries.max(1),
        // 4 k^2 faces, at least 4.
        ReferenceNormals::Tetrahedron => 4 * (entries / 4).isqrt().max(1).pow(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(policy: TablePolicy, table: ReferenceNormals, fragments: u64, lod: u8) -> Option<u32> {
        let mut history = FragmentHistory::default();
        history.count(7, fragments, lod);
        history.begin_frame();
        history.entries(7, &ReplacementConfig { policy, table, ..ReplacementConfig::default() })
    }

    #[test]
    fn by_fragments_gives_small_objects_small_tables() {
        let of = |fragments| entries(TablePolicy::ByFragments, ReferenceNormals::Fibonacci, fragments, 0);
        assert_eq!([1, 64 * 16, 64 * 100, 1 << 30].map(of), [Some(16), Some(16), Some(128), Some(256)]);
        assert_eq!(of(0), None, "it was not there in the last frame");
    }

    #[test]
    fn by_lod_halves_table_per_level() {
        let of = |lod| entries(TablePolicy::ByLod, ReferenceNormals::Fibonacci, 10, lod);
        assert_eq!([0, 7, 8, 16, 63].map(of), [Some(256), Some(256), Some(128), Some(64), Some(16)]);
        assert_eq!(entries(TablePolicy::Fixed, ReferenceNormals::Fibonacci, 10, 8), None);
    }

    #[test]
    fn policy_selects_existing_tetrahedron_division() {
        let of = |lod| entries(TablePolicy::ByLod, ReferenceNormals::Tetrahedron, 10, lod);
        assert_eq!([0, 8, 16].map(of), [Some(256), Some(100), Some(64)]);
    }

    #[test]
    fn history_size_is_bounded() {
        let mut history = FragmentHistory::default();
        (0..10_000).for_each(|object| history.count(object, 1, 0));
        assert_eq!(history.now.len(), MOST_OBJECTS);
    }
}
