//! The FIFOs or clients of a stage, by number.

use crate::wiring::MAX_LINKS;

/// Up to eight numbers, in one piece with what they belong to: a vector of each stage's would lie elsewhere, and be asked for in
/// every step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    count: u8,
    numbers: [u16; MAX_LINKS],
}

impl Ends {
    pub(super) fn new(numbers: &[usize]) -> Self {
        let mut ends = Self { count: numbers.len() as u8, ..Self::default() };
        for (end, &number) in ends.numbers.iter_mut().zip(numbers) {
            *end = number as u16;
        }
        ends
    }

    /// How many there are; with `known` the compiler knows it, too.
    #[inline(always)]
    pub(super) fn count(&self, known: Option<usize>) -> usize {
        known.unwrap_or(usize::from(self.count))
    }

    /// The number at place `i`.
    #[inline(always)]
    pub(super) fn at(&self, i: usize) -> usize {
        usize::from(self.numbers[i % MAX_LINKS])
    }

    /// A bit for each.
    #[inline(always)]
    pub(super) fn all(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Those of these bits, with their places, in order.
    #[inline(always)]
    pub(super) fn of(&self, mut bits: u32) -> impl Iterator<Item = (usize, usize)> + use<> {
        let ends = *self;
        std::iter::from_fn(move || {
            if bits == 0 {
                return None;
            }
            let place = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            Some((place, ends.at(place)))
        })
    }

    /// Shows `see` the numbers of these bits in order. Where it is known how many there can be, the compiler unrolls it.
    #[inline(always)]
    pub(super) fn each(&self, bits: u32, known: Option<usize>, mut see: impl FnMut(usize)) {
        let Some(count) = known else {
            self.of(bits).for_each(|(_, number)| see(number));
            return;
        };
        for place in 0..count {
            if bits & 1 << place != 0 {
                see(self.at(place));
            }
        }
    }
}
