//! Writing of recordings.

use super::bytes::{put, zigzag};
use super::chunk::RecordingChunk;
use super::step_class::{CLASSES, NEW, StepClass, is_too_long, slot_of};
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::netlist::Netlist;
use crate::step_requests::UnitRequests;
use crate::time::{FinalUnitState, StepTiming};
use crate::{Demand, MemoryPorts, MemorySystem, Request};

/// Records the steps of all stages of a run.
#[derive(Clone, Debug)]
pub(crate) struct RecordingWriter {
    stages: Vec<StageStream>,
    written: usize,
    /// Minimum size of a chunk \[bytes\].
    chunk_bytes: usize,
}

/// The stream of one stage.
#[derive(Clone, Debug)]
struct StageStream {
    bytes: Vec<u8>,
    classes: Vec<Option<StepClass>>,
    /// Last address of each client.
    last: [u64; MAX_LINKS],
    /// Line size of each client's cache \[bytes\].
    line_bytes: [u32; MAX_CLIENTS],
    /// Look-ups of the current step, each line once.
    look_ups: Vec<Request>,
    has_long_step: bool,
}

impl RecordingWriter {
    pub(crate) fn new(shape: &Netlist, memories: &MemorySystem, chunk_bytes: usize) -> Self {
        let lines: Vec<u32> = memories.line_bytes().map(|bytes| bytes.unwrap_or(1)).collect();
        let stream = |clients: &[usize]| StageStream {
            bytes: Vec::new(),
            classes: vec![None; CLASSES],
            last: [0; MAX_LINKS],
            line_bytes: std::array::from_fn(|i| clients.get(i).map_or(1, |&client| lines[client])),
            look_ups: Vec::new(),
            has_long_step: false,
        };
        Self { stages: shape.stages.iter().map(|stage| stream(&stage.clients)).collect(), written: 0, chunk_bytes }
    }

    /// Records a step with its direct requests, once they are settled.
    #[inline]
    pub(crate) fn step(&mut self, stage: usize, demand: Demand, made: &StepTiming, requests: &[Request], settled: &MemoryPorts) {
        let stream = &mut self.stages[stage];
        let before = stream.bytes.len();
        stream.step(demand, made, requests, settled);
        self.written += stream.bytes.len() - before;
    }

    /// Returns true if there is enough for a chunk.
    pub(crate) fn is_full(&self) -> bool {
        self.written >= self.chunk_bytes
    }

    /// Returns the bytes since the last chunk, with the state of each unit after them. `last`: true for the last chunk.
    pub(crate) fn finish_chunk(&mut self, unit_states: Vec<FinalUnitState>, last: bool) -> RecordingChunk {
        self.written = 0;
        let stages = self.stages.iter_mut().map(|stream| std::mem::take(&mut stream.bytes)).collect();
        let has_long_step = self.stages.iter().any(|stream| stream.has_long_step);
        RecordingChunk { stages, unit_states, last, has_long_step }
    }
}

impl StageStream {
    #[inline]
    fn step(&mut self, demand: Demand, made: &StepTiming, requests: &[Request], settled: &MemoryPorts) {
        self.look_ups.clear();
        for (client, line) in settled.lines() {
            let address = line * u64::from(self.line_bytes[client as usize % MAX_CLIENTS]);
            self.look_ups.push(Request { client, write: false, address, bytes: 1 });
        }
        let asks = UnitRequests { requests, look_ups: &self.look_ups };
        let place = slot_of(demand, made, asks);
        let class = &mut self.classes[usize::from(place)];
        if !class.as_ref().is_some_and(|class| class.contains(demand, made, asks)) {
            let new = StepClass::of(demand, *made, asks);
            self.has_long_step |= is_too_long(made);
            self.bytes.extend([NEW, place]);
            new.write(&mut self.bytes);
            *class = Some(new);
        } else {
            self.bytes.push(place);
        }
        for r in asks.all() {
            let last = &mut self.last[r.client as usize % MAX_LINKS];
            put(&mut self.bytes, zigzag(r.address.wrapping_sub(*last)));
            *last = r.address;
        }
    }
}
