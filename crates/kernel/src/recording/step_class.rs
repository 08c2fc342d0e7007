//! Classes of steps: the common part of equal steps, without addresses.

use super::bytes::{RecordingError, get_up_to, put};
use crate::capacity::MAX_LINKS;
use crate::step_requests::{RequestCount, UnitRequests};
use crate::time::{CompactStep, InputMask, StepTiming};
use crate::{Demand, Request};

/// Number of places for classes.
pub(super) const CLASSES: usize = 255;
/// Marks a step whose class follows and takes a place.
pub(super) const NEW: u8 = CLASSES as u8;

/// Maximum occupancy and latency of a recorded step \[cycles\], so that no sum of them overflows.
const LONGEST: u64 = u32::MAX as u64;
/// Maximum number of requests, and of look-ups, of a step, and of bytes of a request.
const MOST: u64 = 1 << 20;

/// Bits of the outputs of a class, beyond the outputs and the mark. Recordings of machines without blocking steps and work after
/// data have neither.
const BLOCKS: u64 = 2 << MAX_LINKS;
const HAS_AFTER_DATA: u64 = BLOCKS << 1;

/// The common part of the steps of a class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StepClass {
    pub(super) demand: Demand,
    pub(super) timing: StepTiming,
    /// Their addresses are 0.
    pub(super) requests: Vec<Request>,
    pub(super) look_ups: Vec<Request>,
    pub(super) count: RequestCount,
}

impl StepClass {
    /// A class without a definition.
    pub(super) const UNDEFINED: Self = Self {
        demand: Demand::Finished,
        timing: StepTiming { occupancy: 0, latency: 0, after_data: 0, outputs: 0, marked: false, blocking: false },
        requests: vec![],
        look_ups: vec![],
        count: RequestCount { requests: 0, caches: 0 },
    };

    fn new(demand: Demand, made: StepTiming, requests: Vec<Request>, look_ups: Vec<Request>) -> Self {
        let clients = look_ups.iter().fold(0_u32, |clients, r| clients | 1 << (r.client % 32));
        let count = RequestCount { requests: requests.len(), caches: clients.count_ones() as usize };
        Self { demand, timing: made, requests, look_ups, count }
    }

    pub(super) fn of(demand: Demand, made: StepTiming, asked: UnitRequests<'_>) -> Self {
        let strip = |requests: &[Request]| requests.iter().map(|r| Request { address: 0, ..*r }).collect();
        Self::new(demand, made, strip(asked.requests), strip(asked.look_ups))
    }

    /// Returns a step of this class of a stage with this number of inputs.
    pub(super) fn step(&self, inputs: usize) -> CompactStep {
        CompactStep::new(InputMask::of(self.demand, inputs), &self.timing, self.count)
    }

    /// Returns true if a step belongs to this class.
    #[inline]
    pub(super) fn contains(&self, demand: Demand, made: &StepTiming, asked: UnitRequests<'_>) -> bool {
        self.demand == demand
            && self.timing == *made
            && differ_in_address_only(&self.requests, asked.requests)
            && differ_in_address_only(&self.look_ups, asked.look_ups)
    }

    pub(super) fn write(&self, bytes: &mut Vec<u8>) {
        let StepTiming { occupancy, latency, after_data, outputs, marked, blocking } = self.timing;
        let extras = if blocking { BLOCKS } else { 0 } | if after_data > 0 { HAS_AFTER_DATA } else { 0 };
        put(bytes, code(self.demand));
        put(bytes, extras | u64::from(outputs) << 1 | u64::from(marked));
        put(bytes, occupancy);
        put(bytes, latency);
        if after_data > 0 {
            put(bytes, after_data.into());
        }
        for requests in [&self.requests, &self.look_ups] {
            put(bytes, requests.len() as u64);
            for r in requests {
                put(bytes, u64::from(r.client) << 1 | u64::from(r.write));
                put(bytes, r.bytes.into());
            }
        }
    }

    /// Decodes a class.
    ///
    /// # Errors
    /// If it is not valid for a stage with so many inputs and outputs.
    pub(super) fn read(bytes: &[u8], at: &mut usize, [inputs, outputs]: [usize; 2]) -> Result<Self, RecordingError> {
        let demand = demand_of(get_up_to(bytes, at, "the demand of a step", u64::MAX, "")?, inputs)?;
        let all: u64 = (1 << outputs << 1) - 1;
        let (what, expected) = ("the set of outputs of a step", "outputs that the stage has");
        let bits = get_up_to(bytes, at, what, u64::MAX, expected)?;
        let delivers = bits & !(BLOCKS | HAS_AFTER_DATA);
        if delivers > all {
            return Err(RecordingError::Value { what, value: delivers, expected });
        }
        let occupancy = get_up_to(bytes, at, "the occupancy of a step", LONGEST, "1 to 4294967295 cycles")?;
        if occupancy == 0 {
            let (what, expected) = ("the occupancy of a step", "1 to 4294967295 cycles");
            return Err(RecordingError::Value { what, value: 0, expected });
        }
        let latency = get_up_to(bytes, at, "the latency of a step", LONGEST, "at most 4294967295 cycles")?;
        let after_data = if bits & HAS_AFTER_DATA == 0 {
            0
        } else {
            get_up_to(bytes, at, "the work after data of a step", LONGEST, "at most 4294967295 cycles")? as u32
        };
        let (outputs, marked, blocking) = ((delivers >> 1) as u32, delivers & 1 != 0, bits & BLOCKS != 0);
        let made = StepTiming { occupancy, latency, after_data, outputs, marked, blocking };
        let mut requests = || -> Result<Vec<Request>, RecordingError> {
            let count = get_up_to(bytes, at, "the number of requests of a step", MOST, "at most 1048576")?;
            (0..count).map(|_| request(bytes, at)).collect()
        };
        let (requests, look_ups) = (requests()?, requests()?);
        Ok(Self::new(demand, made, requests, look_ups))
    }
}

fn request(bytes: &[u8], at: &mut usize) -> Result<Request, RecordingError> {
    let client = get_up_to(bytes, at, "a client", 2 * MAX_LINKS as u64, "one of the stage's")?;
    let size = get_up_to(bytes, at, "the size of a request", MOST, "at most 1048576 bytes")?;
    Ok(Request { client: (client >> 1) as u32, write: client & 1 != 0, address: 0, bytes: size as u32 })
}

/// Returns true if a step takes more cycles than a recording can hold.
pub(super) fn is_too_long(made: &StepTiming) -> bool {
    made.occupancy.max(made.latency) > LONGEST
}

/// Returns true if requests differ in their addresses only.
#[inline]
fn differ_in_address_only(class: &[Request], requests: &[Request]) -> bool {
    let same = |(a, b): (&Request, &Request)| a.client == b.client && a.write == b.write && a.bytes == b.bytes;
    class.len() == requests.len() && class.iter().zip(requests).all(same)
}

/// Returns the place of a step's class. Steps of one class always have the same place.
#[inline]
pub(super) fn slot_of(demand: Demand, made: &StepTiming, asked: UnitRequests<'_>) -> u8 {
    let mut hash = code(demand);
    let mut mix = |value: u64| hash = (hash ^ value).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    mix(made.occupancy);
    mix(made.latency << 16 | u64::from(made.outputs) << 1 | u64::from(made.marked));
    if made.blocking || made.after_data > 0 {
        mix(u64::from(made.after_data) << 1 | u64::from(made.blocking));
    }
    for r in asked.all() {
        mix(u64::from(r.bytes) << 8 | u64::from(r.client) << 1 | u64::from(r.write));
    }
    ((hash >> 32) % CLASSES as u64) as u8
}

/// Encodes a demand.
pub(super) fn code(demand: Demand) -> u64 {
    match demand {
        Demand::Nothing => 0,
        Demand::All => 1,
        Demand::Finished => 2,
        Demand::Only(k) => 3 + k as u64,
    }
}

/// Decodes a demand.
///
/// # Errors
/// If it names an input that does not exist.
pub(super) fn demand_of(code: u64, inputs: usize) -> Result<Demand, RecordingError> {
    match code {
        0 => Ok(Demand::Nothing),
        1 => Ok(Demand::All),
        2 => Ok(Demand::Finished),
        k if k < 3 + inputs as u64 => Ok(Demand::Only((k - 3) as usize)),
        value => Err(RecordingError::Value { what: "the demand of a step", value, expected: "inputs that the stage has" }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step with one input and one output.
    fn class(after_data: u32, blocking: bool) -> StepClass {
        let made = StepTiming { occupancy: 3, latency: 200, after_data, outputs: 1, marked: true, blocking };
        StepClass::of(Demand::All, made, UnitRequests { requests: &[], look_ups: &[] })
    }

    #[test]
    fn step_without_data_use_has_bytes_of_old_recordings() {
        let mut bytes = Vec::new();
        class(0, false).write(&mut bytes);
        // Demand, outputs and mark, occupancy, latency, number of requests, number of look-ups.
        assert_eq!(bytes, [1, 3, 3, 0x80 | (200 - 128), 1, 0, 0]);
        assert_eq!(StepClass::read(&bytes, &mut 0, [1, 1]), Ok(class(0, false)));
    }

    #[test]
    fn data_use_round_trips() {
        let mut places = Vec::new();
        for class in [class(0, true), class(7, false), class(7, true), class(900, true)] {
            let mut bytes = Vec::new();
            class.write(&mut bytes);
            let mut at = 0;
            assert_eq!(StepClass::read(&bytes, &mut at, [1, 1]).as_ref(), Ok(&class));
            assert_eq!(at, bytes.len());
            places.push(slot_of(class.demand, &class.timing, UnitRequests { requests: &[], look_ups: &[] }));
        }
        places.dedup();
        assert_eq!(places.len(), 4, "other classes usually have other places");
    }

    #[test]
    fn outputs_beyond_those_of_stage_are_errors() {
        let mut bytes = Vec::new();
        class(7, true).write(&mut bytes);
        let error = StepClass::read(&bytes, &mut 0, [1, 0]).unwrap_err();
        let (what, expected) = ("the set of outputs of a step", "outputs that the stage has");
        assert_eq!(error, RecordingError::Value { what, value: 3, expected });
    }
}
