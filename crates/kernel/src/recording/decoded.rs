//! Decoded steps of a recording.

use crate::cache::CacheTagArray;
use crate::capacity::MAX_CLIENTS;
use crate::netlist::StageInfo;
use crate::step_requests::{CacheLookUps, StepRequests, TagLookup};
use crate::time::CompactStep;
use crate::{MemorySystem, Request};

/// Decoded steps. Several resimulations may share them, because they hold no times.
#[derive(Clone, Debug, Default)]
pub(super) struct DecodedSteps {
    pub(super) steps: Vec<CompactStep>,
    /// Their memory requests.
    pub(super) asked: StepRequests,
    /// Error in the requests of the last step.
    pub(super) refused: Option<String>,
}

impl DecodedSteps {
    /// Makes room for the steps of `all` bytes, if these are the steps of the first `read` bytes.
    pub(super) fn reserve_for(&mut self, all: usize, read: usize) {
        let further = |count: usize| (count as u128 * (all - read) as u128).div_ceil(read.max(1) as u128) as usize;
        // An eighth more, because later steps may be shorter.
        let room = |count: usize| further(count + count / 8);
        self.steps.reserve(room(self.steps.len()));
        self.asked.reserve(room);
    }
}

/// Tags of a stage's caches, and the number of requests that each client has issued.
#[derive(Clone, Debug)]
pub(super) struct StageTags {
    clients: usize,
    tags: [Option<CacheTagArray>; MAX_CLIENTS],
    issued: [u64; MAX_CLIENTS],
}

impl TagLookup for StageTags {
    #[inline(always)]
    fn clients(&self) -> usize {
        self.clients
    }
    #[inline(always)]
    fn tags(&mut self, client: usize) -> Option<(&mut CacheTagArray, u64)> {
        Some((self.tags[client].as_mut()?, self.issued[client]))
    }
}

impl StageTags {
    /// Creates the tags at power-on.
    pub(super) fn new(shape: &StageInfo, memories: &MemorySystem) -> Self {
        let tags = std::array::from_fn(|i| tags_of(shape, memories, i).cloned());
        Self { clients: shape.clients.len(), tags, issued: [0; MAX_CLIENTS] }
    }

    /// Returns true if look-ups give the same results in a stage's caches.
    pub(super) fn is_alike(&self, shape: &StageInfo, memories: &MemorySystem) -> bool {
        self.tags.iter().enumerate().all(|(i, ours)| match (ours, tags_of(shape, memories, i)) {
            (Some(ours), Some(theirs)) => ours.is_alike(theirs),
            (ours, theirs) => ours.is_none() && theirs.is_none(),
        })
    }

    /// Frees the tags. No look-up may follow.
    pub(super) fn free_tags(&mut self) {
        self.tags.iter_mut().flatten().for_each(CacheTagArray::forget);
    }

    /// Counts the requests of a step.
    #[inline(always)]
    pub(super) fn count(&mut self, look_ups: &[CacheLookUps], requests: &[Request]) {
        look_ups.iter().for_each(|l| self.issued[l.client as usize % MAX_CLIENTS] += u64::from(l.new.count));
        requests.iter().for_each(|r| self.issued[r.client as usize % MAX_CLIENTS] += 1);
    }
}

/// Tags of a stage's client at power-on.
fn tags_of<'a>(shape: &StageInfo, memories: &'a MemorySystem, client: usize) -> Option<&'a CacheTagArray> {
    memories.clients()[*shape.clients.get(client)?].cache.as_ref().map(|cache| &cache.tags)
}
