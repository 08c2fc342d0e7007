//! Reading a tape.

use super::bytes::{TapeError, get, unzigzag};
use super::class::{CLASSES, Class, NEW};
use super::reel::Reel;
use crate::time::{Made, Rest};
use crate::wiring::MAX_LINKS;
use crate::{Demand, Traffic};

/// Addresses are below this, so that none of what lies beside them overflows.
const ADDRESSES: u64 = 1 << 60;

/// The stream of one stage, as far as it has been read.
#[derive(Clone, Debug)]
pub(crate) struct Reader {
    bytes: Vec<u8>,
    at: usize,
    classes: Vec<Option<Class>>,
    /// Place of the class of the next step; none where the stream ends.
    next: Option<usize>,
    /// What the step after the stream will take, if that is known.
    rest: Option<Rest>,
    last: [u64; MAX_LINKS],
    inputs: usize,
    outputs: usize,
    pub(crate) error: Option<TapeError>,
}

impl Reader {
    /// Of a stage with so many inputs and outputs, before the first reel.
    pub(crate) fn new(inputs: usize, outputs: usize) -> Self {
        let (bytes, classes, last) = (Vec::new(), vec![None; CLASSES], [0; MAX_LINKS]);
        Self { bytes, at: 0, classes, next: None, rest: None, last, inputs, outputs, error: None }
    }

    /// Goes on with a piece of the stream.
    pub(crate) fn feed(&mut self, bytes: &[u8], rest: Rest) {
        self.bytes.drain(..self.at);
        self.at = 0;
        self.bytes.extend_from_slice(bytes);
        self.rest = Some(rest);
        if self.next.is_none() {
            self.look_ahead();
        }
    }

    /// Bytes that are not read yet.
    pub(crate) fn waiting(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Inputs and outputs of the stage.
    pub(crate) fn ends(&self) -> [usize; 2] {
        [self.inputs, self.outputs]
    }

    /// Whether there is a step.
    #[inline(always)]
    pub(crate) fn has_step(&self) -> bool {
        self.next.is_some()
    }

    /// What the next step takes, if that is known.
    #[inline(always)]
    pub(crate) fn demand(&self) -> Option<Demand> {
        match self.next {
            Some(place) => self.classes[place].as_ref().map(|class| class.demand),
            None => self.rest.map(|rest| rest.demand),
        }
    }

    /// Whether the unit holds no token back after the stream.
    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_some_and(|rest| rest.empty)
    }

    /// The next step, with its traffic.
    #[inline]
    pub(crate) fn step(&mut self, traffic: &mut Traffic) -> Option<Made> {
        let class = self.classes[self.next?].as_ref()?;
        let made = class.made;
        if !class.requests.is_empty() || !class.look_ups.is_empty() {
            traffic.requests.extend_from_slice(&class.requests);
            traffic.look_ups.extend_from_slice(&class.look_ups);
            for r in traffic.requests.iter_mut().chain(&mut traffic.look_ups) {
                let last = &mut self.last[r.client as usize % MAX_LINKS];
                match get(&self.bytes, &mut self.at, "an address") {
                    Ok(difference) => *last = last.wrapping_add(unzigzag(difference)) % ADDRESSES,
                    Err(error) => self.error = Some(error),
                }
                r.address = *last;
            }
        }
        self.look_ahead();
        Some(made)
    }

    /// Reads the class of the next step.
    #[inline]
    fn look_ahead(&mut self) {
        self.next = None;
        let Some(&place) = self.bytes.get(self.at) else { return };
        self.at += 1;
        let found = if place == NEW { self.define() } else { Ok(usize::from(place)) };
        match found {
            Ok(place) if self.classes[place].is_some() => self.next = Some(place),
            Ok(place) => {
                let (what, expected) = ("the class of a step", "one that was defined before");
                self.error = Some(TapeError::Value { what, value: place as u64, expected });
            }
            Err(error) => self.error = Some(error),
        }
    }

    #[cold]
    fn define(&mut self) -> Result<usize, TapeError> {
        let place = usize::from(*self.bytes.get(self.at).ok_or(TapeError::BreaksOff("the place of a class"))?);
        self.at += 1;
        if place >= CLASSES {
            return Err(TapeError::Value { what: "the place of a class", value: place as u64, expected: "0 to 254" });
        }
        let class = Class::read(&self.bytes, &mut self.at, [self.inputs, self.outputs])?;
        self.classes[place] = Some(class);
        Ok(place)
    }
}

impl Reel {
    /// Feeds the readers of all stages.
    pub(crate) fn feed(&self, readers: &mut [Reader]) {
        for ((reader, bytes), &rest) in readers.iter_mut().zip(&self.stages).zip(&self.rests) {
            reader.feed(bytes, rest);
        }
    }
}
