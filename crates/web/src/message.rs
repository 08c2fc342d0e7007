//! Wire format of questions and answers: JSON followed by bytes.

use serde_json::Value;

/// JSON, and bytes that it refers to by offset and length. The wire format is the length of the JSON \[32 bits, little endian\],
/// the JSON, and the bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Message {
    /// The JSON.
    pub json: Value,
    /// The bytes after the JSON.
    pub rest: Vec<u8>,
}

const LENGTH: usize = 4;

impl Message {
    /// Makes a message of JSON alone.
    pub fn from_json(json: Value) -> Self {
        Self { json, rest: Vec::new() }
    }

    /// Appends bytes and returns their offset and length.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> [usize; 2] {
        let place = self.rest.len();
        self.rest.extend_from_slice(bytes);
        [place, bytes.len()]
    }

    /// Returns the bytes at an offset and length.
    pub fn bytes(&self, [place, length]: [usize; 2]) -> Option<&[u8]> {
        self.rest.get(place..place.checked_add(length)?)
    }

    /// Encodes the message.
    pub fn into_bytes(self) -> Vec<u8> {
        let json = self.json.to_string();
        let mut bytes = Vec::with_capacity(LENGTH + json.len() + self.rest.len());
        bytes.extend_from_slice(&(json.len() as u32).to_le_bytes());
        bytes.extend_from_slice(json.as_bytes());
        bytes.extend_from_slice(&self.rest);
        bytes
    }

    /// Decodes a message.
    ///
    /// # Errors
    /// If the length or the JSON is invalid.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let short = "a message is shorter than it says";
        let (length, behind) = bytes.split_first_chunk::<LENGTH>().ok_or(short)?;
        let (json, rest) = behind.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or(short)?;
        let json = serde_json::from_slice(json).map_err(|error| format!("a message holds no JSON: {error}"))?;
        Ok(Self { json, rest: rest.to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn message_round_trip_is_lossless() {
        let mut message = Message::from_json(json!({"a": [1, "\u{e4}"]}));
        assert_eq!(message.append(b"xyz"), [0, 3]);
        assert_eq!(message.append(b""), [3, 0]);
        assert_eq!(message.append(b"u"), [3, 1]);
        let arrived = Message::read(&message.clone().into_bytes()).unwrap();
        assert_eq!(arrived, message);
        assert_eq!(arrived.bytes([1, 3]), Some(&b"yzu"[..]));
        assert_eq!(arrived.bytes([2, 3]), None);
    }

    #[test]
    fn truncated_message_is_an_error() {
        let whole = Message::from_json(json!([1, 2, 3])).into_bytes();
        for length in 0..whole.len() {
            assert!(Message::read(&whole[..length]).is_err(), "{length}");
        }
        assert!(Message::read(b"\xff\xff\xff\xff1").is_err());
    }
}
