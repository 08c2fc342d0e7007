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
    held: MemoryReservation,
}

impl KeptSteps {
    pub(crate) fn new(policy: AnalysisPolicy, budget: &MemoryPool) -> Option<Self> {
        let left = match policy {
            AnalysisPolicy::Never => return None,
            AnalysisPolicy::IfShort => SHORT_BYTES,
            AnalysisPolicy::Always => usize::MAX,
        };
        Some(Self { chunks: vec![], left: Some(left), held: budget.empty_reservation() })
    }

    /// Keeps a chunk. Drops all chunks if the run is too long for its policy.
    ///
    /// # Errors
    /// The memory limit is exceeded.
    pub(crate) fn keep(&mut self, chunk: RecordingChunk) -> Result<(), OverBudget> {
        let bytes = work_bytes(&chunk);
        self.left = self.left.and_then(|left| left.checked_sub(bytes));
        if self.left.is_some() {
            self.held.try_grow(bytes as u64, "the recorded steps, to find bottlenecks")?;
            self.chunks.push(chunk);
        } else {
            self.chunks = vec![];
            self.held.shrink_to(0);
        }
        Ok(())
    }

    /// Returns all chunks; `None` if the run was too long.
    pub(crate) fn chunks(&self) -> Option<&[RecordingChunk]> {
        self.left.map(|_| self.chunks.as_slice())
    }
}
