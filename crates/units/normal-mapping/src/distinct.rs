//! How many distinct pseudo-normals there were: what claim 3 compares the table size with.

use serde::{Deserialize, Serialize};

/// Counts distinct normals exactly up to [`DistinctCounter::LIMIT`], then says "at least".
///
/// Open addressing with linear probing, at most half full, so that an insertion costs a few nanoseconds; once the limit
/// is reached it costs one comparison. A hash set of the standard library was rejected: twice the cost, and no bound.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DistinctCounter {
    /// A power of two of slots, 0 = free; keys have bit 48 set.
    slots: Vec<u64>,
    count: u32,
}

impl DistinctCounter {
    /// Most normals that are told apart.
    pub const LIMIT: u32 = 65_536;

    /// Distinct normals seen, at most [`Self::LIMIT`].
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Whether there may have been more than [`Self::count`].
    pub fn is_saturated(&self) -> bool {
        self.count >= Self::LIMIT
    }

    /// Takes note of a normal.
    #[inline]
    pub fn insert(&mut self, normal: [i16; 3]) {
        if !self.is_saturated() {
            let [x, y, z] = normal.map(|c| u64::from(c as u16));
            self.insert_key(1 << 48 | x << 32 | y << 16 | z);
        }
    }

    fn insert_key(&mut self, key: u64) {
        if self.count as usize * 2 >= self.slots.len() {
            self.grow();
        }
        if place(&mut self.slots, key) {
            self.count += 1;
        }
    }

    fn grow(&mut self) {
        let mut larger = vec![0; (self.slots.len() * 4).clamp(4_096, 2 * Self::LIMIT as usize)];
        for &key in self.slots.iter().filter(|k| **k != 0) {
            place(&mut larger, key);
        }
        self.slots = larger;
    }
}

/// Puts `key` into the first free slot of its chain; `false` where it is there already. `slots` is never full.
fn place(slots: &mut [u64], key: u64) -> bool {
    let mask = slots.len() - 1;
    // Fibonacci hashing: the high bits of the product are well mixed.
    let mut at = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as usize & mask;
    loop {
        if slots[at] == 0 {
            slots[at] = key;
            return true;
        }
        if slots[at] == key {
            return false;
        }
        at = (at + 1) & mask;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn counts_like_a_set(normals in prop::collection::vec(prop::array::uniform3(-9i16..9), 0..3_000)) {
            let mut counter = DistinctCounter::default();
            normals.iter().for_each(|&n| counter.insert(n));
            let set: BTreeSet<_> = normals.into_iter().collect();
            prop_assert_eq!(counter.count() as usize, set.len());
        }
    }

    #[test]
    fn stops_at_the_limit() {
        let mut counter = DistinctCounter::default();
        for i in 0..200_000_u32 {
            counter.insert([(i >> 16) as i16, i as i16, 7]);
            assert_eq!(counter.count(), (i + 1).min(DistinctCounter::LIMIT));
        }
        assert!(counter.is_saturated());
        assert_eq!(counter.slots.len(), 2 * DistinctCounter::LIMIT as usize);
    }
}
