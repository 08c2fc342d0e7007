//! What a stage has in flight: steps that wait for memory answers, or behind such a step (laws 4 and 5).

use crate::cache::LookUp;
use crate::wiring::{MAX_CLIENTS, MAX_LINKS};
use crate::{Cycle, MemorySystem, Request, Traffic};
use std::collections::VecDeque;

/// A step's delivery, as far as it does not depend on memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delivery {
    /// Start + latency: it is not delivered before.
    pub(crate) base: Cycle,
    /// Outputs that get a token, one bit each; [`MARKED`] stands beside them.
    pub(crate) outputs: u32,
}

/// Bit of [`Delivery::outputs`]: the delivery passes a mark.
pub(crate) const MARKED: u32 = 1 << MAX_LINKS;

/// A step that has issued its traffic.
#[derive(Clone, Debug)]
pub(crate) struct Flight {
    pub(crate) delivery: Delivery,
    /// Look-ups without an answer, by client.
    look_ups: [u32; MAX_CLIENTS],
    /// Number of the last read by client, plus one; 0 for none, or once its answer is known.
    reads: [u64; MAX_CLIENTS],
    /// Last answers known so far.
    pub(crate) answers: [Cycle; MAX_CLIENTS],
    /// Requests served when it was issued, by client: it waits for none before.
    served: [u64; MAX_CLIENTS],
}

impl Flight {
    /// A step without traffic.
    #[inline]
    pub(crate) fn new(delivery: Delivery) -> Self {
        let (look_ups, reads, answers, served) = Default::default();
        Self { delivery, look_ups, reads, answers, served }
    }

    /// When the step delivers, all its answers known.
    #[inline]
    pub(crate) fn delivered(&self) -> Cycle {
        self.answers.iter().fold(self.delivery.base, |latest, answer| latest.max(*answer))
    }

    /// Whether all answers are known, once the answers to reads are taken in.
    #[inline(always)]
    fn is_answered(&mut self, ids: &[usize], system: &MemorySystem) -> bool {
        for ((&client, reads), last) in ids.iter().zip(&mut self.reads).zip(&mut self.answers) {
            if let Some(number) = reads.checked_sub(1) {
                let answer = system.answer(client, number);
                if !answer.is_known() {
                    return false;
                }
                *last = answer.max(*last);
                *reads = 0;
            }
        }
        self.look_ups == [0; MAX_CLIENTS]
    }

    /// Until when it waits for each client's answers, as far as that is known by now.
    pub(crate) fn awaited(&self, ids: &[usize], system: &MemorySystem) -> [Cycle; MAX_CLIENTS] {
        let mut awaited = self.answers;
        for (i, &client) in ids.iter().enumerate() {
            let read = self.reads[i].checked_sub(1).map_or(Cycle::ZERO, |number| system.answer(client, number));
            let look_up = if self.look_ups[i] > 0 { Cycle::UNKNOWN } else { Cycle::ZERO };
            awaited[i] = awaited[i].max(read).max(look_up);
        }
        awaited
    }
}

/// Steps in flight, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flights {
    steps: VecDeque<Flight>,
    /// Their look-ups that have no answer yet, by client, in order.
    look_ups: [VecDeque<LookUp>; MAX_CLIENTS],
    /// Lines that a client has looked up in the step being made.
    lines: Vec<u64>,
    /// Answers that were known when the steps were last asked whether they have theirs: until there are more, none has.
    asked_at: Option<u64>,
}

impl Flights {
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Issues the traffic of a step that starts at `start`; the least occupancy that its look-ups need (law 5), and
    /// whether all its answers are known and nothing is ahead of it, so that it can deliver at once. `None` where the traffic
    /// is not what the unit declared and the machine wired: `largest` is what the largest step needs, by client.
    #[inline]
    pub(crate) fn issue(
        &mut self,
        flight: &mut Flight,
        start: Cycle,
        (ids, system): (&[usize], &mut MemorySystem),
        traffic: &Traffic,
        largest: &[u32; MAX_CLIENTS],
    ) -> Option<(u64, bool)> {
        let mut least = 1;
        let mut waits = false;
        let mut left = *largest;
        if !traffic.look_ups.is_empty() {
            (least, waits) = self.look_up(flight, start, (ids, system), traffic, &mut left)?;
        }
        if !traffic.requests.is_empty() {
            waits |= issue_requests(flight, start, (ids, system), traffic, &mut left)?;
        }
        Some((least, !waits && self.steps.is_empty()))
    }

    /// Makes the look-ups of a step, each line once; the least occupancy, and whether it waits for any. Takes what they need
    /// from what is `left` of the largest step.
    #[inline]
    fn look_up(
        &mut self,
        flight: &mut Flight,
        start: Cycle,
        (ids, system): (&[usize], &mut MemorySystem),
        traffic: &Traffic,
        left: &mut [u32; MAX_CLIENTS],
    ) -> Option<(u64, bool)> {
        let mut least = 1;
        let mut waits = false;
        let mut made = 0;
        // By client, since all that a client has is fetched once then. (The order between clients decides nothing: each has
        // its own port.)
        for (own, &client) in ids.iter().enumerate() {
            let Some(mut cached) = system.cached(client) else { continue };
            let pending = &mut self.look_ups[own];
            self.lines.clear();
            // A bit for all lines of the same rest by 64: mostly a line is new, and no other of the step has its bit.
            let mut seen = 0;
            for r in traffic.look_ups.iter().filter(|r| r.client as usize == own) {
                made += 1;
                let (mut line, last) = cached.cache.lines(r.address, r.bytes);
                // Not a range: mostly it is one line, and a range asks twice whether it is over.
                loop {
                    let bit = 1_u64 << (line % 64);
                    if seen & bit == 0 || !self.lines.contains(&line) {
                        seen |= bit;
                        self.lines.push(line);
                        let look_up = cached.look_up(line, start);
                        if look_up.fill.is_known() && pending.is_empty() {
                            flight.answers[own] = cached.cache.resolve(&look_up, look_up.fill);
                        } else {
                            pending.push_back(look_up);
                            flight.look_ups[own] += 1;
                            waits = true;
                        }
                    }
                    if line == last {
                        break;
                    }
                    line += 1;
                }
            }
            left[own] = left[own].checked_sub(self.lines.len() as u32)?;
            least = least.max(cached.cache.cycles(self.lines.len()));
        }
        // The others ask a client without a cache, or none.
        (made == traffic.look_ups.len()).then_some((least, waits))
    }

    /// Takes in a step that waits. Steps that deliver nothing wait only to be counted: those in a row wait as one.
    pub(crate) fn push(&mut self, mut flight: Flight, (ids, system): (&[usize], &mut MemorySystem)) {
        match self.steps.back_mut() {
            Some(last) if last.delivery.outputs | flight.delivery.outputs == 0 => {
                for i in 0..ids.len() {
                    last.look_ups[i] += flight.look_ups[i];
                    last.reads[i] = last.reads[i].max(flight.reads[i]);
                }
            }
            _ => {
                for (served, &client) in flight.served.iter_mut().zip(ids) {
                    *served = system.served(client);
                }
                self.steps.push_back(flight);
            }
        }
        self.asked_at = None;
        if self.steps.len() == 1 {
            self.keep_answers(ids, system);
        }
    }

    /// Hands steps to `deliver` whose answers are known by now and that have nothing ahead of them on the same output, with
    /// these outputs; tells whether there were any. `outputs`: those that the stage has.
    ///
    /// A step waits for no other: not for one that emits nothing, nor for one that emits elsewhere. Were it to wait here
    /// for what is ahead, its delivery would be unknown although it does not depend on any answer, and what starts upon it
    /// could issue requests earlier than [`MemorySystem::serve_safe`] may assume.
    pub(crate) fn land(
        &mut self,
        outputs: u32,
        (ids, system): (&[usize], &mut MemorySystem),
        mut deliver: impl FnMut(&Flight, u32),
    ) -> bool {
        let known = ids.iter().map(|&client| system.served(client)).sum();
        if self.asked_at.replace(known) == Some(known) {
            return false;
        }
        let mut moved = false;
        let (mut taken, mut stuck) = (0, 0);
        for flight in &mut self.steps {
            resolve(&mut self.look_ups, &mut stuck, flight, ids, system);
            if flight.is_answered(ids, system) {
                let free = flight.delivery.outputs & !taken;
                deliver(flight, free);
                moved |= free != 0;
                flight.delivery.outputs &= taken;
                if flight.delivery.outputs == 0 {
                    continue;
                }
            }
            taken |= flight.delivery.outputs;
            if taken & outputs == outputs {
                break;
            }
        }
        let before = self.steps.len();
        while self.steps.front_mut().is_some_and(|f| f.delivery.outputs == 0 && f.is_answered(ids, system)) {
            self.steps.pop_front();
        }
        if self.steps.len() < before {
            self.keep_answers(ids, system);
        }
        moved
    }

    /// Shows `note`, for each output, the oldest step that delivers there.
    pub(crate) fn oldest(&self, mut note: impl FnMut(&Flight, u32)) {
        let mut taken = 0;
        for flight in &self.steps {
            let first = flight.delivery.outputs & !taken;
            if first != 0 {
                note(flight, first);
            }
            taken |= first;
        }
    }

    /// Tells the memories which answers the oldest step in flight, and so any, may still ask for.
    fn keep_answers(&self, ids: &[usize], system: &mut MemorySystem) {
        for (i, &client) in ids.iter().enumerate() {
            system.keep_from(client, self.steps.front().map_or(u64::MAX, |flight| flight.served[i]));
        }
    }
}

/// Issues the direct requests of a step; whether it waits for any. Takes what they need from what is `left` of the largest
/// step.
#[inline]
fn issue_requests(
    flight: &mut Flight,
    start: Cycle,
    (ids, system): (&[usize], &mut MemorySystem),
    traffic: &Traffic,
    left: &mut [u32; MAX_CLIENTS],
) -> Option<bool> {
    let mut waits = false;
    for r in &traffic.requests {
        let &client = ids.get(r.client as usize)?;
        let left = &mut left[r.client as usize];
        *left = left.checked_sub(1)?;
        let number = system.issue(client, start, r.address, r.bytes, r.write);
        if !r.write {
            flight.reads[r.client as usize] = number + 1;
            waits = true;
        }
    }
    Some(waits)
}

/// What is wrong with traffic that could not be issued: not what the unit declared, or not what the machine wired.
#[cold]
pub(crate) fn objection((ids, system): (&[usize], &mut MemorySystem), largest: &[u32; MAX_CLIENTS], traffic: &Traffic) -> String {
    let wired = ids.len();
    if let Some(r) = traffic.requests.iter().chain(&traffic.look_ups).find(|r| r.client as usize >= wired) {
        return format!("a step uses memory client {}, but the wiring gives it {wired}", r.client);
    }
    let is_cached = |r: &Request| system.cache_name(ids[r.client as usize]).is_some();
    if let Some(r) = traffic.look_ups.iter().find(|r| !is_cached(r)) {
        return format!("a step looks up a line in memory client {}, which has no cache", r.client);
    }
    let needs = ids.iter().enumerate().map(|(own, &client)| credits_needed(traffic, own, client, system));
    let beyond = (0..).zip(needs).zip(largest).find(|((_, needs), declared)| needs > *declared);
    beyond.map_or_else(String::new, |((own, needs), declared)| {
        format!("a step needs {needs} credits of memory client {own}, but largest_step({own}) declares {declared}")
    })
}

/// Credits that a step needs of the client that its unit numbers `own`: its requests, and the lines that it looks up.
fn credits_needed(traffic: &Traffic, own: usize, client: usize, system: &mut MemorySystem) -> u32 {
    let mine = |r: &&Request| r.client as usize == own;
    let requests = traffic.requests.iter().filter(mine).count();
    let Some(cached) = system.cached(client) else { return requests as u32 };
    let lines_of = |r: &Request| cached.cache.lines(r.address, r.bytes);
    let mut lines: Vec<u64> = traffic.look_ups.iter().filter(mine).map(lines_of).flat_map(|(first, last)| first..=last).collect();
    lines.sort_unstable();
    lines.dedup();
    (requests + lines.len()) as u32
}

/// Takes in the answers to a step's look-ups, unless one ahead of it on the same client is `stuck` (a bit each).
#[inline]
fn resolve(
    queues: &mut [VecDeque<LookUp>; MAX_CLIENTS],
    stuck: &mut u32,
    flight: &mut Flight,
    ids: &[usize],
    system: &mut MemorySystem,
) {
    for (i, (queue, &client)) in queues.iter_mut().zip(ids).enumerate() {
        let left = &mut flight.look_ups[i];
        if *left > 0 && *stuck & 1 << i == 0 {
            system.resolve(client, queue, left, &mut flight.answers[i]);
            *stuck |= u32::from(*left > 0) << i;
        }
    }
}
