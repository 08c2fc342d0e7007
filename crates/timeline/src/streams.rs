//! Changes of many values, each value's in order of time, kept until all are put in order.

use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Maximum size of a change: two numbers of at most ten bytes.
const LONGEST: usize = 20;

/// The changes of one value: each the time since the one before, and the new value, seven bits to a byte.
#[derive(Clone, Debug, Default)]
struct ChangeStream {
    bytes: Vec<u8>,
    last: u64,
}

/// The changes of many values, by their numbers.
#[derive(Debug)]
pub(crate) struct ChangeStreams {
    streams: Vec<ChangeStream>,
    held: MemoryReservation,
    /// Set once the memory limit is reached; later changes are dropped.
    over: Option<OverBudget>,
}

impl ChangeStreams {
    pub(crate) fn new(count: usize, budget: &MemoryPool) -> Self {
        Self { streams: vec![ChangeStream::default(); count], held: budget.empty_reservation(), over: None }
    }

    /// A value changes; no earlier than at its last change.
    pub(crate) fn change(&mut self, value: usize, at: u64, new: u64) {
        if self.over.is_some() {
            return;
        }
        let stream = &mut self.streams[value];
        if let Err(over) = self.held.make_room(&mut stream.bytes, LONGEST, "waves") {
            self.over = Some(over);
            self.streams.clear();
            self.held.shrink_to(0);
            return;
        }
        put(&mut stream.bytes, at - stream.last);
        put(&mut stream.bytes, new);
        stream.last = at;
    }

    /// Returns all changes in order of time, then of number, as (time, number of the value, new value).
    ///
    /// # Errors
    /// The changes exceeded the memory limit.
    pub(crate) fn in_order(&self) -> Result<impl Iterator<Item = (u64, usize, u64)> + '_, OverBudget> {
        self.over.clone().map_or(Ok(()), Err)?;
        let mut rests: Vec<(&[u8], u64)> = self.streams.iter().map(|stream| (stream.bytes.as_slice(), 0)).collect();
        let mut next: BinaryHeap<_> = (0..).zip(&mut rests).filter_map(|(number, rest)| take(number, rest)).collect();
        Ok(std::iter::from_fn(move || {
            let Reverse((at, number, new)) = next.pop()?;
            next.extend(take(number, &mut rests[number]));
            Some((at, number, new))
        }))
    }
}

/// The next change of a stream of which `rest` is left, behind the time of the one before.
fn take(number: usize, (rest, last): &mut (&[u8], u64)) -> Option<Reverse<(u64, usize, u64)>> {
    *last += get(rest)?;
    Some(Reverse((*last, number, get(rest)?)))
}

fn put(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn get(bytes: &mut &[u8]) -> Option<u64> {
    let (mut number, mut shift) = (0, 0);
    loop {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Some(number);
        }
        shift += 7;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn changes_come_in_order_of_time_and_as_they_were(changes in prop::collection::vec((0..4_usize, 0..1_u64 << 40, any::<u64>()), 0..200)) {
            let mut streams = ChangeStreams::new(4, &MemoryPool::default());
            let mut sorted = changes.clone();
            sorted.sort_by_key(|&(number, at, _)| (number, at));
            sorted.iter().for_each(|&(number, at, new)| streams.change(number, at, new));
            sorted.sort_by_key(|&(number, at, _)| (at, number));
            let expected: Vec<_> = sorted.into_iter().map(|(number, at, new)| (at, number, new)).collect();
            prop_assert_eq!(streams.in_order().unwrap().collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn memory_limit_is_kept() {
        let budget = MemoryPool::new(1000);
        let mut streams = ChangeStreams::new(2, &budget);
        (0..1000).for_each(|at| streams.change(at as usize % 2, at, 1));
        assert!(streams.in_order().err().unwrap().to_string().contains("for waves"));
        assert_eq!(budget.left(), 1000, "what is given up is given back");
    }
}
