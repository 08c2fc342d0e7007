//! Writing a tape.

use super::bytes::{put, zigzag};
use super::class::{CLASSES, Class, NEW, place};
use super::reel::Reel;
use crate::time::{Made, Rest};
use crate::wiring::MAX_LINKS;
use crate::{Demand, Traffic};

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
}

impl Writer {
    pub(crate) fn new(stages: usize, reel: usize) -> Self {
        let stream = Stream { bytes: Vec::new(), classes: vec![None; CLASSES], last: [0; MAX_LINKS] };
        Self { stages: vec![stream; stages], written: 0, reel }
    }

    /// Writes a step down.
    #[inline]
    pub(crate) fn step(&mut self, stage: usize, demand: Demand, made: &Made, traffic: &Traffic) {
        let stream = &mut self.stages[stage];
        let before = stream.bytes.len();
        stream.step(demand, made, traffic);
        self.written += stream.bytes.len() - before;
    }

    /// Whether there is enough for a reel.
    pub(crate) fn is_full(&self) -> bool {
        self.written >= self.reel
    }

    /// What has been written since the last reel, with what the next step of each stage will take; `last`: there will be none
    /// beyond.
    pub(crate) fn reel(&mut self, rests: Vec<Rest>, last: bool) -> Reel {
        self.written = 0;
        let stages = self.stages.iter_mut().map(|stream| std::mem::take(&mut stream.bytes)).collect();
        Reel { stages, rests, last }
    }
}

impl Stream {
    #[inline]
    fn step(&mut self, demand: Demand, made: &Made, traffic: &Traffic) {
        let place = place(demand, made, traffic);
        let class = &mut self.classes[usize::from(place)];
        if !class.as_ref().is_some_and(|class| class.has(demand, made, traffic)) {
            let new = Class::of(demand, *made, traffic);
            self.bytes.extend([NEW, place]);
            new.write(&mut self.bytes);
            *class = Some(new);
        } else {
            self.bytes.push(place);
        }
        for r in traffic.requests.iter().chain(&traffic.look_ups) {
            let last = &mut self.last[r.client as usize % MAX_LINKS];
            put(&mut self.bytes, zigzag(r.address.wrapping_sub(*last)));
            *last = r.address;
        }
    }
}
