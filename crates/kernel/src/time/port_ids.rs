//! The FIFOs or clients of a stage, by number.

use super::FifoTiming;
use crate::capacity::MAX_LINKS;

/// Up to eight numbers, in one piece with what they belong to: a vector of each stage's would lie elsewhere, and be asked for in
/// every step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PortIds {
    count: u8,
    numbers: [u16; MAX_LINKS],
}

impl PortIds {
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

    /// The FIFOs of these numbers: looked up once where the compiler knows how many there are, otherwise as they are used.
    #[inline(always)]
    pub(super) fn join(self, fifos: &[FifoTiming], known: Option<usize>) -> ConnectedFifos<'_> {
        let mut slots = [None; MAX_LINKS];
        for (place, slot) in slots.iter_mut().enumerate().take(known.unwrap_or(0)) {
            *slot = Some(&fifos[self.at(place)]);
        }
        ConnectedFifos { ends: self, fifos, slots }
    }
}

/// The FIFOs at one side of a stage.
#[derive(Clone, Copy)]
pub(super) struct ConnectedFifos<'a> {
    ends: PortIds,
    fifos: &'a [FifoTiming],
    /// As many as the compiler knows of.
    slots: [Option<&'a FifoTiming>; MAX_LINKS],
}

impl<'a> ConnectedFifos<'a> {
    /// How many there are; with `known` the compiler knows it, too.
    #[inline(always)]
    pub(super) fn count(&self, known: Option<usize>) -> usize {
        self.ends.count(known)
    }

    /// A bit for each.
    #[inline(always)]
    pub(super) fn all(&self, known: Option<usize>) -> u32 {
        (1 << self.count(known)) - 1
    }

    /// Shows `see` those of these bits in order, with their places. Where it is known how many there can be, the compiler unrolls it.
    #[inline(always)]
    pub(super) fn each(&self, bits: u32, known: Option<usize>, mut see: impl FnMut(usize, &'a FifoTiming)) {
        let Some(count) = known else {
            for (place, &number) in self.ends.numbers.iter().enumerate().take(usize::from(self.ends.count)) {
                if bits & 1 << place != 0 {
                    see(place, &self.fifos[usize::from(number)]);
                }
            }
            return;
        };
        for (place, slots) in self.slots.iter().enumerate().take(count) {
            if bits & 1 << place != 0
                && let Some(slots) = slots
            {
                see(place, slots);
            }
        }
    }
}
