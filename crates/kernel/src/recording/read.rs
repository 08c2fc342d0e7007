//! Reading a tape.

use super::bytes::{RecordingError, get, unzigzag};
use super::chunk::RecordingChunk;
use super::decoded::{DecodedSteps, RecordedStep, StageTags};
use super::step_class::{CLASSES, NEW, StepClass};
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::netlist::StageInfo;
use crate::step_requests::{Count, Cursor, StepRequestsView, objection};
use crate::time::{FinalUnitState, InputMask, StepTiming};
use crate::{Demand, MemoryPorts, MemorySystem, Request};
use std::sync::Arc;

/// Addresses are below this, so that none of what lies beside them overflows.
const ADDRESSES: u64 = 1 << 60;
/// Steps that are read at a time, and about as many requests and lines.
const AHEAD: usize = 512;
/// Most steps of a stage, and about as many requests and lines, that are kept to be shared.
const SHARED: usize = 1 << 20;
/// What such a step takes, or a request or line of it, at most \[bytes\].
const SHARED_BYTES: u64 = 64;

/// The stream of one stage, as far as it has been read.
///
/// Steps are read some hundred at a time, with all of their look-ups, and then timed one after the other.
#[derive(Clone, Debug)]
pub(crate) struct RecordingReader {
    bytes: Vec<u8>,
    at: usize,
    /// By place, each with a step of it; occupancy 0 where there is none yet.
    classes: Vec<(RecordedStep, StepClass)>,
    /// What is read, and the next step of it.
    ahead: Arc<DecodedSteps>,
    next: usize,
    /// Whether the step that was made last asks nothing.
    is_silent: bool,
    at_asked: Cursor,
    /// What the step after the stream will take, if that is known.
    rest: Option<FinalUnitState>,
    last: [u64; MAX_LINKS],
    ends: [usize; 2],
    tags: StageTags,
    /// What the largest step needs, by client.
    largest: [u32; MAX_CLIENTS],
    /// The step being read.
    raw: Vec<Request>,
    pub(crate) error: Option<RecordingError>,
}

impl RecordingReader {
    /// Of a stage, before the first reel.
    pub(crate) fn new(shape: &StageInfo, memories: &MemorySystem) -> Self {
        Self {
            bytes: Vec::new(),
            at: 0,
            classes: vec![(RecordedStep::of(&StepClass::UNDEFINED, 0), StepClass::UNDEFINED); CLASSES + 1],
            ahead: Arc::default(),
            next: 0,
            is_silent: true,
            at_asked: Cursor::default(),
            rest: None,
            last: [0; MAX_LINKS],
            ends: [shape.inputs.len(), shape.outputs.len()],
            tags: StageTags::new(shape, memories),
            largest: shape.credits,
            raw: Vec::new(),
            error: None,
        }
    }

    /// Of a stage whose whole stream these pieces are: its clones share the steps. None where they are too many for that, or for so
    /// many bytes of `room`, or no steps.
    pub(crate) fn whole<'a>(
        shape: &StageInfo,
        memories: &MemorySystem,
        pieces: impl Iterator<Item = (&'a [u8], FinalUnitState)>,
        room: u64,
    ) -> Option<Self> {
        let mut reader = Self::new(shape, memories);
        for (bytes, rest) in pieces {
            reader.bytes.extend_from_slice(bytes);
            reader.rest = Some(rest);
        }
        let mut ahead = DecodedSteps::default();
        reader.read_up_to(SHARED.min((room / SHARED_BYTES) as usize), &mut ahead);
        let is_whole = reader.at == reader.bytes.len() && reader.error.is_none();
        reader.ahead = Arc::new(ahead);
        // What it was read by is of no more use.
        (reader.bytes, reader.at, reader.classes) = Default::default();
        reader.tags.forget();
        is_whole.then_some(reader)
    }

    /// Whether the steps that were read ask the same of a stage and its memories.
    pub(crate) fn fits(&self, shape: &StageInfo, memories: &MemorySystem) -> bool {
        self.largest == shape.credits && self.tags.is_alike(shape, memories)
    }

    /// Goes on with a piece of the stream.
    pub(crate) fn feed(&mut self, bytes: &[u8], rest: FinalUnitState) {
        self.bytes.drain(..self.at);
        self.at = 0;
        self.bytes.extend_from_slice(bytes);
        self.rest = Some(rest);
        if !self.has_step() {
            self.read_ahead();
        }
    }

    /// Bytes that are not read yet.
    pub(crate) fn waiting(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Whether there is a step.
    #[inline(always)]
    pub(crate) fn has_step(&self) -> bool {
        self.next < self.ahead.steps.len()
    }

    /// What the next step takes; no step where that is not known.
    #[inline(always)]
    pub(crate) fn takes(&self) -> InputMask {
        match self.ahead.steps.get(self.next) {
            Some(step) => step.takes,
            None => self.takes_behind(),
        }
    }

    #[cold]
    fn takes_behind(&self) -> InputMask {
        self.rest.map_or(InputMask::NO_STEP, |rest| InputMask::of(rest.demand, self.ends[0]))
    }

    /// The same as a unit would declare it, if that is known.
    pub(crate) fn demand(&self) -> Option<Demand> {
        match self.ahead.steps.get(self.next) {
            Some(step) => Some(step.takes.demand()),
            None => self.rest.map(|rest| rest.demand),
        }
    }

    /// Whether the unit holds no token back after the stream.
    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_some_and(|rest| rest.empty)
    }

    /// The next step, which there is.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> StepTiming {
        let step = &self.ahead.steps[self.next];
        self.is_silent = step.is_silent();
        step.made()
    }

    /// Whether that step asks nothing of memories.
    #[inline(always)]
    pub(crate) fn is_silent(&self) -> bool {
        self.is_silent
    }

    /// What that step asks of memories; what is wrong with it goes to `traffic`.
    #[inline(always)]
    pub(crate) fn asks(&mut self, traffic: &mut MemoryPorts) -> Option<StepRequestsView<'_>> {
        let DecodedSteps { steps, refused, asked } = &*self.ahead;
        let step = &steps[self.next];
        if step.is_refused() {
            traffic.fault(refused.clone().unwrap_or_default());
            return None;
        }
        Some(asked.next(&mut self.at_asked, step.count()))
    }

    /// Goes on behind it.
    #[inline(always)]
    pub(crate) fn go_on(&mut self) {
        self.next += 1;
        if self.next == self.ahead.steps.len() && self.at < self.bytes.len() {
            self.read_ahead();
        }
    }

    /// Reads the next steps, once those before are made.
    #[inline(never)]
    fn read_ahead(&mut self) {
        // Nobody shares what is read piece by piece.
        let mut ahead = Arc::try_unwrap(std::mem::take(&mut self.ahead)).unwrap_or_default();
        ahead.steps.clear();
        ahead.asked.clear();
        (self.next, self.at_asked) = Default::default();
        self.read_up_to(AHEAD, &mut ahead);
        self.ahead = Arc::new(ahead);
    }

    /// Reads steps up to about so many, or requests and lines.
    fn read_up_to(&mut self, most: usize, ahead: &mut DecodedSteps) {
        while ahead.steps.len() < most && ahead.asked.len() < most && ahead.refused.is_none() {
            let Some(&place) = self.bytes.get(self.at) else { return };
            self.at += 1;
            if let Err(error) = self.read_step(place, ahead) {
                self.error = Some(error);
                return;
            }
        }
    }

    /// Reads a step of the class at this place, or of a new one.
    #[inline(always)]
    fn read_step(&mut self, mut place: u8, ahead: &mut DecodedSteps) -> Result<(), RecordingError> {
        if place == NEW {
            place = self.define()?;
        }
        let (step, class) = &self.classes[usize::from(place)];
        if step.occupancy == 0 {
            let (what, expected) = ("the class of a step", "one that was defined before");
            return Err(RecordingError::Value { what, value: place.into(), expected });
        }
        let mut step = *step;
        if class.count == Count::default() {
            ahead.steps.push(step);
            return Ok(());
        }
        self.raw.clear();
        self.raw.extend_from_slice(&class.requests);
        self.raw.extend_from_slice(&class.look_ups);
        for r in &mut self.raw {
            let last = &mut self.last[r.client as usize % MAX_LINKS];
            *last = last.wrapping_add(unzigzag(get(&self.bytes, &mut self.at, "an address")?)) % ADDRESSES;
            r.address = *last;
        }
        let asks = self.raw.split_at(class.requests.len());
        if ahead.asked.settle(asks, &mut self.tags, &self.largest) {
            self.tags.count(ahead.asked.last(class.count.caches), asks.0);
        } else {
            ahead.refused = Some(objection(asks, &mut self.tags, &self.largest));
            step = step.refused();
        }
        ahead.steps.push(step);
        Ok(())
    }

    #[cold]
    fn define(&mut self) -> Result<u8, RecordingError> {
        let place = *self.bytes.get(self.at).ok_or(RecordingError::BreaksOff("the place of a class"))?;
        self.at += 1;
        if usize::from(place) >= CLASSES {
            return Err(RecordingError::Value { what: "the place of a class", value: place.into(), expected: "0 to 254" });
        }
        let class = StepClass::read(&self.bytes, &mut self.at, self.ends)?;
        self.classes[usize::from(place)] = (RecordedStep::of(&class, self.ends[0]), class);
        Ok(place)
    }
}

impl RecordingChunk {
    /// Feeds the readers of all stages.
    pub(crate) fn feed(&self, readers: &mut [RecordingReader]) {
        for ((reader, bytes), &rest) in readers.iter_mut().zip(&self.stages).zip(&self.unit_states) {
            reader.feed(bytes, rest);
        }
    }
}
