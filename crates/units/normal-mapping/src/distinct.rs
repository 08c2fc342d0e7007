//! Number of distinct pseudo-normals, which claim 3 compares with the table size.

use serde::{Deserialize, Serialize};

/// Counter of distinct normals. It is exact up to [`DistinctCounter::LIMIT`], then a lower bound.
///
/// The hash set uses open addressing with linear probing and is at most half full, so that an insertion costs a few nanoseconds.
/// At the limit it costs one comparison. A hash set of the standard library was rejected: twice the cost, and no bound.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DistinctCounter {
    /// Slots, a power of two in number. 0 marks a free slot, and keys have bit 48 set.
    slots: Vec<u64>,
    count: u32,
}

impl DistinctCounter {
    /// Maximum number of normals that are counted.
    pub const LIMIT: u32 = 65_536;

    /// Returns the number of distinct normals seen, at most [`Self::LIMIT`].
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Returns true if there may have been more than [`Self::count`].
    pub fn is_saturated(&self) -> bool {
        self.count >= Self::LIMIT
    }

    /// Counts a normal if it is new.
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

/// Puts `key` into the first free slot of its chain. Returns false if it is already present. `slots` is never full.
fn place(slots: &mut [u64], key: u64) -> bool {
    let mask = slots.len() - 1;
    // Fibonacci hashing mixes the high bits of the product well.
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
        fn distinct_counter_equals_a_set(normals in prop::collection::vec(prop::array::uniform3(-9i16..9), 0..3_000)) {
            let mut counter = DistinctCounter::default();
            normals.iter().for_each(|&n| counter.insert(n));
            let set: BTreeSet<_> = normals.into_iter().collect();
            prop_assert_eq!(counter.count() as usize, set.len());
        }
    }

    #[test]
    fn distinct_counter_saturates_at_limit() {
        let mut counter = DistinctCounter::default();
        for i in 0..200_000_u32 {
            counter.insert([(i >> 16) as i16, i as i16, 7]);
            assert_eq!(counter.count(), (i + 1).min(DistinctCounter::LIMIT));
        }
        assert!(counter.is_saturated());
        assert_eq!(counter.slots.len(), 2 * DistinctCounter::LIMIT as usize);
    }
}
