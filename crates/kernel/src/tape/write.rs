//! Writing a tape.

use super::bytes::{put, zigzag};
use super::class::{CLASSES, Class, NEW, place};
use super::reel::{End, Reel};
use crate::asked::{by_client, each_line};
use crate::memory::Divisor;
use crate::shape::{Shape, StageShape};
use crate::time::{Made, Rest};
use crate::wiring::{MAX_CLIENTS, MAX_LINKS};
use crate::{Demand, MemorySystem, Request, Traffic};

/// Writes down what the stages of a run do.
#[derive(Clone, Debug)]
pub(crate) struct Writer {
    stages: Vec<Stream>,
    written: usize,
    /// Bytes that are worth a reel.
    reel: usize,
}

/// The stream of one stage.
#[derive(Clone, Debug)]
struct Stream {
    bytes: Vec<u8>,
    classes: Vec<Option<Class>>,
    /// Last address of each client.
    last: [u64; MAX_LINKS],
    /// Bytes of a line of each client's cache.
    line_bytes: [u32; MAX_CLIENTS],
    /// What the largest step needs, by client.
    largest: [u32; MAX_CLIENTS],
    /// The look-ups of the step being written: each line once, whatever of it was asked for, and however often.
    look_ups: Vec<Request>,
    /// Their lines, of one client after the other.
    lines: Vec<u64>,
}

impl Writer {
    pub(crate) fn new(shape: &Shape, memories: &MemorySystem, reel: usize) -> Self {
        let lines: Vec<u32> = memories.line_bytes().map(|bytes| bytes.unwrap_or(1)).collect();
        let stream = |stage: &StageShape| Stream {
            bytes: Vec::new(),
            classes: vec![None; CLASSES],
            last: [0; MAX_LINKS],
            line_bytes: std::array::from_fn(|i| stage.clients.get(i).map_or(1, |&client| lines[client])),
            largest: stage.credits,
            look_ups: Vec::new(),
            lines: Vec::new(),
        };
        Self { stages: shape.stages.iter().map(stream).collect(), written: 0, reel }
    }

    /// Writes a step down, once its traffic is settled.
    #[inline]
    pub(crate) fn step(&mut self, stage: usize, demand: Demand, made: &Made, traffic: &Traffic) {
        self.write(stage, |stream| {
            stream.take_lines(traffic);
            stream.step(demand, made, traffic.requests());
        });
    }

    /// Writes a step down whose traffic nobody settles: tags are asked by who times it.
    #[inline]
    pub(crate) fn work(&mut self, stage: usize, demand: Demand, made: &Made, traffic: &Traffic) {
        self.write(stage, |stream| {
            stream.find_lines(traffic.look_ups());
            stream.step(demand, made, traffic.requests());
        });
    }

    #[inline(always)]
    fn write(&mut self, stage: usize, step: impl FnOnce(&mut Stream)) {
        let stream = &mut self.stages[stage];
        let before = stream.bytes.len();
        step(stream);
        self.written += stream.bytes.len() - before;
    }

    /// Whether there is enough for a reel.
    pub(crate) fn is_full(&self) -> bool {
        self.written >= self.reel
    }

    /// What has been written since the last reel, with what the next step of each stage will take.
    pub(crate) fn reel(&mut self, rests: Vec<Rest>, end: End) -> Reel {
        self.written = 0;
        let stages = self.stages.iter_mut().map(|stream| std::mem::take(&mut stream.bytes)).collect();
        Reel { stages, rests, end, faults: vec![] }
    }
}

impl Stream {
    /// The lines that a settled step looks up.
    #[inline]
    fn take_lines(&mut self, traffic: &Traffic) {
        self.look_ups.clear();
        for (client, line) in traffic.lines() {
            let address = line * u64::from(self.line_bytes[client as usize % MAX_CLIENTS]);
            self.look_ups.push(Request { client, write: false, address, bytes: 1 });
        }
    }

    /// The lines that a step looks up; of more than it may, one too many.
    #[inline]
    fn find_lines(&mut self, look_ups: &[Request]) {
        let Self { line_bytes, largest, look_ups: found, lines, .. } = self;
        found.clear();
        lines.clear();
        by_client(look_ups, |look_ups| {
            let client = look_ups[0].client;
            let own = client as usize % MAX_CLIENTS;
            each_line(lines, look_ups, Divisor::new(line_bytes[own]), largest[own], |line| {
                let address = line * u64::from(line_bytes[own]);
                found.push(Request { client, write: false, address, bytes: 1 });
            });
            true
        });
    }

    /// Writes a step down that looks up what was found.
    #[inline]
    fn step(&mut self, demand: Demand, made: &Made, requests: &[Request]) {
        let asks = (requests, self.look_ups.as_slice());
        let place = place(demand, made, asks);
        let class = &mut self.classes[usize::from(place)];
        if !class.as_ref().is_some_and(|class| class.has(demand, made, asks)) {
            let new = Class::of(demand, *made, asks);
            self.bytes.extend([NEW, place]);
            new.write(&mut self.bytes);
            *class = Some(new);
        } else {
            self.bytes.push(place);
        }
        for r in asks.0.iter().chain(asks.1) {
            let last = &mut self.last[r.client as usize % MAX_LINKS];
            put(&mut self.bytes, zigzag(r.address.wrapping_sub(*last)));
            *last = r.address;
        }
    }
}
