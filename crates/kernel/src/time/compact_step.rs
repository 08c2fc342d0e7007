//! Steps without their times.

use super::{InputMask, StepTiming};
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::step_requests::RequestCount;

/// A step as far as it does not depend on time, in 20 bytes, because there may be millions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompactStep {
    occupancy: u32,
    latency: u32,
    after_data: u32,
    requests: u32,
    pub(crate) takes: InputMask,
    outputs: u8,
    /// Number of caches with look-ups, and the bits [`MARK`] and [`BLOCKS`].
    caches: u8,
}

/// Bit of [`CompactStep::caches`]: the delivery passes a mark.
const MARK: u8 = 1 << 7;
/// Bit of [`CompactStep::caches`]: the last answer frees the unit.
const BLOCKS: u8 = 1 << 6;
/// Replaces [`CompactStep::caches`] if the requests were refused.
const REFUSED: u8 = BLOCKS - 1;
const _: () = assert!(MAX_CLIENTS < REFUSED as usize && MAX_LINKS <= 8 && size_of::<CompactStep>() == 20);

impl CompactStep {
    /// Converts a step. Numbers of decoded steps fit into 32 bits.
    pub(crate) fn new(takes: InputMask, made: &StepTiming, count: RequestCount) -> Self {
        let (occupancy, latency) = (made.occupancy as u32, made.latency as u32);
        let flags = if made.marked { MARK } else { 0 } | if made.blocking { BLOCKS } else { 0 };
        let caches = count.caches as u8 | flags;
        let (after_data, outputs) = (made.after_data, made.outputs as u8);
        Self { occupancy, latency, after_data, requests: count.requests as u32, takes, outputs, caches }
    }

    /// Returns true if it is no step.
    #[inline(always)]
    pub(crate) fn is_undefined(&self) -> bool {
        self.occupancy == 0
    }

    /// The inputs from which it takes a token, and the outputs that get one, one bit each.
    #[inline(always)]
    pub(crate) fn tokens(&self) -> [u8; 2] {
        [self.takes.inputs() as u8, self.outputs]
    }

    #[inline(always)]
    pub(crate) fn timing(&self) -> StepTiming {
        let &Self { after_data, outputs, caches, .. } = self;
        let [occupancy, latency] = [self.occupancy, self.latency].map(u64::from);
        let (marked, blocking) = (caches & MARK != 0, caches & BLOCKS != 0);
        StepTiming { occupancy, latency, after_data, outputs: outputs.into(), marked, blocking }
    }

    /// The same step with refused requests.
    pub(crate) fn as_refused(self) -> Self {
        Self { caches: REFUSED, ..self }
    }

    #[inline(always)]
    pub(crate) fn is_refused(&self) -> bool {
        self.caches == REFUSED
    }

    /// Returns true if it has no requests.
    #[inline(always)]
    pub(crate) fn is_silent(&self) -> bool {
        self.requests | u32::from(self.caches & REFUSED) == 0
    }

    #[inline(always)]
    pub(crate) fn count(&self) -> RequestCount {
        RequestCount { requests: self.requests as usize, caches: usize::from(self.caches & REFUSED) }
    }
}
