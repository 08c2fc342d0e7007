//! Wire format of questions and answers: JSON followed by bytes.

use serde_json::Value;

/// JSON, and bytes that it refers to by offset and length. The wire format is the length of the JSON \[32 bits, little endian\],
/// the JSON, and the bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parcel {
    /// The JSON.
    pub json: Value,
    /// The bytes after the JSON.
    pub rest: Vec<u8>,
}

const LENGTH: usize = 4;

impl Parcel {
    /// Makes a parcel of JSON alone.
    pub fn of(json: Value) -> Self {
        Self { json, rest: Vec::new() }
    }

    /// Appends bytes and returns their offset and length.
    pub(crate) fn pack(&mut self, bytes: &[u8]) -> [usize; 2] {
        let place = self.rest.len();
        self.rest.extend_from_slice(bytes);
        [place, bytes.len()]
    }

    /// Returns the bytes at an offset and length.
    pub fn bytes(&self, [place, length]: [usize; 2]) -> Option<&[u8]> {
        self.rest.get(place..place.checked_add(length)?)
    }

    /// Encodes the parcel.
    pub fn into_bytes(self) -> Vec<u8> {
        let json = self.json.to_string();
        let mut bytes = Vec::with_capacity(LENGTH + json.len() + self.rest.len());
        bytes.extend_from_slice(&(json.len() as u32).to_le_bytes());
        bytes.extend_from_slice(json.as_bytes());
        bytes.extend_from_slice(&self.rest);
        bytes
    }

    /// Decodes a parcel.
    ///
    /// # Errors
    /// If the length or the JSON is invalid.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let short = "a parcel is shorter than it says";
        let (length, behind) = bytes.split_first_chunk::<LENGTH>().ok_or(short)?;
        let (json, rest) = behind.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or(short)?;
        let json = serde_json::from_slice(json).map_err(|error| format!("a parcel holds no JSON: {error}"))?;
        Ok(Self { json, rest: rest.to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn parcel_round_trip_is_lossless() {
        let mut parcel = Parcel::of(json!({"a": [1, "\u{e4}"]}));
        assert_eq!(parcel.pack(b"xyz"), [0, 3]);
        assert_eq!(parcel.pack(b""), [3, 0]);
        assert_eq!(parcel.pack(b"u"), [3, 1]);
        let arrived = Parcel::read(&parcel.clone().into_bytes()).unwrap();
        assert_eq!(arrived, parcel);
        assert_eq!(arrived.bytes([1, 3]), Some(&b"yzu"[..]));
        assert_eq!(arrived.bytes([2, 3]), None);
    }

    #[test]
    fn half_a_parcel_is_an_error() {
        let whole = Parcel::of(json!([1, 2, 3])).into_bytes();
        for length in 0..whole.len() {
            assert!(Parcel::read(&whole[..length]).is_err(), "{length}");
        }
        assert!(Parcel::read(b"\xff\xff\xff\xff1").is_err());
    }
}
