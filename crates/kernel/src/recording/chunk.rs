//! Chunks of a recording.

use super::bytes::{RecordingError, get, get_up_to, put};
use super::step_class::{code, demand_of};
use crate::capacity::MAX_LINKS;
use crate::time::FinalUnitState;

/// A part of each stage's stream, in whole steps, with the state of each unit after it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingChunk {
    pub(crate) stages: Vec<Vec<u8>>,
    pub(crate) unit_states: Vec<FinalUnitState>,
    pub(crate) last: bool,
    /// True if it or an earlier chunk has a step that cannot be read back.
    pub(crate) has_long_step: bool,
}

impl RecordingChunk {
    /// Returns the part of a stage's stream, with the state of its unit after it.
    pub(crate) fn stage_part(&self, stage: usize) -> Option<(&[u8], FinalUnitState)> {
        Some((self.stages.get(stage)?, *self.unit_states.get(stage)?))
    }

    /// Returns the part of each stage's stream, in the order of the wiring. The cuts between chunks depend on timing; the whole
    /// streams do not.
    pub fn streams(&self) -> impl Iterator<Item = &[u8]> {
        self.stages.iter().map(Vec::as_slice)
    }

    /// Returns true if a step so far takes more than 4,294,967,295 cycles. The recording cannot be read back.
    pub fn has_long_step(&self) -> bool {
        self.has_long_step
    }

    /// Encodes the chunk.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&mut bytes, self.last.into());
        put(&mut bytes, self.stages.len() as u64);
        for (stream, rest) in self.stages.iter().zip(&self.unit_states) {
            put(&mut bytes, code(rest.demand) << 1 | u64::from(rest.empty));
            put(&mut bytes, stream.len() as u64);
            bytes.extend_from_slice(stream);
        }
        bytes
    }

    /// Decodes a chunk.
    ///
    /// # Errors
    /// If the bytes are not a valid chunk.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RecordingError> {
        let mut at = 0;
        let last = get_up_to(bytes, &mut at, "the end flag of a chunk", 1, "0 or 1")? == 1;
        let count = get_up_to(bytes, &mut at, "the number of stages", 4096, "at most 4096")?;
        let mut chunk = Self { stages: Vec::new(), unit_states: Vec::new(), last, has_long_step: false };
        for _ in 0..count {
            let rest = get(bytes, &mut at, "the final state of a unit")?;
            chunk.unit_states.push(FinalUnitState { demand: demand_of(rest >> 1, MAX_LINKS)?, empty: rest & 1 != 0 });
            let length = get(bytes, &mut at, "the length of a stream")?;
            let end = usize::try_from(length).ok().and_then(|length| at.checked_add(length));
            let stream = end.and_then(|end| bytes.get(at..end)).ok_or(RecordingError::BreaksOff("a stream"))?;
            chunk.stages.push(stream.to_vec());
            at += stream.len();
        }
        if at < bytes.len() {
            let value = (bytes.len() - at) as u64;
            return Err(RecordingError::Value { what: "the length of the data after a chunk", value, expected: "0" });
        }
        Ok(chunk)
    }
}
