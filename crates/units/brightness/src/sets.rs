//! Sets of CLUTs (122) in memory (120), one per material and lights. As many are held as fit, and the least recently used is
//! replaced.

use crate::clut::EntryScale;
use crate::{BrightnessConfig, ClutKey, ClutLevels};
use basrelief_kernel::UnitTable;
use basrelief_kernel::stats::UnitStats;
use basrelief_shading::{LEVELS, TableError};
use basrelief_signals::quantization_memory::{CLUTS, OTHER_TABLES, clut_stride};
use serde::{Deserialize, Serialize};

/// Number of a material, or of the lights as seen from an object \[bits\]. Assumed: as the numbers of material and object in the head of
/// a polygon, and the host gives equal materials, and equal lights, the same number.
const NUMBER: u32 = 32;
/// Number of reference normals that an object fixes, up to 2^16, and a bit for a code book \[bits\].
const TABLE: u32 = 17 + 1;

/// Reports the directory of the sets: the key, a valid bit, and a bit for each calculated level.
pub(crate) fn tell_directory(config: &BrightnessConfig, stats: &mut UnitStats) {
    stats.directory("sets of CLUTs: key, valid, levels, order of use", config.sets, &[NUMBER, NUMBER, TABLE], 1 + LEVELS as u32);
}

/// A set: its key, its position, and the levels calculated so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClutSet {
    key: ClutKey,
    /// Number of its space in memory.
    place: usize,
    clut: ClutLevels,
}

/// Sets in memory, most recently used first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClutSets {
    sets: Vec<ClutSet>,
    /// Distance between two levels of a set \[bytes\].
    stride: u64,
    /// True if the first set matches the current key.
    found: bool,
}

impl ClutSets {
    /// Selects the set of `key`, which may be a new one. `entries` is the size of its largest level. Spaces are laid out for the
    /// largest set. If that grows, all sets are lost.
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
        let room = (OTHER_TABLES - CLUTS) / (LEVELS as u64 * self.stride).max(1);
        let most = u64::from(config.sets).min(room).max(1) as usize;
        self.sets.truncate(most - 1);
        let is_free = |place: &usize| self.sets.iter().all(|set| set.place != *place);
        let place = (0..most).find(is_free).unwrap_or(0);
        self.sets.insert(0, ClutSet { key: key.clone(), place, clut: ClutLevels::default() });
    }

    /// Marks the current key as changed.
    pub(crate) fn lose_sight(&mut self) {
        self.found = false;
    }

    /// Returns true if the first set matches the current key.
    #[inline]
    pub(crate) fn has_found(&self) -> bool {
        self.found
    }

    /// Drops the sets of code books, whose reference normals no longer exist.
    pub(crate) fn drop_books(&mut self) {
        self.sets.retain(|set| set.key.book.is_none());
    }

    /// Returns true if the current set has this level.
    #[inline]
    pub(crate) fn has(&self, level: u8) -> bool {
        self.sets.first().is_some_and(|set| set.clut.has(level))
    }

    /// Calculates a level of the current set. Returns its number of entries.
    ///
    /// # Errors
    /// Returns the error of `entries_of`.
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

    /// Returns the brightness by index in the current set.
    #[inline]
    pub(crate) fn entries(&self, level: u8) -> &[[f32; 2]] {
        self.sets.first().map_or(&[], |set| set.clut.entries(level))
    }

    /// Returns the calculated levels of all sets, with their addresses and the full scale of their first value in single precision.
    pub(crate) fn twin_tables(&self, config: &BrightnessConfig) -> impl Iterator<Item = UnitTable> {
        self.sets.iter().flat_map(|set| {
            (0..LEVELS as u8).filter(|level| set.clut.has(*level)).map(|level| {
                let address = CLUTS + (set.place * LEVELS + usize::from(level)) as u64 * self.stride;
                let scale = EntryScale::new(config, &set.key);
                let steps = |entry: &[f32; 2]| vec![scale.steps_of(entry[0])];
                let entries = set.clut.entries(level).iter().map(steps).collect();
                let name = format!("clut.{address}.{:08x}", scale.full_scale().to_bits());
                UnitTable { name, bits: config.bits, entries }
            })
        })
    }

    /// Returns the start of a level of the current set \[bytes\].
    #[inline]
    pub(crate) fn address(&self, level: u8) -> u64 {
        let place = self.sets.first().map_or(0, |set| set.place);
        CLUTS + (place * LEVELS + usize::from(level).min(LEVELS - 1)) as u64 * self.stride
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_kernel::HardwareKind;

    #[test]
    fn each_set_has_registers_and_a_comparator() {
        let of = |sets| {
            let mut stats = UnitStats::default();
            tell_directory(&BrightnessConfig { sets, ..BrightnessConfig::default() }, &mut stats);
            stats.all_hardware().iter().map(|piece| (piece.kind, piece.count, piece.width)).collect::<Vec<_>>()
        };
        let (adder, registers) = (HardwareKind::Adder, HardwareKind::Registers);
        // Two numbers of 32 bits, 18 bits of the table, a valid bit and one for each of eight levels.
        assert_eq!(of(1), [(adder, 1, 32), (adder, 1, 32), (adder, 1, 18), (registers, 1, 91)]);
        assert_eq!(of(16)[2..], [(adder, 16, 18), (adder, 32, 4), (registers, 16, 95)]);
        assert_eq!(of(4096)[3..], [(adder, 8192, 12), (registers, 4096, 103)]);
    }

    fn key(entries: u32) -> ClutKey {
        ClutKey { entries: Some(entries), ..ClutKey::default() }
    }

    #[test]
    fn least_recently_used_set_is_replaced() {
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
    fn larger_set_lays_spaces_out_anew() {
        let mut sets = ClutSets::default();
        sets.select(&key(1), 64, &BrightnessConfig::default());
        sets.calculate(3, |_| Ok(vec![])).unwrap();
        sets.select(&key(2), 1_000, &BrightnessConfig::default());
        assert_eq!((sets.address(1) - CLUTS, sets.sets.len()), (1_024, 1));
    }

    #[test]
    fn sets_never_exceed_memory() {
        let (config, mut sets) = (BrightnessConfig { sets: 64, ..BrightnessConfig::default() }, ClutSets::default());
        (0..100).for_each(|k| sets.select(&key(k), 65_536, &config));
        assert_eq!(sets.sets.len(), 24, "12 MiB of 8 levels of 64 KiB");
    }
}
