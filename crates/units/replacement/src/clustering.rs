//! Costs of a code book: passes over the gathered pseudo-normals in memory (120), with the arithmetic of each.
//!
//! The host computes the whole book at once ([`build_code_book`](crate::build_code_book)). The device reads all gathered N' once
//! per pass:
//!
//! 1. *Directions*: each N' is brought to unit length, written back in its place, and searched among the directions kept so far.
//!    If no more directions are distinct than there are entries, they are the book, and this is the only pass.
//! 2. *Seeds*: one pass per entry, which finds the direction farthest from all seeds so far. It takes an inner product per N' and
//!    reads and writes the largest so far beside each N'.
//! 3. *Means*: each direction is searched and added to the sum of its entry. Then every entry is brought to unit length.
//!
//! Finally the book is written into the space of the level's VQ table (121), where the brightness fetch unit (112) reads it.

use crate::ReplacementConfig;
use basrelief_kernel::{OperatorCounts, Operators};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Size of the largest inner product of an N' with a seed so far, kept beside it in memory \[bytes\].
const BEST_BYTES: u64 = 4;

/// Size of the batch of a code book.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BookBatch {
    /// Pseudo-normals of all levels.
    pub(crate) normals: u64,
    /// Size of the pseudo-normals in memory \[bytes\].
    pub(crate) bytes: u64,
    /// Entries of the book over all levels.
    pub(crate) entries: u64,
    /// Seed passes: entries of the largest level among those that do not hold all their directions.
    pub(crate) seeds: u64,
    /// Passes that moved entries, or found that none moved.
    pub(crate) means: u64,
    /// Cycles to search every N' once in the book of its level.
    pub(crate) search_cycles: u64,
}

/// One pass: bytes read, bytes written at the same time, and cycles of arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ClusterPass {
    read: u64,
    write: u64,
    cycles: u64,
}

/// A clustering in progress: the remaining passes, and the progress of the first of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clustering {
    passes: VecDeque<ClusterPass>,
    read: u64,
    written: u64,
    spent: u64,
}

/// OperatorCounts of one step of a clustering: bytes moved, each from an offset in the gathered N' on, and cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PassPart {
    pub(crate) at: u64,
    pub(crate) read: u32,
    pub(crate) write: u32,
    pub(crate) cycles: u64,
    /// True for the last part of a pass.
    pub(crate) is_last: bool,
}

impl Clustering {
    /// Returns all passes over a batch.
    pub(crate) fn new(batch: &BookBatch, config: &ReplacementConfig, operators: &Operators) -> Self {
        let lanes = config.lanes.max(1);
        let have = config.arithmetic();
        let unit_length = operators.interval(OperatorCounts::NORMALIZE, have);
        let directions = ClusterPass {
            read: batch.bytes,
            write: batch.bytes,
            // The search overlaps with bringing the next N' to unit length.
            cycles: batch.search_cycles.max(batch.normals * unit_length),
        };
        let best = batch.normals * BEST_BYTES;
        let seed = ClusterPass { read: batch.bytes + best, write: best, cycles: batch.normals.div_ceil(u64::from(lanes)) };
        let mean = ClusterPass { read: batch.bytes, write: 0, cycles: batch.search_cycles + batch.entries * unit_length };
        let seeds = (0..batch.seeds).map(|_| seed);
        let means = (0..batch.means).map(|_| mean);
        Self { passes: std::iter::once(directions).chain(seeds).chain(means).collect(), ..Self::default() }
    }

    /// Returns the next part, with at most `most` bytes read. Returns `None` if all passes are over.
    pub(crate) fn next(&mut self, most: u64) -> Option<PassPart> {
        let pass = self.passes.front()?;
        let at = self.read;
        let read = (pass.read - at).min(most.max(1));
        self.read += read;
        // Share that goes with the bytes read so far, rounded down. The last bytes get all of it.
        let share = |whole: u64| (u128::from(whole) * u128::from(self.read) / u128::from(pass.read.max(1))) as u64;
        let (written, spent) = (share(pass.write), share(pass.cycles));
        let is_last = self.read == pass.read;
        let write = (written - self.written) as u32;
        let part = PassPart { at, read: read as u32, write, cycles: spent - self.spent, is_last };
        (self.written, self.spent) = (written, spent);
        if is_last {
            self.passes.pop_front();
            (self.read, self.written, self.spent) = (0, 0, 0);
        }
        Some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(batch: &BookBatch) -> Vec<PassPart> {
        let mut clustering = Clustering::new(batch, &ReplacementConfig::default(), &Operators::default());
        std::iter::from_fn(|| clustering.next(64)).collect()
    }

    #[test]
    fn every_pass_reads_all_gathered_normals() {
        let batch = BookBatch { normals: 1_000, bytes: 6_000, entries: 16, seeds: 16, means: 3, search_cycles: 1_000 };
        let parts = parts(&batch);
        let read: u64 = parts.iter().map(|p| u64::from(p.read)).sum();
        assert_eq!(read, (1 + 16 + 3) * 6_000 + 16 * 4_000);
        let written: u64 = parts.iter().map(|p| u64::from(p.write)).sum();
        assert_eq!(written, 6_000 + 16 * 4_000, "directions once, the best product with each seed");
        let cycles: u64 = parts.iter().map(|p| p.cycles).sum();
        // One divider and one square-root unit, each busy for one cycle. Seeds go 64 at a time.
        assert_eq!(cycles, 1_000 + 16 * 16 + 3 * (1_000 + 16));
        assert!(parts.iter().all(|p| p.read <= 64 && p.write <= 64 + 4));
        assert_eq!(parts.iter().filter(|p| p.is_last).count(), 1 + 16 + 3);
    }

    #[test]
    fn small_book_takes_one_pass() {
        let batch = BookBatch { normals: 10, bytes: 60, entries: 4, search_cycles: 10, ..BookBatch::default() };
        assert_eq!(parts(&batch), [PassPart { at: 0, read: 60, write: 60, cycles: 10, is_last: true }]);
    }
}
