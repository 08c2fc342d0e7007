//! Numbers of the FIFOs or clients of a stage.

use super::FifoTiming;
use crate::capacity::MAX_LINKS;

/// Up to eight numbers, stored inline. A vector per stage would lie elsewhere in memory and be read in every step.
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

    /// Number of entries. With `known` it is a constant for the compiler.
    #[inline(always)]
    pub(super) fn count(&self, known: Option<usize>) -> usize {
        known.unwrap_or(usize::from(self.count))
    }

    /// Returns the number at index `i`.
    #[inline(always)]
    pub(super) fn at(&self, i: usize) -> usize {
        usize::from(self.numbers[i % MAX_LINKS])
    }

    /// Returns the index of a number; 0 if it is not among them.
    pub(super) fn place_of(&self, number: usize) -> u8 {
        let place = self.numbers.iter().take(usize::from(self.count)).position(|&known| usize::from(known) == number);
        place.unwrap_or_default() as u8
    }

    /// Returns one bit per entry.
    #[inline(always)]
    pub(super) fn all(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// Iterates over the entries of these bits, with their indices, in order.
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

    /// Looks up the FIFOs of these numbers: once if their count is known at compile time, otherwise at each use. `none`: a FIFO for
    /// places without one.
    #[inline(always)]
    pub(super) fn join<'a>(self, fifos: &'a [FifoTiming], none: &'a FifoTiming, known: Option<usize>) -> ConnectedFifos<'a> {
        let mut slots = [none; MAX_LINKS];
        for (place, slot) in slots.iter_mut().enumerate().take(known.unwrap_or(0)) {
            *slot = &fifos[self.at(place)];
        }
        ConnectedFifos { ends: self, fifos, slots }
    }
}

/// The FIFOs at one side of a stage.
#[derive(Clone, Copy)]
pub(super) struct ConnectedFifos<'a> {
    ends: PortIds,
    fifos: &'a [FifoTiming],
    /// As many as are known at compile time.
    slots: [&'a FifoTiming; MAX_LINKS],
}

impl<'a> ConnectedFifos<'a> {
    /// Number of entries. With `known` it is a constant for the compiler.
    #[inline(always)]
    pub(super) fn count(&self, known: Option<usize>) -> usize {
        self.ends.count(known)
    }

    /// Returns one bit per entry.
    #[inline(always)]
    pub(super) fn all(&self, known: Option<usize>) -> u32 {
        (1 << self.count(known)) - 1
    }

    /// Calls `see` for the entries of these bits in order, with their indices. The compiler unrolls it if the count is known.
    #[inline(always)]
    pub(super) fn each(&self, bits: u32, known: Option<usize>, mut see: impl FnMut(usize, &'a FifoTiming)) {
        // One loop with one call: this code is compiled hundreds of times.
        let count = self.count(known);
        let mut place = 0;
        while place < count {
            if bits & 1 << place != 0 {
                see(place, if known.is_some() { self.slots[place % MAX_LINKS] } else { &self.fifos[self.ends.at(place)] });
            }
            place += 1;
        }
    }
}
