//! Answers to look-ups (law 5).

use super::MemorySystem;
use crate::Cycle;
use crate::cache::PendingLookUps;
use crate::client::Client;
use crate::step_requests::{CacheLines, CacheLookUps, SpreadLookUp, StepRequestsView};
use std::collections::VecDeque;

/// Look-ups of a client without an answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct LookUpQueue {
    /// By step.
    pub(crate) steps: VecDeque<PendingLookUps>,
    /// Look-ups of lines of earlier requests: for each step as many as are [open](PendingLookUps::open).
    pub(crate) open: VecDeque<OpenLookUp>,
}

/// A look-up of a line whose fill is unknown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenLookUp {
    /// The request that fills the line.
    request: u64,
    /// Cycle of the look-up.
    at: Cycle,
}

impl MemorySystem {
    /// Makes the look-ups of a step that starts at `start`, if all lines are there by then. Returns their answer time, and the least
    /// occupancy that they need (law 5). Call it if no earlier look-up of the client waits.
    #[inline]
    pub(crate) fn hit(&mut self, client: usize, start: Cycle, look_ups: &CacheLookUps) -> Option<(Cycle, u64)> {
        let Client { port, cache, .. } = &mut self.clients[client];
        let cache = cache.as_mut().filter(|_| look_ups.new.count == 0)?;
        // Answers come in order, so the last fill is the latest.
        let is_there = look_ups.last_held.checked_sub(1).is_none_or(|last| port.answer(last) <= start);
        is_there.then(|| cache.hit(start, look_ups.lines))
    }

    /// Makes the look-ups of a step that starts at `start`. Returns their state, as far as it is known, and the least occupancy
    /// that they need (law 5). Appends to `open` the requests with unknown answers among the lines of earlier requests.
    #[inline]
    pub(crate) fn look_up(
        &mut self,
        client: usize,
        start: Cycle,
        look_ups: &CacheLookUps,
        asks: &StepRequestsView<'_>,
        open: &mut VecDeque<OpenLookUp>,
    ) -> (PendingLookUps, u64) {
        let lines = asks.lines(look_ups);
        if look_ups.is_spread && self.takes_cycles(client, look_ups.lines) {
            return self.look_up_over_time(client, start, look_ups, lines, open);
        }
        let CacheLines { held, new, .. } = lines;
        let Client { port, cache, .. } = &mut self.clients[client];
        let (line_bytes, cycles) = cache.as_ref().map_or((1, 1), |c| (c.config.line_bytes, c.cycles(look_ups.lines)));
        self.memories[port.memory].arrived += new.len() as u64;
        for &line in new {
            port.issue(start, line * u64::from(line_bytes), line_bytes, false);
        }
        let counts = look_ups.counts();
        let request = if new.is_empty() { look_ups.last_held } else { port.issued };
        let mut pending = PendingLookUps { start, last: start, request, fill: Cycle::ZERO, counts, open: 0 };
        let Some(last) = look_ups.last_held.checked_sub(1) else { return (pending, cycles) };
        // Answers come in order: usually the last of them has arrived.
        let fill = port.answer(last);
        if fill > start {
            let hits = &mut pending.counts.hits;
            for fill in held.iter().map(|&request| (request, port.answer(request))) {
                match fill {
                    (_, fill) if fill <= start => {}
                    (request, Cycle::UNKNOWN) => {
                        open.push_back(OpenLookUp { request, at: start });
                        pending.open += 1;
                        *hits -= 1;
                    }
                    _ => {
                        pending.counts.merged += 1;
                        *hits -= 1;
                    }
                }
            }
        }
        if new.is_empty() && fill.is_known() {
            (pending.request, pending.fill) = (0, fill);
        }
        (pending, cycles)
    }

    /// Returns true if so many look-ups do not fit in one cycle of a client's cache.
    #[inline]
    fn takes_cycles(&self, client: usize, look_ups: u32) -> bool {
        self.clients[client].cache.as_ref().is_some_and(|cache| look_ups > cache.config.lookups_per_cycle)
    }

    /// As [`MemorySystem::look_up`], for a cache whose look-ups take several cycles. Each look-up is judged, and each miss arrives,
    /// in its own cycle.
    #[inline(never)]
    fn look_up_over_time(
        &mut self,
        client: usize,
        start: Cycle,
        look_ups: &CacheLookUps,
        lines: CacheLines<'_>,
        open: &mut VecDeque<OpenLookUp>,
    ) -> (PendingLookUps, u64) {
        let Client { port, cache, .. } = &mut self.clients[client];
        let Some(cache) = cache else { return Default::default() };
        let last = cache.look_up_at(start, look_ups.lines.saturating_sub(1));
        let line_bytes = cache.config.line_bytes;
        self.memories[port.memory].arrived += lines.new.len() as u64;
        let counts = look_ups.counts();
        let mut pending = PendingLookUps { start, last, request: 0, fill: Cycle::ZERO, counts, open: 0 };
        let (mut held, mut new) = (lines.held.iter(), lines.new.iter());
        for &SpreadLookUp { number, is_miss } in lines.order {
            let at = cache.look_up_at(start, number);
            if is_miss {
                new.next().inspect(|&&line| _ = port.issue(at, line * u64::from(line_bytes), line_bytes, false));
                continue;
            }
            let Some(&request) = held.next() else { continue };
            let fill = port.answer(request);
            if fill > at {
                pending.counts.hits -= 1;
                if fill.is_known() {
                    pending.counts.merged += 1;
                } else {
                    open.push_back(OpenLookUp { request, at });
                    pending.open += 1;
                }
            }
        }
        let known = look_ups.last_held.checked_sub(1).map_or(Cycle::ZERO, |last| port.answer(last));
        if look_ups.new.count > 0 {
            pending.request = port.issued;
        } else if known.is_known() {
            pending.fill = known;
        } else {
            pending.request = look_ups.last_held;
        }
        (pending, cache.cycles(look_ups.lines))
    }

    /// Removes the first look-ups whose fills are known by now, at most `left`. The last of them has this `answer`. Call it in
    /// order of look-up.
    #[inline]
    pub(crate) fn resolve(&mut self, client: usize, queue: &mut LookUpQueue, left: &mut u32, answer: &mut Cycle) {
        let Client { port, cache, .. } = &mut self.clients[client];
        let Some(cache) = cache else { return };
        while *left > 0
            && let Some(&(mut pending)) = queue.steps.front()
        {
            if let Some(last) = pending.request.checked_sub(1) {
                pending.fill = port.answer(last);
            }
            if !pending.fill.is_known() {
                return;
            }
            let counts = &mut pending.counts;
            for OpenLookUp { request, at } in queue.open.drain(..pending.open as usize) {
                *if port.answer(request) > at { &mut counts.merged } else { &mut counts.hits } += 1;
            }
            *answer = cache.resolve(&pending);
            queue.steps.pop_front();
            *left -= 1;
        }
    }

    /// Accounts for look-ups that wait for nothing and returns their answer time.
    #[inline(always)]
    pub(crate) fn resolve_at_once(&mut self, client: usize, pending: &PendingLookUps) -> Cycle {
        let cache = self.clients[client].cache.as_mut();
        cache.map_or(Cycle::ZERO, |cache| cache.resolve(pending))
    }
}
