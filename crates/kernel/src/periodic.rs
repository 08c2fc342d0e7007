//! Periodic clients of memories (law 4): clients that belong to no unit, for example the scan-out of a display.

use crate::Cycle;
use std::collections::VecDeque;

/// Requests of a periodic client. Request k = 0, 1, .. is a read that arrives in cycle k * `period` at address
/// `base` + (k * `stride`) mod `span`. A [flip](FlipTiming) changes the base.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeriodicReads {
    /// Cycles from request to request, >= 1.
    pub period: u64,
    /// Bytes of a request. 0: the client makes no requests.
    pub bytes: u32,
    /// Lowest byte address before the first flip.
    pub base: u64,
    /// Bytes from the address of a request to the address of the next.
    pub stride: u64,
    /// Size of the address range \[bytes\], >= 1.
    pub span: u64,
}

impl PeriodicReads {
    /// Returns the offset of request `number` from the base.
    fn offset(&self, number: u64) -> u64 {
        (u128::from(number) * u128::from(self.stride) % u128::from(self.span.max(1))) as u64
    }
}

/// Times of flips. A flip that arrives in cycle c takes effect in the smallest multiple of `period` that is not before
/// max(c, effect of the flip before + max(`hold`, 1)). From then on, its periodic client reads from the address of the flip. The
/// flip is answered `hold` cycles later, and not before an answer of the memory to a request of cycle c could come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlipTiming {
    /// Flips take effect in multiples of these cycles, >= 1.
    pub period: u64,
    /// Cycles for which the client reads from the address of a flip. It reads nothing afterwards, until the next flip, nor before the
    /// first flip. 0: it reads until the next flip.
    pub hold: u64,
}

/// A use of a periodic client by the requests of a port. They move no data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PeriodicControl {
    /// Each request is a flip.
    Flip(FlipTiming),
    /// Each request is answered when the hold of the last flip is over.
    Wait,
}

/// A periodic client.
#[derive(Clone, Debug)]
pub(crate) struct PeriodicClient {
    pub(crate) client: usize,
    pub(crate) reads: PeriodicReads,
    /// Arrival and number of the next request.
    pub(crate) next: (Cycle, u64),
    /// Base address of its reads; `None` while it reads nothing.
    base: Option<u64>,
    /// Changes of the base that are to come, in order.
    changes: VecDeque<(Cycle, Option<u64>)>,
    /// The first cycle in which the next flip may take effect.
    next_flip: Cycle,
    /// End of the hold of the last flip.
    held: Cycle,
    pub(crate) flips: FlipCounts,
}

/// Counters of flips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FlipCounts {
    /// Flips that took effect before the end of the run.
    pub shown: u64,
    /// Cycles from the arrival of a flip to its effect, summed over all flips.
    pub wait: u64,
    /// The most cycles of one flip.
    pub longest_wait: u64,
}

impl PeriodicClient {
    pub(crate) fn new(client: usize, reads: PeriodicReads) -> Self {
        let next = (if reads.bytes == 0 { Cycle::UNKNOWN } else { Cycle::ZERO }, 0);
        let (base, changes, flips) = (Some(reads.base), VecDeque::new(), FlipCounts::default());
        Self { client, reads, next, base, changes, next_flip: Cycle::ZERO, held: Cycle::ZERO, flips }
    }

    /// Makes the client read nothing before the first flip.
    pub(crate) fn blank(&mut self) {
        self.base = None;
    }

    /// Takes in a request that arrives at `arrival`. Returns the cycle in which the hold of the last flip is over.
    pub(crate) fn control(&mut self, control: PeriodicControl, arrival: Cycle, base: u64) -> Cycle {
        if let PeriodicControl::Flip(timing) = control {
            self.flip(timing, arrival, base);
        }
        self.held
    }

    /// Flips to `base`, for a flip that arrives at `arrival`.
    fn flip(&mut self, FlipTiming { period, hold }: FlipTiming, arrival: Cycle, base: u64) {
        let effect = Cycle(arrival.max(self.next_flip).0.div_ceil(period.max(1)).saturating_mul(period.max(1)));
        self.changes.push_back((effect, Some(base)));
        if hold > 0 {
            self.changes.push_back((effect + hold, None));
        }
        self.next_flip = effect + hold.max(1);
        let wait = effect.since(arrival);
        self.flips.shown += 1;
        self.flips.wait += wait;
        self.flips.longest_wait = self.flips.longest_wait.max(wait);
        self.held = effect + hold;
    }

    /// Passes the next request. Returns its arrival, and its address if it is made. While the client reads nothing, it passes all
    /// requests before `until` at once; no flip may arrive before `until` except those that have arrived.
    pub(crate) fn pass(&mut self, until: Cycle) -> (Cycle, Option<u64>) {
        let (arrival, number) = self.next;
        while let Some(&(_, base)) = self.changes.front().filter(|(at, _)| *at <= arrival) {
            self.base = base;
            self.changes.pop_front();
        }
        let passed = if self.base.is_some() {
            1
        } else {
            let change = self.changes.front().map_or(Cycle::UNKNOWN, |(at, _)| *at);
            change.min(until).since(arrival).div_ceil(self.reads.period).max(1)
        };
        self.next = (arrival + passed.saturating_mul(self.reads.period), number + passed);
        (arrival, self.base.map(|base| base + self.reads.offset(number)))
    }

    /// Removes flips that take effect at `total` or later from the counts.
    pub(crate) fn end(&mut self, total: Cycle) {
        let late = self.changes.iter().filter(|(at, base)| base.is_some() && *at >= total).count();
        self.flips.shown -= late as u64;
    }
}

/// Data of a periodic client on the bus of a channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LateData {
    pub(crate) channel: usize,
    pub(crate) from: Cycle,
    pub(crate) to: Cycle,
}
