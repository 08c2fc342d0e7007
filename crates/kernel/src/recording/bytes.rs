//! Numbers as bytes.

use std::fmt;

/// An error in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingError {
    /// It ends within a step or a chunk.
    BreaksOff(&'static str),
    /// A value that no step can have.
    Value {
        /// Description of the value.
        what: &'static str,
        /// The value.
        value: u64,
        /// The allowed values.
        expected: &'static str,
    },
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BreaksOff(missing) => write!(f, "the recording ends early: {missing} is missing"),
            Self::Value { what, value, expected } => write!(f, "{what} is {value} in the recording, expected {expected}"),
        }
    }
}

impl std::error::Error for RecordingError {}

/// Appends a number, seven bits per byte, lowest first; the last byte is below 128.
#[inline]
pub(super) fn put(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// Reads a number from `bytes` at `at`.
///
/// # Errors
/// If the bytes end, or the number is wider than 64 bits.
#[inline]
pub(super) fn get(bytes: &[u8], at: &mut usize, what: &'static str) -> Result<u64, RecordingError> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let &byte = bytes.get(*at).ok_or(RecordingError::BreaksOff(what))?;
        *at += 1;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(value);
        }
    }
    Err(RecordingError::Value { what, value, expected: "a number of 64 bits" })
}

/// Like [`get`], with a maximum.
///
/// # Errors
/// Errors of [`get`], or if the number is larger than `most`.
pub(super) fn get_up_to(
    bytes: &[u8],
    at: &mut usize,
    what: &'static str,
    most: u64,
    expected: &'static str,
) -> Result<u64, RecordingError> {
    let value = get(bytes, at, what)?;
    if value <= most { Ok(value) } else { Err(RecordingError::Value { what, value, expected }) }
}

/// Encodes a difference so that small differences of either sign become small numbers.
#[inline]
pub(super) fn zigzag(difference: u64) -> u64 {
    let signed = difference as i64;
    ((signed << 1) ^ (signed >> 63)) as u64
}

/// Decodes a [`zigzag`] number.
#[inline]
pub(super) fn unzigzag(number: u64) -> u64 {
    (number >> 1) ^ (number & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_round_trip() {
        for value in [0, 1, 127, 128, 16_383, 16_384, u64::MAX / 2, u64::MAX] {
            let mut bytes = Vec::new();
            put(&mut bytes, value);
            let mut at = 0;
            assert_eq!((get(&bytes, &mut at, "it"), at), (Ok(value), bytes.len()));
            assert_eq!(get(&bytes[..bytes.len() - 1], &mut 0, "it"), Err(RecordingError::BreaksOff("it")));
            assert_eq!(unzigzag(zigzag(value)), value);
        }
        assert!(get(&[0xff; 10], &mut 0, "it").is_err());
        assert_eq!([0, 1_u64.wrapping_neg(), 1].map(zigzag), [0, 1, 2]);
    }
}
