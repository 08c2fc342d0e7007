//! Ports of a memory (law 4): requests in flight, credits, and answers in order.

use crate::Cycle;
use crate::counts::PortCounts;
use crate::divisor::Divisor;
use crate::memory_events::Gauge;

/// A request that has arrived.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ArrivedRequest {
    pub(crate) arrival: Cycle,
    pub(crate) address: u64,
    pub(crate) bytes: u32,
    pub(crate) write: bool,
}

/// A request from its issue until its answer is no longer needed.
#[derive(Clone, Copy, Debug, Default)]
struct PortRequest {
    arrived: ArrivedRequest,
    /// Number of unserved bursts.
    left: u64,
    /// End of the served bursts. Once the request is served: its answer time.
    end: Cycle,
}

/// The times of a request up to its answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Completion {
    pub(crate) arrival: Cycle,
    /// For the burst whose data came last: its first row command and its column command.
    pub(crate) row: Cycle,
    pub(crate) column: Cycle,
    pub(crate) end: Cycle,
    pub(crate) answer: Cycle,
}

impl Completion {
    /// The value for a request without any served burst.
    const NOT: Self =
        Self { arrival: Cycle::ZERO, row: Cycle::ZERO, column: Cycle::ZERO, end: Cycle::ZERO, answer: Cycle::UNKNOWN };
}

/// One port of a memory.
///
/// Its requests are in one ring, by number of issue. Requests from `split` to `issued` have arrived. Requests from `served` to
/// `split` have bursts in their channels. Earlier requests have their answers.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    pub(crate) name: String,
    pub(crate) memory: usize,
    outstanding: u64,
    /// True if its requests of one step may arrive in several cycles.
    pub(crate) is_paced: bool,
    /// Requests of a step that arrive per cycle; 0 for all at once.
    issue_rate: u32,
    /// Start of the last step with direct requests, and their number.
    last_step: (Cycle, u32),
    requests: Box<[PortRequest]>,
    pub(crate) issued: u64,
    split: u64,
    pub(crate) served: u64,
    /// The oldest request whose answer a step in flight may still need.
    pub(crate) keep_from: u64,
    /// No later request arrives before this cycle, as promised by its stage.
    pub(crate) none_before: Cycle,
    last_answer: Cycle,
    /// Cycles from arrival to answer beyond which an answer is late.
    pub(crate) deadline: u64,
    /// Number of late answers.
    pub(crate) late: u64,
    pub(crate) counts: PortCounts,
    /// Record of its requests, if any is kept.
    pub(crate) notes: Option<Box<RequestLog>>,
}

/// Record of a port's requests, for probes and critical paths.
#[derive(Clone, Debug, Default)]
pub(crate) struct RequestLog {
    /// Completion of each request, by number.
    pub(crate) answered: Option<Vec<Completion>>,
    /// Number of requests in flight over time.
    pub(crate) in_flight: Option<Gauge>,
}

impl RequestLog {
    /// Records the answer of request `number`.
    #[cold]
    fn answer(&mut self, number: u64, at: Cycle) {
        if let Some(answered) = &mut self.answered {
            answered[number as usize].answer = at;
        }
        if let Some(in_flight) = &mut self.in_flight {
            in_flight.down(at);
        }
    }
}

impl Port {
    pub(crate) fn new(name: &str, memory: usize, outstanding: u32) -> Self {
        let ring = (outstanding as usize).max(1).next_power_of_two();
        Self {
            name: name.into(),
            memory,
            outstanding: u64::from(outstanding),
            is_paced: false,
            issue_rate: 0,
            last_step: (Cycle::UNKNOWN, 0),
            requests: vec![PortRequest::default(); ring].into(),
            issued: 0,
            split: 0,
            served: 0,
            keep_from: u64::MAX,
            none_before: Cycle::ZERO,
            last_answer: Cycle::ZERO,
            deadline: u64::MAX,
            late: 0,
            counts: PortCounts::default(),
            notes: None,
        }
    }

    /// Total number of credits.
    pub(crate) fn outstanding(&self) -> u64 {
        self.outstanding
    }

    /// Sets the number of requests of a step that arrive per cycle; 0 for all at once.
    pub(crate) fn set_issue_rate(&mut self, per_cycle: u32) {
        self.issue_rate = per_cycle;
        self.is_paced |= per_cycle > 0;
    }

    /// Returns the arrival of the next direct request of the step that starts at `start` (law 4). A request does not arrive before
    /// the request ahead of it, for example a miss of the same step.
    pub(crate) fn next_issue(&mut self, start: Cycle) -> Cycle {
        if self.last_step.0 != start {
            self.last_step = (start, 0);
        }
        let number = self.last_step.1;
        self.last_step.1 += 1;
        let ahead = self.issued.checked_sub(1).map_or(start, |last| self.requests[self.slot(last)].arrived.arrival);
        ahead.max(start + u64::from(number.checked_div(self.issue_rate).unwrap_or(0)))
    }

    #[inline(always)]
    fn slot(&self, number: u64) -> usize {
        number as usize & (self.requests.len() - 1)
    }

    /// First cycle with at least `credits` free credits; unknown while that depends on an unknown answer.
    #[inline(always)]
    pub(crate) fn credits_at(&self, credits: u32) -> Cycle {
        match (self.issued + u64::from(credits)).checked_sub(self.outstanding) {
            None | Some(0) => Cycle::ZERO,
            Some(returns) => self.answer(returns - 1),
        }
    }

    /// Returns the request whose answer returned so many credits after `issued` requests.
    pub(crate) fn credit_of(&self, issued: u64, credits: u32) -> u64 {
        (issued + u64::from(credits)).saturating_sub(self.outstanding + 1)
    }

    /// Records the times of a burst, if they are kept and it is the last burst of its request so far.
    pub(crate) fn note(&mut self, number: u64, burst: Completion) {
        if let Some(answered) = self.notes.as_mut().and_then(|notes| notes.answered.as_mut()) {
            answered.resize(answered.len().max(number as usize + 1), Completion::NOT);
            let kept = &mut answered[number as usize];
            if kept.end < burst.end {
                *kept = burst;
            }
        }
    }

    /// Answer time of request `number`; unknown until it is served. A request that left the ring was answered before the start of
    /// any step that may still ask (the step needed that credit), so 0 stands for its time.
    #[inline(always)]
    pub(crate) fn answer(&self, number: u64) -> Cycle {
        if number >= self.served {
            Cycle::UNKNOWN
        } else if number + (self.requests.len() as u64) < self.issued {
            Cycle::ZERO
        } else {
            self.requests[self.slot(number)].end
        }
    }

    #[inline]
    pub(crate) fn issue(&mut self, arrival: Cycle, address: u64, bytes: u32, write: bool) -> u64 {
        let number = self.issued;
        if number - self.keep_from.min(self.served) >= self.requests.len() as u64 {
            self.grow();
        }
        let arrived = ArrivedRequest { arrival, address, bytes: bytes.max(1), write };
        let slot = self.slot(number);
        self.requests[slot] = PortRequest { arrived, left: 0, end: Cycle::ZERO };
        self.issued += 1;
        number
    }

    /// Doubles the ring. A step that waits for one client may hold back requests of another client that were answered long ago,
    /// and a merged look-up may refer to a request older than the credits in use. So the credits alone do not bound the answers
    /// that are needed.
    #[cold]
    fn grow(&mut self) {
        let mut ring = vec![PortRequest::default(); 2 * self.requests.len()];
        for number in self.issued.saturating_sub(self.requests.len() as u64)..self.issued {
            let slot = number as usize & (ring.len() - 1);
            ring[slot] = self.requests[self.slot(number)];
        }
        self.requests = ring.into();
    }

    /// Arrival of the oldest request that is not split into bursts yet.
    #[inline]
    pub(crate) fn next_arrival(&self) -> Option<Cycle> {
        (self.split < self.issued).then(|| self.requests[self.slot(self.split)].arrived.arrival)
    }

    pub(crate) fn last_answer(&self) -> Cycle {
        self.last_answer
    }

    /// Takes the oldest request that is not split yet, if it arrived before `until`. Returns its number, the request, and the
    /// first and last burst of size `burst` that it touches. The request is counted and waits for these bursts.
    #[inline(always)]
    pub(crate) fn split(&mut self, until: Cycle, burst: Divisor) -> Option<(u64, ArrivedRequest, (u64, u64))> {
        if self.split == self.issued {
            return None;
        }
        let number = self.split;
        let slot = self.slot(number);
        let PortRequest { arrived, left, .. } = &mut self.requests[slot];
        if arrived.arrival >= until {
            return None;
        }
        let (first, last) = burst.touched(arrived.address, arrived.bytes);
        *left = last - first + 1;
        self.counts.count_arrival(arrived.write, arrived.bytes);
        self.split += 1;
        Some((number, *arrived, (first, last)))
    }

    /// Takes the oldest request that is not split yet, if it arrived before `until`, as a request without data. One
    /// [`Port::moved`] answers it. Returns its number and the request.
    pub(crate) fn take_without_data(&mut self, until: Cycle) -> Option<(u64, ArrivedRequest)> {
        self.next_arrival().filter(|arrival| *arrival < until)?;
        let number = self.split;
        let slot = self.slot(number);
        let PortRequest { arrived, left, .. } = &mut self.requests[slot];
        *left = 1;
        self.counts.without_data += 1;
        self.split += 1;
        Some((number, *arrived))
    }

    /// Records that `bursts` of request `number` have moved their data by `end`. The answer arrives when all bursts have moved, and
    /// not before the previous answer.
    #[inline(always)]
    pub(crate) fn moved(&mut self, number: u64, bursts: u64, end: Cycle) {
        let slot = self.slot(number);
        let mut request = &mut self.requests[slot];
        request.left -= bursts;
        request.end = request.end.max(end);
        if number != self.served || request.left > 0 {
            return;
        }
        // The request is answered, and so are the requests behind it that waited only for it.
        loop {
            self.last_answer = self.last_answer.max(request.end);
            request.end = self.last_answer;
            self.counts.count_answer(request.arrived.arrival, self.last_answer);
            self.late += u64::from(self.last_answer.since(request.arrived.arrival) > self.deadline);
            if let Some(notes) = &mut self.notes {
                notes.answer(self.served, self.last_answer);
            }
            self.served += 1;
            if self.served == self.split {
                return;
            }
            let slot = self.slot(self.served);
            request = &mut self.requests[slot];
            if request.left > 0 {
                return;
            }
        }
    }
}
