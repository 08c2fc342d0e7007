//! Answers to look-ups (law 5).

use super::MemorySystem;
use crate::Cycle;
use crate::cache::PendingLookUps;
use crate::client::Client;
use crate::counts::CacheCounts;
use crate::step_requests::CacheLookUps;
use std::collections::VecDeque;

/// Look-ups of a client without an answer.
#[derive(Clone, Debug, Default)]
pub(crate) struct LookUpQueue {
    /// By step.
    pub(crate) steps: VecDeque<PendingLookUps>,
    /// Requests that fill the lines of earlier requests: for each step as many as are [open](PendingLookUps::open).
    pub(crate) open: VecDeque<u64>,
}

impl MemorySystem {
    /// Makes the look-ups of a step that starts at `start`. Returns their state, as far as it is known, and the least occupancy
    /// that they need (law 5). Appends to `open` the requests with unknown answers among the lines of earlier requests.
    #[inline]
    pub(crate) fn look_up(
        &mut self,
        client: usize,
        start: Cycle,
        (look_ups, held, new): (&CacheLookUps, &[u64], &[u64]),
        open: &mut VecDeque<u64>,
    ) -> (PendingLookUps, u64) {
        let Client { port, cache } = &mut self.clients[client];
        let (line_bytes, cycles) = cache.as_ref().map_or((1, 1), |c| (c.config.line_bytes, c.cycles(look_ups.lines)));
        self.memories[port.memory].arrived += new.len() as u64;
        for &line in new {
            port.issue(start, line * u64::from(line_bytes), line_bytes, false);
        }
        let counts = CacheCounts { hits: (look_ups.lines - look_ups.new).into(), misses: look_ups.new.into(), merged: 0 };
        let request = if new.is_empty() { look_ups.last_held } else { port.issued };
        let mut pending = PendingLookUps { start, request, fill: Cycle::ZERO, counts, open: 0 };
        let Some(last) = look_ups.last_held.checked_sub(1) else { return (pending, cycles) };
        // Answers come in order: usually the last of them has arrived.
        let fill = port.answer(last);
        if fill > start {
            let hits = &mut pending.counts.hits;
            for fill in held.iter().map(|&request| (request, port.answer(request))) {
                match fill {
                    (_, fill) if fill <= start => {}
                    (request, Cycle::UNKNOWN) => {
                        open.push_back(request);
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

    /// Removes the first look-ups whose fills are known by now, at most `left`. The last of them has this `answer`. Call it in
    /// order of look-up.
    #[inline]
    pub(crate) fn resolve(&mut self, client: usize, queue: &mut LookUpQueue, left: &mut u32, answer: &mut Cycle) {
        let Client { port, cache } = &mut self.clients[client];
        let Some(cache) = cache else { return };
        while *left > 0
            && let Some(&PendingLookUps { start, request, mut fill, mut counts, open }) = queue.steps.front()
        {
            if let Some(last) = request.checked_sub(1) {
                fill = port.answer(last);
            }
            if !fill.is_known() {
                return;
            }
            for request in queue.open.drain(..open as usize) {
                *if port.answer(request) > start { &mut counts.merged } else { &mut counts.hits } += 1;
            }
            *answer = cache.resolve(start, fill, counts);
            queue.steps.pop_front();
            *left -= 1;
        }
    }

    /// Accounts for look-ups that wait for nothing and returns their answer time.
    #[inline(always)]
    pub(crate) fn resolve_at_once(&mut self, client: usize, pending: &PendingLookUps) -> Cycle {
        let cache = self.clients[client].cache.as_mut();
        cache.map_or(Cycle::ZERO, |cache| cache.resolve(pending.start, pending.fill, pending.counts))
    }
}
