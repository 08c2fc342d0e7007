//! What a JSON text may take when it is read, told from the text alone: it must be known before.

/// An object, beside its keys: the largest struct that is made of one, or a node of a map with room for eleven.
const OBJECT: u64 = 640;
/// A key and its value in a map.
const KEY: u64 = 160;
/// An item of a list that grows by doubling.
const ITEM: u64 = 64;

/// Most bytes that the values take that are read from a JSON text, which need not be one. Measured, and tested with what
/// takes most for its text: objects of one key, lists of small numbers, maps of short names.
pub fn json_weight(text: &[u8]) -> u64 {
    let (mut weight, mut in_string, mut escaped, mut escapes) = (text.len() as u64, false, false, false);
    for &byte in text {
        if in_string {
            in_string = escaped || byte != b'"';
            escaped = byte == b'\\' && !escaped;
            escapes |= escaped;
        } else {
            in_string = byte == b'"';
            weight += match byte {
                b'{' => OBJECT,
                b':' => KEY,
                b',' | b'[' => ITEM,
                _ => 0,
            };
        }
    }
    // Strings with escapes are put together beside the text first.
    if escapes { weight + 2 * text.len() as u64 } else { weight }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_strings_is_text() {
        assert_eq!(json_weight(br#""{[,:""#), 6);
        assert_eq!(json_weight(br#"{"a":[1,2]}"#), 11 + OBJECT + KEY + 2 * ITEM);
        assert_eq!(json_weight(br#""\"{""#), 5 * 3);
    }
}
