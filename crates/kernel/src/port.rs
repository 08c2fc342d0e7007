//! Ports of a memory (law 4): requests on their way, credits, and answers in order.

use crate::Cycle;
use crate::counts::PortCounts;
use std::collections::VecDeque;

/// A request that has arrived and is not split into bursts yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrived {
    pub(crate) arrival: Cycle,
    pub(crate) address: u64,
    pub(crate) bytes: u32,
    pub(crate) write: bool,
}

/// A request some of whose bursts are not served yet, or one ahead of it on its port.
#[derive(Clone, Copy, Debug)]
struct Open {
    arrival: Cycle,
    /// Bursts not served.
    left: u64,
    /// The end of those that are.
    end: Cycle,
}

/// One port of a memory.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    pub(crate) name: String,
    pub(crate) memory: usize,
    outstanding: u64,
    /// Answer times of the last requests, by number of issue; never decreasing.
    answers: Box<[Cycle]>,
    pub(crate) issued: u64,
    pub(crate) served: u64,
    /// The oldest request whose answer a step in flight may still ask for.
    pub(crate) keep_from: u64,
    /// No request to come arrives before, as far as its stage has promised.
    pub(crate) none_before: Cycle,
    last_answer: Cycle,
    queue: VecDeque<Arrived>,
    /// From request `served` on.
    open: VecDeque<Open>,
    pub(crate) counts: PortCounts,
}

impl Port {
    pub(crate) fn new(name: &str, memory: usize, outstanding: u32) -> Self {
        let ring = (outstanding as usize).max(1).next_power_of_two();
        Self {
            name: name.into(),
            memory,
            outstanding: u64::from(outstanding),
            answers: vec![Cycle::ZERO; ring].into(),
            issued: 0,
            served: 0,
            keep_from: u64::MAX,
            none_before: Cycle::ZERO,
            last_answer: Cycle::ZERO,
            queue: VecDeque::new(),
            open: VecDeque::new(),
            counts: PortCounts::default(),
        }
    }

    /// Credits in all.
    pub(crate) fn outstanding(&self) -> u64 {
        self.outstanding
    }

    /// The first cycle with at least `credits` free credits; unknown while that depends on an answer not known yet.
    #[inline(always)]
    pub(crate) fn credits_at(&self, credits: u32) -> Cycle {
        match (self.issued + u64::from(credits)).checked_sub(self.outstanding) {
            None | Some(0) => Cycle::ZERO,
            Some(returns) => self.answer(returns - 1),
        }
    }

    /// Answer time of request `number`; unknown until it is served. A request that left the ring was answered before
    /// the start of any step that may still ask (it needed that credit), so its time is as good as 0.
    #[inline(always)]
    pub(crate) fn answer(&self, number: u64) -> Cycle {
        if number >= self.served {
            Cycle::UNKNOWN
        } else if number + (self.answers.len() as u64) < self.issued {
            Cycle::ZERO
        } else {
            self.answers[number as usize & (self.answers.len() - 1)]
        }
    }

    #[inline]
    pub(crate) fn issue(&mut self, arrival: Cycle, address: u64, bytes: u32, write: bool) -> u64 {
        if self.issued.saturating_sub(self.keep_from) >= self.answers.len() as u64 {
            self.grow();
        }
        self.queue.push_back(Arrived { arrival, address, bytes: bytes.max(1), write });
        self.issued += 1;
        self.issued - 1
    }

    /// Doubles the ring. A step that waits for one client may hold back others that have long been answered by
    /// another, and a merged look-up may refer to a request older than the credits in use: so the credits alone do not
    /// bound what may be asked for.
    #[cold]
    fn grow(&mut self) {
        let mut ring = vec![Cycle::ZERO; 2 * self.answers.len()];
        for number in self.issued.saturating_sub(self.answers.len() as u64)..self.served {
            let slot = number as usize & (ring.len() - 1);
            ring[slot] = self.answers[number as usize & (self.answers.len() - 1)];
        }
        self.answers = ring.into();
    }

    #[inline]
    pub(crate) fn next_arrival(&self) -> Option<Cycle> {
        self.queue.front().map(|q| q.arrival)
    }

    pub(crate) fn last_answer(&self) -> Cycle {
        self.last_answer
    }

    /// Takes out the oldest request that is not split yet, and counts it.
    #[inline]
    pub(crate) fn arrived(&mut self) -> Option<Arrived> {
        let request = self.queue.pop_front()?;
        self.counts.arrived(request.write, request.bytes);
        Some(request)
    }

    /// Waits for the bursts of the request just taken out; its number.
    #[inline]
    pub(crate) fn open(&mut self, arrival: Cycle, bursts: u64) -> u64 {
        self.open.push_back(Open { arrival, left: bursts, end: Cycle::ZERO });
        self.served + self.open.len() as u64 - 1
    }

    /// Takes in that a burst of request `number` has moved its data by `end`; an answer is there when all its bursts have,
    /// not before the answer ahead of it.
    #[inline]
    pub(crate) fn moved(&mut self, number: u64, end: Cycle) {
        let request = &mut self.open[(number - self.served) as usize];
        request.left -= 1;
        request.end = request.end.max(end);
        while let Some(first) = self.open.front().filter(|first| first.left == 0) {
            self.last_answer = self.last_answer.max(first.end);
            self.counts.answered(first.arrival, self.last_answer);
            self.open.pop_front();
            let slot = self.served as usize & (self.answers.len() - 1);
            self.answers[slot] = self.last_answer;
            self.served += 1;
        }
    }
}
