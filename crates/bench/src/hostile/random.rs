//! Random choices.

use basrelief_dse::SplitMix64;

/// Creates the generator of one case.
pub fn random_of(seed: u64, kind: u64, number: u64) -> SplitMix64 {
    [kind, number].into_iter().fold(SplitMix64::new(seed), |mut random, part| SplitMix64::new(random.next_u64() ^ part))
}

/// Random choices of a generator.
pub trait RandomChoice {
    /// Returns true once in `times` calls on average.
    fn once_in(&mut self, times: usize) -> bool;

    /// Returns one of these values.
    ///
    /// # Panics
    /// Panics if there is none.
    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T;

    /// Returns any byte, unusual ones more often.
    fn byte(&mut self) -> u8;
}

impl RandomChoice for SplitMix64 {
    fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    fn byte(&mut self) -> u8 {
        const ODD: [u8; 8] = [0, 1, 0x20, 0x7f, 0x80, 0xfe, 0xff, b'9'];
        if self.once_in(2) { *self.one(&ODD) } else { self.next_u64() as u8 }
    }
}
