//! Decoded steps of a recording.

use super::step_class::StepClass;
use crate::cache::CacheTagArray;
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::netlist::StageInfo;
use crate::step_requests::{CacheLookUps, RequestCount, StepRequests, TagLookup};
use crate::time::{InputMask, StepTiming};
use crate::{MemorySystem, Request};

/// Decoded steps. Several resimulations may share them, because they hold no times.
#[derive(Clone, Debug, Default)]
pub(super) struct DecodedSteps {
    pub(super) steps: Vec<RecordedStep>,
    /// Their memory requests.
    pub(super) asked: StepRequests,
    /// Error in the requests of the last step.
    pub(super) refused: Option<String>,
}

/// A decoded step: the contents of its class in 20 bytes, because there may be millions.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordedStep {
    pub(super) occupancy: u32,
    latency: u32,
    after_data: u32,
    requests: u32,
    pub(super) takes: InputMask,
    outputs: u8,
    /// Number of caches with look-ups, and the bits [`MARK`] and [`BLOCKS`].
    caches: u8,
}

/// Bit of [`RecordedStep::caches`]: the delivery passes a mark.
const MARK: u8 = 1 << 7;
/// Bit of [`RecordedStep::caches`]: the last answer frees the unit.
const BLOCKS: u8 = 1 << 6;
/// Replaces [`RecordedStep::caches`] if the requests were refused.
const REFUSED: u8 = BLOCKS - 1;
const _: () = assert!(MAX_CLIENTS < REFUSED as usize && MAX_LINKS <= 8 && size_of::<RecordedStep>() == 20);

impl RecordedStep {
    /// Converts a class of a stage with this number of inputs. Numbers of decoded classes fit into 32 bits.
    pub(super) fn of(StepClass { demand, timing: made, count, .. }: &StepClass, inputs: usize) -> Self {
        let (occupancy, latency) = (made.occupancy as u32, made.latency as u32);
        let flags = if made.marked { MARK } else { 0 } | if made.blocking { BLOCKS } else { 0 };
        let caches = count.caches as u8 | flags;
        let takes = InputMask::of(*demand, inputs);
        let (after_data, outputs) = (made.after_data, made.outputs as u8);
        Self { occupancy, latency, after_data, requests: count.requests as u32, takes, outputs, caches }
    }

    #[inline(always)]
    pub(super) fn timing(&self) -> StepTiming {
        let &Self { after_data, outputs, caches, .. } = self;
        let [occupancy, latency] = [self.occupancy, self.latency].map(u64::from);
        let (marked, blocking) = (caches & MARK != 0, caches & BLOCKS != 0);
        StepTiming { occupancy, latency, after_data, outputs: outputs.into(), marked, blocking }
    }

    /// The same step with refused requests.
    pub(super) fn as_refused(self) -> Self {
        Self { caches: REFUSED, ..self }
    }

    #[inline(always)]
    pub(super) fn is_refused(&self) -> bool {
        self.caches == REFUSED
    }

    /// Returns true if it has no requests.
    #[inline(always)]
    pub(super) fn is_silent(&self) -> bool {
        self.requests | u32::from(self.caches & REFUSED) == 0
    }

    #[inline(always)]
    pub(super) fn count(&self) -> RequestCount {
        RequestCount { requests: self.requests as usize, caches: usize::from(self.caches & REFUSED) }
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
        look_ups.iter().for_each(|l| self.issued[l.client as usize % MAX_CLIENTS] += u64::from(l.new));
        requests.iter().for_each(|r| self.issued[r.client as usize % MAX_CLIENTS] += 1);
    }
}

/// Tags of a stage's client at power-on.
fn tags_of<'a>(shape: &StageInfo, memories: &'a MemorySystem, client: usize) -> Option<&'a CacheTagArray> {
    memories.clients()[*shape.clients.get(client)?].cache.as_ref().map(|cache| &cache.tags)
}
