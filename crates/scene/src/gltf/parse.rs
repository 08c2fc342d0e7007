//! From text to a [`Document`], with limits on what untrusted text may grow to.

use super::json::Document;
use crate::SceneError;
use basrelief_input::JsonFault;
use serde_path_to_error::{Path, Segment};

/// Most bytes of JSON outside of strings: numbers grow to 4-8 times their text.
const MAX_STRUCTURE_BYTES: usize = 1 << 26;

/// Most objects: each grows to some 200 bytes.
const MAX_OBJECTS: usize = 1 << 20;

/// Parses the JSON of a glTF file.
pub(crate) fn parse(bytes: &[u8]) -> Result<Document, SceneError> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        return Err(SceneError::at("byte 0", "begins with a byte order mark")
            .expected("JSON text in UTF-8 without one, as glTF demands")
            .cure("save the file without it"));
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
        SceneError::at(format!("byte {}", e.valid_up_to()), "not UTF-8")
            .expected("JSON text in UTF-8")
            .cure("save the file in UTF-8")
    })?;
    check_size(text)?;
    basrelief_input::from_str(text).map_err(|fault| json_error(&fault))
}

/// A fault of a JSON text: what is wrong in it has a pointer, wrong syntax a line and column.
pub(crate) fn json_error(fault: &JsonFault) -> SceneError {
    let JsonFault { line, column, is_data, message, .. } = fault;
    let pointer = pointer(&fault.path);
    if !is_data {
        return SceneError::at(format!("line {line}, column {column}"), format!("not valid JSON: {message}"))
            .cure("correct the text or export the file again");
    }
    let at = format!("line {line}, column {column}");
    let place = if pointer.is_empty() { at } else { format!("{pointer} ({at})") };
    SceneError::at(place, message.as_str()).cure("correct it or export the file again")
}

/// The JSON pointer of a place.
fn pointer(path: &Path) -> String {
    path.iter()
        .map(|segment| match segment {
            Segment::Seq { index } => format!("/{index}"),
            Segment::Map { key } => format!("/{}", escape(key)),
            Segment::Enum { variant } => format!("/{variant}"),
            Segment::Unknown => String::new(),
        })
        .collect()
}

/// A name as part of a JSON pointer.
pub(crate) fn escape(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

fn check_size(text: &str) -> Result<(), SceneError> {
    let (mut objects, mut structure) = (0usize, 0usize);
    let (mut in_string, mut escaped) = (false, false);
    for byte in text.bytes() {
        if in_string {
            in_string = escaped || byte != b'"';
            escaped = byte == b'\\' && !escaped;
        } else {
            in_string = byte == b'"';
            objects += usize::from(byte == b'{');
            structure += usize::from(!byte.is_ascii_whitespace());
        }
    }
    if objects > MAX_OBJECTS || structure > MAX_STRUCTURE_BYTES {
        return Err(SceneError::at("", format!("JSON of {objects} objects and {structure} bytes outside of strings"))
            .expected(format!("at most {MAX_OBJECTS} objects and {MAX_STRUCTURE_BYTES} bytes"))
            .cure("split the model, or keep vertex data in a buffer"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn says(text: &str) -> String {
        parse(text.as_bytes()).err().map(|e| e.to_string()).unwrap_or_default()
    }

    #[test]
    fn errors_name_the_place() {
        assert_eq!(
            says(r#"{"asset": {"version": "2.0"}, "accessors": [{"type": "VEC3", "componentType": 5126, "count": -1}]}"#),
            "/accessors/0/count (line 1, column 95): the number -1 stands here, expected a non-negative integer; correct it or export the file again"
        );
        assert!(says(r#"{"asset": {}}"#).starts_with("/asset (line 1, column 12): missing field `version`"));
        assert!(says("{\n\"asset\" 1}").starts_with("line 2, column 9: not valid JSON: expected `:`"));
        assert!(says("{\"asset\": {\"version\": \"2.0\"}} x").contains("trailing characters"));
        assert!(parse(b"\xff").err().unwrap().to_string().starts_with("byte 0: not UTF-8"));
        assert!(says("\u{feff}{}").contains("byte order mark"));
    }

    #[test]
    fn braces_in_strings_are_no_objects() {
        let text = format!("{{\"asset\": {{\"version\": \"2.0\", \"x\": \"\\\"{}\"}}}}", "{".repeat(MAX_OBJECTS + 1));
        assert_eq!(says(&text), "");
    }

    #[test]
    fn a_flood_of_objects_is_refused() {
        let text = format!("[{}{{}}]", "{},".repeat(MAX_OBJECTS));
        assert!(says(&text).contains("at most 1048576 objects"));
    }
}
