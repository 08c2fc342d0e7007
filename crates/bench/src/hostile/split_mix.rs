//! Deterministic random numbers.

/// Random generator (SplitMix64).
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// Creates the generator of one case.
    pub fn of(seed: u64, kind: u64, number: u64) -> Self {
        let mut random = Self(seed);
        for part in [kind, number] {
            random.0 = random.next() ^ part;
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number below `end`, or 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// Returns true once in `times` calls on average.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// Returns one of these values.
    ///
    /// # Panics
    /// Panics if there is none.
    pub fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// Returns any byte, unusual ones more often.
    pub fn byte(&mut self) -> u8 {
        const ODD: [u8; 8] = [0, 1, 0x20, 0x7f, 0x80, 0xfe, 0xff, b'9'];
        if self.once_in(2) { *self.one(&ODD) } else { self.next() as u8 }
    }
}
