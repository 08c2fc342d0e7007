//! Addresses of the VQ tables (121) in memory (120).

use crate::lod::LEVELS;
use crate::reference_normals::TableSet;
use basrelief_signals::quantization_memory::{GATHERED, OTHER_TABLES, vq_table};

/// Granularity of the addresses of tables of other sizes \[bytes\].
const ALIGNMENT: u64 = 64;

/// Directory of the VQ tables (121) whose size is not the configured one. Objects, or a policy, select such sizes.
///
/// Memory (120) holds the tables of every selected size for all levels, each at its own address, and keeps them. As all VQ tables,
/// they are prepared in advance. Each unit with access to them follows the objects and has the same directory.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct TablePlaces {
    /// Sizes in order of their first selection: entries, and the address of level 0.
    sizes: Vec<(u32, u64)>,
    /// Bytes in use.
    bytes: u64,
}

/// Tables that exceed their room in memory (120).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "VQ tables of {sizes} further sizes need {needed} bytes of memory (120), expected at most {}; let objects share sizes",
    GATHERED - OTHER_TABLES
)]
pub struct TableRoomError {
    sizes: usize,
    needed: u64,
}

impl TablePlaces {
    /// Adds the tables of `entries` entries, unless this is the configured size of all levels.
    ///
    /// # Errors
    /// Returns an error if they exceed the room in memory. Then nothing changes.
    pub fn hold(&mut self, set: &TableSet, entries: u32) -> Result<(), TableRoomError> {
        if set.entries.iter().all(|&own| own == entries) || self.sizes.iter().any(|&(held, _)| held == entries) {
            return Ok(());
        }
        let needed = self.bytes + LEVELS as u64 * stride(set, entries);
        if OTHER_TABLES + needed > GATHERED {
            return Err(TableRoomError { sizes: self.sizes.len() + 1, needed });
        }
        self.sizes.push((entries, OTHER_TABLES + self.bytes));
        self.bytes = needed;
        Ok(())
    }

    /// Returns the address of a level's table of `entries` entries. Call [`TablePlaces::hold`] first if that is not the
    /// configured size.
    pub fn address(&self, set: &TableSet, level: u8, entries: u32) -> u64 {
        let level = level.min(LEVELS as u8 - 1);
        let other = self.sizes.iter().find(|&&(held, _)| held == entries && set.entries[usize::from(level)] != entries);
        other.map_or(vq_table(level), |(_, first)| first + u64::from(level) * stride(set, entries))
    }

    /// Returns the bytes of the tables of other sizes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// Returns the distance between the tables of two levels \[bytes\].
fn stride(set: &TableSet, entries: u32) -> u64 {
    (u64::from(entries) * u64::from(set.entry_bytes())).next_multiple_of(ALIGNMENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReferenceNormals;

    fn set() -> TableSet {
        TableSet { entries: [256; LEVELS], table: ReferenceNormals::Fibonacci, distinct: true, entry_bits: 16 }
    }

    #[test]
    fn tables_of_all_sizes_are_apart() {
        let (set, mut places) = (set(), TablePlaces::default());
        let sizes = [256, 64, 100, 128, 64, 1];
        sizes.iter().for_each(|&entries| places.hold(&set, entries).unwrap());
        let end = |&(first, entries): &(u64, u32)| first + u64::from(entries * set.entry_bytes());
        let levels = |entries| (0..LEVELS as u8).map(move |level| (level, entries));
        let mut tables: Vec<(u64, u32)> =
            [256, 64, 100, 128, 1].into_iter().flat_map(levels).map(|(l, n)| (places.address(&set, l, n), n)).collect();
        tables.sort_unstable();
        assert!(tables.windows(2).all(|pair| end(&pair[0]) <= pair[1].0), "{tables:?}");
        assert_eq!(places.address(&set, 3, 256), vq_table(3), "the configured size");
        assert_eq!(places.bytes(), 8 * (384 + 640 + 768 + 64));
    }

    #[test]
    fn tables_beyond_their_room_are_an_error() {
        let (set, mut places) = (set(), TablePlaces::default());
        let error = (1..=65_536).rev().find_map(|entries| places.hold(&set, entries).err()).unwrap();
        assert!(places.bytes() <= GATHERED - OTHER_TABLES && error.to_string().contains("let objects share sizes"), "{error}");
    }
}
