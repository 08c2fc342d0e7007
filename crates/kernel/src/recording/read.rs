//! Reading of recordings.

use super::bytes::{RecordingError, get, unzigzag};
use super::chunk::RecordingChunk;
use super::decoded::{DecodedSteps, StageTags};
use super::step_class::{CLASSES, NEW, StepClass};
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::netlist::StageInfo;
use crate::step_requests::{RequestCount, RequestCursor, StepRequestsView, UnitRequests, request_error};
use crate::time::{CompactStep, FinalUnitState, InputMask, StepTiming};
use crate::{Demand, MemoryPorts, MemorySystem, Request};
use std::borrow::Cow;
use std::sync::Arc;

/// Bound of addresses, so that the end of no request overflows.
const ADDRESSES: u64 = 1 << 60;
/// Number of steps, and about the number of requests and lines, that are decoded at a time.
const AHEAD: usize = 512;
/// Maximum number of steps of a stage, and about of requests and lines, that are kept for sharing.
const SHARED: usize = 1 << 20;
/// Number of steps from which the memory for all is estimated. Lists that grew by doubling, each time into new memory, caused a fifth of
/// the page faults of bottleneck analysis.
const SAMPLE: usize = 4096;
/// Upper bound of the memory for such a step, request or line \[bytes\].
const SHARED_BYTES: u64 = 64;

/// The stream of one stage, as far as it has been read.
///
/// Some hundred steps are decoded at a time, with all of their look-ups, and then timed one by one.
#[derive(Clone, Debug)]
pub(crate) struct RecordingReader {
    bytes: Vec<u8>,
    at: usize,
    /// By place, each with a step of the class.
    classes: Vec<(CompactStep, StepClass)>,
    /// Decoded steps, and the next of them.
    ahead: Arc<DecodedSteps>,
    next: usize,
    /// True if the decoded steps are all steps of the stream.
    is_whole: bool,
    /// Steps before the decoded ones, if they are kept.
    earlier: Option<Vec<CompactStep>>,
    /// True if the last step has no requests.
    is_silent: bool,
    at_asked: RequestCursor,
    /// State of the unit after the stream, if it is known.
    rest: Option<FinalUnitState>,
    last: [u64; MAX_LINKS],
    ends: [usize; 2],
    tags: StageTags,
    /// Credits that the largest step needs, by client.
    largest: [u32; MAX_CLIENTS],
    /// Requests of the step being decoded.
    raw: Vec<Request>,
    pub(crate) error: Option<RecordingError>,
}

impl RecordingReader {
    /// Creates a reader of a stage before the first chunk.
    pub(crate) fn new(shape: &StageInfo, memories: &MemorySystem) -> Self {
        Self {
            bytes: Vec::new(),
            at: 0,
            classes: vec![(StepClass::UNDEFINED.step(0), StepClass::UNDEFINED); CLASSES + 1],
            ahead: Arc::default(),
            next: 0,
            is_whole: false,
            earlier: None,
            is_silent: true,
            at_asked: RequestCursor::default(),
            rest: None,
            last: [0; MAX_LINKS],
            ends: [shape.inputs.len(), shape.outputs.len()],
            tags: StageTags::new(shape, memories),
            largest: shape.credits,
            raw: Vec::new(),
            error: None,
        }
    }

    /// Creates a reader of a stage from all parts of its stream. Its clones share the steps. Returns `None` if there are too many
    /// steps for that or for `room` bytes, or the stream is invalid.
    pub(crate) fn of_whole_stream<'a>(
        shape: &StageInfo,
        memories: &MemorySystem,
        parts: impl Iterator<Item = (&'a [u8], FinalUnitState)>,
        room: u64,
    ) -> Option<Self> {
        let mut reader = Self::new(shape, memories);
        for (bytes, rest) in parts {
            reader.bytes.extend_from_slice(bytes);
            reader.rest = Some(rest);
        }
        let mut ahead = DecodedSteps::default();
        let most = SHARED.min((room / SHARED_BYTES) as usize);
        reader.read_up_to(most.min(SAMPLE), &mut ahead);
        ahead.reserve_for(reader.bytes.len(), reader.at);
        reader.read_up_to(most, &mut ahead);
        reader.is_whole = reader.at == reader.bytes.len() && reader.error.is_none();
        reader.ahead = Arc::new(ahead);
        // The decoding state is no longer needed.
        (reader.bytes, reader.at, reader.classes) = Default::default();
        reader.tags.free_tags();
        reader.is_whole.then_some(reader)
    }

    /// Returns true if the decoded requests hold for a stage and its memories.
    pub(crate) fn fits(&self, shape: &StageInfo, memories: &MemorySystem) -> bool {
        self.largest == shape.credits && self.tags.is_alike(shape, memories)
    }

    /// Keeps the steps from now on, or no more. Steps of a whole stream are kept in any case.
    pub(crate) fn keep_steps(&mut self, keeps: bool) {
        self.earlier = (keeps && !self.is_whole).then(Vec::new);
    }

    /// Returns the kept steps.
    pub(crate) fn kept_steps(&self) -> Cow<'_, [CompactStep]> {
        let ahead = self.ahead.steps.as_slice();
        self.earlier.as_ref().map_or(Cow::Borrowed(ahead), |earlier| [earlier, ahead].concat().into())
    }

    /// Appends a part of the stream.
    pub(crate) fn feed(&mut self, bytes: &[u8], rest: FinalUnitState) {
        self.bytes.drain(..self.at);
        self.at = 0;
        self.bytes.extend_from_slice(bytes);
        self.rest = Some(rest);
        if !self.has_step() {
            self.read_ahead();
        }
    }

    /// Number of bytes that are not decoded yet.
    pub(crate) fn bytes_left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Returns true if there is a step.
    #[inline(always)]
    pub(crate) fn has_step(&self) -> bool {
        self.next < self.ahead.steps.len()
    }

    /// Returns the inputs of the next step; `NO_STEP` if they are unknown.
    #[inline(always)]
    pub(crate) fn next_inputs(&self) -> InputMask {
        match self.ahead.steps.get(self.next) {
            Some(step) => step.takes,
            None => self.takes_behind(),
        }
    }

    #[cold]
    fn takes_behind(&self) -> InputMask {
        self.rest.map_or(InputMask::NO_STEP, |rest| InputMask::of(rest.demand, self.ends[0]))
    }

    /// Returns the demand of the next step, if it is known.
    pub(crate) fn demand(&self) -> Option<Demand> {
        match self.ahead.steps.get(self.next) {
            Some(step) => Some(step.takes.demand()),
            None => self.rest.map(|rest| rest.demand),
        }
    }

    /// Returns true if the unit holds no token back after the stream.
    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_some_and(|rest| rest.empty)
    }

    /// Returns the next step. There must be one.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> StepTiming {
        let step = &self.ahead.steps[self.next];
        self.is_silent = step.is_silent();
        step.timing()
    }

    /// Returns true if that step has no memory requests.
    #[inline(always)]
    pub(crate) fn is_silent(&self) -> bool {
        self.is_silent
    }

    /// Returns the memory requests of that step. An error in them goes to `traffic`.
    #[inline(always)]
    pub(crate) fn next_requests(&mut self, traffic: &mut MemoryPorts) -> Option<StepRequestsView<'_>> {
        let DecodedSteps { steps, refused, asked } = &*self.ahead;
        let step = &steps[self.next];
        if step.is_refused() {
            traffic.fault(refused.clone().unwrap_or_default());
            return None;
        }
        Some(asked.next(&mut self.at_asked, step.count()))
    }

    /// Moves on to the next step.
    #[inline(always)]
    pub(crate) fn go_on(&mut self) {
        self.next += 1;
        if self.next == self.ahead.steps.len() && self.at < self.bytes.len() {
            self.read_ahead();
        }
    }

    /// Decodes more steps, once the decoded ones are used.
    #[inline(never)]
    fn read_ahead(&mut self) {
        // Steps that are decoded piece by piece are not shared.
        let mut ahead = Arc::try_unwrap(std::mem::take(&mut self.ahead)).unwrap_or_default();
        if let Some(earlier) = &mut self.earlier {
            earlier.append(&mut ahead.steps);
        }
        ahead.steps.clear();
        ahead.asked.clear();
        (self.next, self.at_asked) = Default::default();
        self.read_up_to(AHEAD, &mut ahead);
        self.ahead = Arc::new(ahead);
    }

    /// Decodes up to about so many steps, or requests and lines.
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

    /// Decodes a step of the class at this place, or of a new class.
    #[inline(always)]
    fn read_step(&mut self, mut place: u8, ahead: &mut DecodedSteps) -> Result<(), RecordingError> {
        if place == NEW {
            place = self.define()?;
        }
        let (step, class) = &self.classes[usize::from(place)];
        if step.is_undefined() {
            let (what, expected) = ("the class of a step", "one that was defined before");
            return Err(RecordingError::Value { what, value: place.into(), expected });
        }
        let mut step = *step;
        if class.count == RequestCount::default() {
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
        let (requests, look_ups) = self.raw.split_at(class.requests.len());
        let asks = UnitRequests { requests, look_ups };
        if ahead.asked.settle(asks, &mut self.tags, &self.largest) {
            self.tags.count(ahead.asked.last(class.count.caches), requests);
        } else {
            ahead.refused = Some(request_error(asks, &mut self.tags, &self.largest));
            step = step.as_refused();
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
        self.classes[usize::from(place)] = (class.step(self.ends[0]), class);
        Ok(place)
    }
}

impl RecordingChunk {
    /// Passes the chunk to the readers of all stages.
    pub(crate) fn feed(&self, readers: &mut [RecordingReader]) {
        for ((reader, bytes), &rest) in readers.iter_mut().zip(&self.stages).zip(&self.unit_states) {
            reader.feed(bytes, rest);
        }
    }
}
