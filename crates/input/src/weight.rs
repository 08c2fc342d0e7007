//! Upper bound of the memory of a JSON text, computed before it is read.

/// Memory of an object without its keys: the largest struct, or a map node with room for eleven entries.
const OBJECT: u64 = 640;
/// Memory of a key and its value in a map.
const KEY: u64 = 160;
/// Memory of an item of a list that grows by doubling.
const ITEM: u64 = 64;

/// Returns an upper bound of the bytes of the values in a text, which need not be valid JSON. Measured, and tested with the texts
/// that expand most: objects of one key, lists of small numbers, maps of short names.
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
    // Strings with escapes are assembled in a buffer of their own.
    if escapes { weight + 2 * text.len() as u64 } else { weight }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn braces_in_strings_are_text() {
        assert_eq!(json_weight(br#""{[,:""#), 6);
        assert_eq!(json_weight(br#"{"a":[1,2]}"#), 11 + OBJECT + KEY + 2 * ITEM);
        assert_eq!(json_weight(br#""\"{""#), 5 * 3);
    }
}
