//! Recorded steps that stay in memory until the run is analysed.

use super::format::{SHORT_BYTES, work_bytes};
use crate::options::AnalysisPolicy;
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_kernel::recording::RecordingChunk;

/// Recorded steps of a run that is analysed when it is over.
#[derive(Debug)]
pub(crate) struct KeptSteps {
    chunks: Vec<RecordingChunk>,
    /// Bytes that may still be kept; `None` once the run was too long.
    left: Option<usize>,
    policy: AnalysisPolicy,
    budget: MemoryPool,
    held: MemoryReservation,
    /// True if the memory limit ended the collection.
    lacks_memory: bool,
}

impl KeptSteps {
    pub(crate) fn new(policy: AnalysisPolicy, budget: &MemoryPool) -> Option<Self> {
        let left = match policy {
            AnalysisPolicy::Never => return None,
            AnalysisPolicy::IfShort => SHORT_BYTES,
            AnalysisPolicy::Always => usize::MAX,
        };
        let (budget, held) = (budget.clone(), budget.empty_reservation());
        Some(Self { chunks: vec![], left: Some(left), policy, budget, held, lacks_memory: false })
    }

    /// Keeps a chunk. Drops all chunks if the run is too long for its policy. An analysis that nobody asked for must not end a run, so they
    /// are dropped, too, if they need more memory than they leave.
    ///
    /// # Errors
    /// The memory limit is exceeded, and the analysis was asked for.
    pub(crate) fn keep(&mut self, chunk: RecordingChunk) -> Result<(), OverBudget> {
        let bytes = work_bytes(&chunk);
        self.left = self.left.and_then(|left| left.checked_sub(bytes));
        if self.left.is_some() {
            match self.held.try_grow(bytes as u64, "the recorded steps, to find bottlenecks (--no-bottlenecks needs none)") {
                Err(over_budget) if self.policy == AnalysisPolicy::Always => return Err(over_budget),
                grown => self.lacks_memory = grown.is_err(),
            }
            self.lacks_memory |= self.policy == AnalysisPolicy::IfShort && self.held.bytes() > self.budget.left();
        }
        if self.left.is_none() || self.lacks_memory {
            (self.left, self.chunks) = (None, vec![]);
            self.held.shrink_to(0);
        } else {
            self.chunks.push(chunk);
        }
        Ok(())
    }

    /// True if steps were dropped because of the memory limit.
    pub(crate) fn lacks_memory(&self) -> bool {
        self.lacks_memory
    }

    /// Returns all chunks; `None` if the run was too long.
    pub(crate) fn chunks(&self) -> Option<&[RecordingChunk]> {
        self.left.map(|_| self.chunks.as_slice())
    }
}
