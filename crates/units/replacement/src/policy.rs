//! How the number of reference normals changes while the machine runs (stated: "dynamically").
//!
//! A policy looks at what an object drew in the last frame, never at cycles: what is drawn may not depend on when (law 6).

use crate::ReplacementConfig;
use basrelief_shading::Table;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// By which rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Policy {
    /// Not at all.
    #[default]
    Fixed,
    /// Half as many per MIP level at which the object was drawn in the last frame, on average over its fragments.
    ByLod,
    /// In proportion to the fragments that the object drew in the last frame.
    ByFragments,
}

/// Objects that are remembered; those beyond have the configured number.
pub(crate) const MOST_OBJECTS: usize = 256;

/// What an object drew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Seen {
    fragments: u64,
    /// Sum of the level of detail over them.
    lod: u64,
}

/// What each object drew in the last frame, and has drawn in this one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct History {
    last: BTreeMap<u32, Seen>,
    now: BTreeMap<u32, Seen>,
}

impl History {
    /// A frame begins.
    pub(crate) fn begin_frame(&mut self) {
        self.last = std::mem::take(&mut self.now);
    }

    /// Fragments of an object were drawn at this level of detail.
    pub(crate) fn count(&mut self, object: u32, fragments: u64, lod: u8) {
        if self.now.len() < MOST_OBJECTS || self.now.contains_key(&object) {
            let seen = self.now.entry(object).or_default();
            seen.fragments += fragments;
            seen.lod += fragments * u64::from(lod);
        }
    }

    /// Reference normals that the policy gives an object; `None` leaves it as configured.
    pub(crate) fn entries(&self, object: u32, config: &ReplacementConfig) -> Option<u32> {
        let seen = self.last.get(&object).filter(|seen| seen.fragments > 0)?;
        let most = config.entries.levels()[0];
        let wanted = match config.policy {
            Policy::Fixed => return None,
            Policy::ByLod => most >> (seen.lod / seen.fragments / 8),
            Policy::ByFragments => u32::try_from(seen.fragments / u64::from(config.fragments_per_entry))
                .unwrap_or(u32::MAX)
                .checked_next_power_of_two()?,
        };
        Some(there_is(wanted.max(config.least_entries).min(most), config.table))
    }
}

/// The largest table of at most `entries` entries.
fn there_is(entries: u32, table: Table) -> u32 {
    match table {
        Table::Fibonacci => entries.max(1),
        // 4 k^2 faces; the smallest has 4.
        Table::Tetrahedron => 4 * (entries / 4).isqrt().max(1).pow(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(policy: Policy, table: Table, fragments: u64, lod: u8) -> Option<u32> {
        let mut history = History::default();
        history.count(7, fragments, lod);
        history.begin_frame();
        history.entries(7, &ReplacementConfig { policy, table, ..ReplacementConfig::default() })
    }

    #[test]
    fn by_fragments_small_objects_get_small_tables() {
        let of = |fragments| entries(Policy::ByFragments, Table::Fibonacci, fragments, 0);
        assert_eq!([1, 64 * 16, 64 * 100, 1 << 30].map(of), [Some(16), Some(16), Some(128), Some(256)]);
        assert_eq!(of(0), None, "it was not there in the last frame");
    }

    #[test]
    fn by_lod_a_level_halves_the_table() {
        let of = |lod| entries(Policy::ByLod, Table::Fibonacci, 10, lod);
        assert_eq!([0, 7, 8, 16, 63].map(of), [Some(256), Some(256), Some(128), Some(64), Some(16)]);
        assert_eq!(entries(Policy::Fixed, Table::Fibonacci, 10, 8), None);
    }

    #[test]
    fn a_tetrahedron_gets_a_division_that_it_has() {
        let of = |lod| entries(Policy::ByLod, Table::Tetrahedron, 10, lod);
        assert_eq!([0, 8, 16].map(of), [Some(256), Some(100), Some(64)]);
    }

    #[test]
    fn memory_does_not_grow_with_the_number_of_objects() {
        let mut history = History::default();
        (0..10_000).for_each(|object| history.count(object, 1, 0));
        assert_eq!(history.now.len(), MOST_OBJECTS);
    }
}
