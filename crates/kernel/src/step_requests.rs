//! Memory requests of each step after tag look-up. Tags see look-ups in order and are independent of time. So these requests are
//! work: computed with the step, or once for a recording and reused by every resimulation.

use crate::cache::CacheTagArray;
use crate::counts::CacheCounts;
use crate::{MAX_CLIENTS, Request};
use std::borrow::Cow;

/// Requests and look-ups of one step as its unit issues them, before tag look-up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnitRequests<'a> {
    pub(crate) requests: &'a [Request],
    pub(crate) look_ups: &'a [Request],
}

impl<'a> UnitRequests<'a> {
    /// Iterates over the requests and then the look-ups.
    #[inline]
    pub(crate) fn all(self) -> impl Iterator<Item = &'a Request> {
        self.requests.iter().chain(self.look_ups)
    }
}

/// Look-ups of a step in one cache, each line once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CacheLookUps {
    /// Client number within the unit.
    pub(crate) client: u32,
    /// Number of distinct lines.
    pub(crate) lines: u32,
    /// `held`: lines that an earlier request fills. `new`: lines that this step requests.
    pub(crate) held: Places,
    pub(crate) new: Places,
    /// Place of its first entry in `order`.
    order: u32,
    /// Number of the last of the earlier requests, plus one; 0 for none.
    pub(crate) last_held: u64,
    /// True if the look-ups take several cycles.
    pub(crate) is_spread: bool,
}

/// Places in a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    first: u32,
    pub(crate) count: u32,
}

impl Places {
    /// Places from `first` to the end of a list.
    fn from<T>(first: usize, list: &[T]) -> Self {
        Self { first: first as u32, count: (list.len() - first) as u32 }
    }

    fn of<T>(self, list: &[T]) -> &[T] {
        &list[self.first as usize..][..self.count as usize]
    }
}

/// Requests of one step, or of several steps in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepRequests {
    pub(crate) requests: Vec<Request>,
    /// One entry per step and client with look-ups.
    look_ups: Vec<CacheLookUps>,
    /// Numbers of the earlier requests that fill lines.
    held: Vec<u64>,
    /// Lines that are requested now.
    new: Vec<u64>,
    /// For caches whose look-ups take several cycles: each look-up of an entry of `held` or `new`, in order.
    order: Vec<SpreadLookUp>,
    /// Lines of the most recent step, by client.
    lines: Vec<u64>,
}

/// A look-up of a step in a cache whose look-ups take several cycles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpreadLookUp {
    /// Number of the look-up in its step.
    pub(crate) number: u32,
    /// True if it requests its line.
    pub(crate) is_miss: bool,
}

/// Lines of a step's look-ups in one cache.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CacheLines<'a> {
    /// Numbers of the earlier requests that fill lines.
    pub(crate) held: &'a [u64],
    /// Lines that are requested now.
    pub(crate) new: &'a [u64],
    /// Order of both; empty if all are looked up in one cycle.
    pub(crate) order: &'a [SpreadLookUp],
}

/// The requests of one step of a [`StepRequests`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepRequestsView<'a> {
    asked: &'a StepRequests,
    /// Its look-ups, by client.
    pub(crate) look_ups: &'a [CacheLookUps],
    /// Its direct requests.
    pub(crate) requests: &'a [Request],
}

/// Read position in a [`StepRequests`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RequestCursor {
    requests: usize,
    look_ups: usize,
}

/// Number of requests of a step, and number of caches with look-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct RequestCount {
    pub(crate) requests: usize,
    pub(crate) caches: usize,
}

/// Tags of the caches of a stage's clients, with the number of the next request of each.
pub(crate) trait TagLookup {
    /// Number of clients of the stage.
    fn clients(&self) -> usize;
    /// Tags of a client by its number within the unit; `None` if it has no cache.
    fn tags(&mut self, client: usize) -> Option<(&mut CacheTagArray, u64)>;
}

impl StepRequests {
    #[inline]
    pub(crate) fn clear(&mut self) {
        self.requests.clear();
        self.look_ups.clear();
        self.held.clear();
        self.new.clear();
        self.order.clear();
    }

    /// Makes room for further entries: `further` of their number so far.
    pub(crate) fn reserve(&mut self, further: impl Fn(usize) -> usize) {
        self.requests.reserve(further(self.requests.len()));
        self.look_ups.reserve(further(self.look_ups.len()));
        self.held.reserve(further(self.held.len()));
        self.new.reserve(further(self.new.len()));
        self.order.reserve(further(self.order.len()));
    }

    /// Number of entries.
    pub(crate) fn len(&self) -> usize {
        self.requests.len() + self.look_ups.len() + self.held.len() + self.new.len() + self.order.len()
    }

    /// Appends a step and looks up its tags. Returns false if the requests exceed the unit's declaration or the wiring.
    /// `largest`: needs of the largest step, by client.
    pub(crate) fn settle(&mut self, asks: UnitRequests<'_>, caches: &mut impl TagLookup, largest: &[u32; MAX_CLIENTS]) -> bool {
        self.requests.extend_from_slice(asks.requests);
        self.settle_look_ups(asks, caches, largest)
    }

    /// Looks up the tags of a step whose direct requests are not appended. Returns its requests, or `None` and a fault.
    #[inline(always)]
    pub(crate) fn settle_now<'a>(
        &'a mut self,
        asks: UnitRequests<'a>,
        caches: &mut impl TagLookup,
        largest: &[u32; MAX_CLIENTS],
        fault: &mut Option<String>,
    ) -> Option<StepRequestsView<'a>> {
        if !self.settle_look_ups(asks, caches, largest) {
            fault.get_or_insert_with(|| request_error(asks, caches, largest));
            return None;
        }
        Some(StepRequestsView { asked: self, look_ups: &self.look_ups, requests: asks.requests })
    }

    /// Appends the look-ups of a step. Returns false if its requests exceed the unit's declaration or the wiring.
    #[inline]
    fn settle_look_ups(
        &mut self,
        UnitRequests { requests, look_ups }: UnitRequests<'_>,
        caches: &mut impl TagLookup,
        largest: &[u32; MAX_CLIENTS],
    ) -> bool {
        let mut left = *largest;
        self.lines.clear();
        if !look_ups.is_empty() && !self.look_up(look_ups, caches, &mut left) {
            return false;
        }
        requests.iter().all(|r| {
            let own = r.client as usize;
            let enough = own < caches.clients() && left[own] > 0;
            if enough {
                left[own] -= 1;
            }
            enough
        })
    }

    /// Looks up every line of a step, client by client. (The order between clients does not matter, because each has its own
    /// port.)
    #[inline]
    fn look_up(&mut self, look_ups: &[Request], caches: &mut impl TagLookup, left: &mut [u32; MAX_CLIENTS]) -> bool {
        let first = look_ups[0].client;
        // Usually all are in one cache.
        if look_ups.iter().all(|r| r.client == first) {
            return self.look_up_in(look_ups, caches, left);
        }
        let mut sorted = Cow::Borrowed(look_ups);
        if !sorted.is_sorted_by_key(|r| r.client) {
            sorted.to_mut().sort_by_key(|r| r.client);
        }
        sorted.chunk_by(|a, b| a.client == b.client).all(|look_ups| self.look_up_in(look_ups, caches, left))
    }

    /// Looks up lines in the cache of one client. Returns false if it has none, or if there are more lines than it has credits
    /// `left`.
    #[inline(always)]
    fn look_up_in(&mut self, look_ups: &[Request], caches: &mut impl TagLookup, left: &mut [u32; MAX_CLIENTS]) -> bool {
        let client = look_ups[0].client;
        if client as usize >= caches.clients() {
            return false;
        }
        let Some((tags, mut next)) = caches.tags(client as usize) else { return false };
        let most = &mut left[client as usize];
        let (held, new, order, first) = (self.held.len(), self.new.len(), self.order.len(), self.lines.len());
        let (mut lines, mut last_held) = (0, 0);
        // One bit for all lines of equal remainder by 64: usually a line is new, and no other line of the step has its bit.
        let (mut seen, mut before) = (0, u64::MAX);
        for r in look_ups {
            let (mut line, last) = tags.lines(r.address, r.bytes);
            // Not a range: usually there is one line, and a range checks its end twice.
            loop {
                let bit = 1_u64 << (line % 64);
                // Data that lie side by side are often in one line.
                if line != before && (seen & bit == 0 || !self.lines[first..].contains(&line)) {
                    seen |= bit;
                    self.lines.push(line);
                    if !tags.always_hits {
                        let found = tags.look_up(line, next);
                        if tags.spreads {
                            self.order.push(SpreadLookUp { number: lines, is_miss: found.is_none() });
                        }
                        if let Some(request) = found {
                            self.held.push(request);
                            last_held = last_held.max(request + 1);
                        } else {
                            self.new.push(line);
                            next += 1;
                        }
                    }
                    lines += 1;
                }
                before = line;
                if line == last || lines > *most {
                    break;
                }
                line += 1;
            }
        }
        let (held, new, order) = (Places::from(held, &self.held), Places::from(new, &self.new), order as u32);
        self.look_ups.push(CacheLookUps { client, lines, held, new, order, last_held, is_spread: tags.spreads });
        let is_allowed = lines <= *most;
        *most = most.saturating_sub(lines);
        is_allowed
    }

    /// Returns the step at a cursor, and moves the cursor behind it.
    #[inline(always)]
    pub(crate) fn next(&self, at: &mut RequestCursor, count: RequestCount) -> StepRequestsView<'_> {
        let look_ups = &self.look_ups[at.look_ups..][..count.caches];
        let requests = &self.requests[at.requests..][..count.requests];
        at.look_ups += count.caches;
        at.requests += count.requests;
        StepRequestsView { asked: self, look_ups, requests }
    }

    /// Returns the look-ups of the most recent step, which uses so many caches.
    #[inline(always)]
    pub(crate) fn last(&self, caches: usize) -> &[CacheLookUps] {
        &self.look_ups[self.look_ups.len().saturating_sub(caches)..]
    }

    /// Returns the lines of the most recent step with their clients.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (u32, u64)> {
        let clients = self.look_ups.iter().flat_map(|l| std::iter::repeat_n(l.client, l.lines as usize));
        clients.zip(self.lines.iter().copied())
    }
}

impl CacheLookUps {
    /// Returns the results, if all lines of earlier requests are there.
    pub(crate) fn counts(&self) -> CacheCounts {
        CacheCounts { hits: (self.lines - self.new.count).into(), misses: self.new.count.into(), merged: 0 }
    }
}

impl<'a> StepRequestsView<'a> {
    /// Returns true if the step issues a request, directly or by a miss.
    #[inline]
    pub(crate) fn issue_any(&self) -> bool {
        !self.requests.is_empty() || self.look_ups.iter().any(|look_ups| look_ups.new.count > 0)
    }

    /// Returns the lines of look-ups of the step.
    #[inline]
    pub(crate) fn lines(&self, look_ups: &CacheLookUps) -> CacheLines<'a> {
        let StepRequests { held, new, order, .. } = self.asked;
        let (held, new) = (look_ups.held.of(held), look_ups.new.of(new));
        let order = if look_ups.is_spread { &order[look_ups.order as usize..][..held.len() + new.len()] } else { &[] };
        CacheLines { held, new, order }
    }
}

/// Describes how the requests of a step contradict the unit's declaration or the wiring.
#[cold]
pub(crate) fn request_error(asked: UnitRequests<'_>, caches: &mut impl TagLookup, largest: &[u32; MAX_CLIENTS]) -> String {
    let wired = caches.clients();
    if let Some(r) = asked.all().find(|r| r.client as usize >= wired) {
        return format!("a step uses memory client {}, but the wiring gives it {wired}", r.client);
    }
    if let Some(r) = asked.look_ups.iter().find(|r| caches.tags(r.client as usize).is_none()) {
        return format!("a step looks up a line in memory client {}, which has no cache", r.client);
    }
    for (own, &declared) in largest.iter().enumerate().take(wired) {
        let needs = credits_needed(asked, own, caches);
        if needs > declared {
            return format!("a step needs {needs} credits of memory client {own}, but largest_step({own}) declares {declared}");
        }
    }
    String::new()
}

/// Maximum number of lines that are counted for a step. No unit comes near it.
const MOST_LINES: usize = 1 << 20;

/// Credits that a step needs of client `own`: its requests and the lines that it looks up.
fn credits_needed(asked: UnitRequests<'_>, own: usize, caches: &mut impl TagLookup) -> u32 {
    let mine = |r: &&Request| r.client as usize == own;
    let requests = asked.requests.iter().filter(mine).count();
    let Some((tags, _)) = caches.tags(own) else { return requests as u32 };
    let lines_of = |r: &Request| tags.lines(r.address, r.bytes);
    let all = asked.look_ups.iter().filter(mine).map(lines_of).flat_map(|(first, last)| first..=last);
    // A recording is untrusted input, and a few bytes of it can name many lines.
    let mut lines: Vec<u64> = all.take(MOST_LINES).collect();
    lines.sort_unstable();
    lines.dedup();
    (requests + lines.len()) as u32
}
