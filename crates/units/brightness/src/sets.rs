//! Sets of CLUTs (122) in memory (120): one per material and lights, as many as fit, the least recently used replaced.

use crate::{BrightnessConfig, Clut, ClutKey};
use basrelief_shading::{LEVELS, TableError};
use basrelief_signals::quantization_memory::{CLUTS, GATHERED, clut_stride};
use serde::{Deserialize, Serialize};

/// A set: what it was calculated for, where it lies, and the levels calculated so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClutSet {
    key: ClutKey,
    /// Number of its room.
    place: usize,
    clut: Clut,
}

/// The sets that are held, the most recently used first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClutSets {
    sets: Vec<ClutSet>,
    /// Distance of two levels of a set \[bytes\].
    stride: u64,
    /// The first set holds what is wanted.
    found: bool,
}

impl ClutSets {
    /// Goes to the set of `key`, which may be a new one; `entries` are those of its largest level. Rooms are laid out for the
    /// largest set: where that grows, all sets are lost.
    pub(crate) fn select(&mut self, key: &ClutKey, entries: usize, config: &BrightnessConfig) {
        let stride = clut_stride(entries, config.entry_bytes());
        if stride > self.stride {
            self.sets.clear();
            self.stride = stride;
        }
        self.found = true;
        if let Some(at) = self.sets.iter().position(|set| set.key == *key) {
            self.sets[..=at].rotate_right(1);
            return;
        }
        let room = (GATHERED - CLUTS) / (LEVELS as u64 * self.stride).max(1);
        let most = u64::from(config.sets).min(room).max(1) as usize;
        self.sets.truncate(most - 1);
        let is_free = |place: &usize| self.sets.iter().all(|set| set.place != *place);
        let place = (0..most).find(is_free).unwrap_or(0);
        self.sets.insert(0, ClutSet { key: key.clone(), place, clut: Clut::default() });
    }

    /// What is wanted may have changed.
    pub(crate) fn lose_sight(&mut self) {
        self.found = false;
    }

    /// Whether the first set is the one that is wanted.
    #[inline]
    pub(crate) fn has_found(&self) -> bool {
        self.found
    }

    /// Drops sets of code books: their reference normals are no more.
    pub(crate) fn drop_books(&mut self) {
        self.sets.retain(|set| set.key.book.is_none());
    }

    /// Whether the set in use has this level.
    #[inline]
    pub(crate) fn has(&self, level: u8) -> bool {
        self.sets.first().is_some_and(|set| set.clut.has(level))
    }

    /// Gives the set in use a level: its number of entries.
    ///
    /// # Errors
    /// As `entries_of`.
    pub(crate) fn calculate(
        &mut self,
        level: u8,
        entries_of: impl FnOnce(&ClutKey) -> Result<Vec<[f32; 2]>, TableError>,
    ) -> Result<usize, TableError> {
        let Some(set) = self.sets.first_mut() else { return Ok(0) };
        let entries = entries_of(&set.key)?;
        let count = entries.len();
        set.clut.set(level, entries);
        Ok(count)
    }

    /// Brightness by index in the set in use.
    #[inline]
    pub(crate) fn entries(&self, level: u8) -> &[[f32; 2]] {
        self.sets.first().map_or(&[], |set| set.clut.entries(level))
    }

    /// Where a level of the set in use starts \[bytes\].
    #[inline]
    pub(crate) fn address(&self, level: u8) -> u64 {
        let place = self.sets.first().map_or(0, |set| set.place);
        CLUTS + (place * LEVELS + usize::from(level).min(LEVELS - 1)) as u64 * self.stride
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(entries: u32) -> ClutKey {
        ClutKey { entries: Some(entries), ..ClutKey::default() }
    }

    #[test]
    fn the_least_recently_used_set_goes_first() {
        let config = BrightnessConfig { sets: 2, ..BrightnessConfig::default() };
        let mut sets = ClutSets::default();
        let mut is_there = |k: u32| {
            sets.select(&key(k), 64, &config);
            let there = sets.has(0);
            sets.calculate(0, |_| Ok(vec![[k as f32; 2]])).unwrap();
            assert_eq!(sets.entries(0), [[k as f32; 2]]);
            (there, sets.address(0) - CLUTS)
        };
        let room = LEVELS as u64 * 64;
        assert_eq!([1, 2, 1].map(&mut is_there), [(false, 0), (false, room), (true, 0)]);
        assert_eq!([3, 1, 2].map(&mut is_there), [(false, room), (true, 0), (false, room)], "3 takes the room of 2");
    }

    #[test]
    fn a_larger_set_lays_the_rooms_out_anew() {
        let mut sets = ClutSets::default();
        sets.select(&key(1), 64, &BrightnessConfig::default());
        sets.calculate(3, |_| Ok(vec![])).unwrap();
        sets.select(&key(2), 1_000, &BrightnessConfig::default());
        assert_eq!((sets.address(1) - CLUTS, sets.sets.len()), (1_024, 1));
    }

    #[test]
    fn no_more_sets_than_there_is_room_for() {
        let (config, mut sets) = (BrightnessConfig { sets: 64, ..BrightnessConfig::default() }, ClutSets::default());
        (0..100).for_each(|k| sets.select(&key(k), 65_536, &config));
        assert_eq!(sets.sets.len(), 24, "12 MiB of 8 levels of 64 KiB");
    }
}
