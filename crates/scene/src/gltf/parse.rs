//! From text to a [`GltfDocument`].

use super::json::GltfDocument;
use super::other::other_format;
use super::pointer::pointer;
use super::unknown::warning_of;
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::outside::ImportContext;
use basrelief_input::{JsonFault, JsonPath, MemoryReservation, json_weight};

/// Parses the JSON of a glTF file, with its reservation. Warns of keys that glTF does not define.
pub(crate) fn parse(
    bytes: &[u8],
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<(GltfDocument, MemoryReservation), SceneError> {
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
    let held = outside.take(json_weight(bytes), "", "its JSON")?;
    let mut warn = |path: JsonPath| {
        if let Some(warning) = warning_of(&path) {
            warnings.add(warning);
        }
    };
    let document = basrelief_input::from_str_with_ignored(text, &mut warn).map_err(|fault| {
        let other = if fault.is_data { other_format(text) } else { None };
        other.unwrap_or_else(|| json_error(&fault))
    })?;
    Ok((document, held))
}

/// Returns the error of a JSON text. Wrong values have a pointer, wrong syntax a line and column.
pub fn json_error(fault: &JsonFault) -> SceneError {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MemoryFiles;
    use basrelief_input::MemoryPool;

    fn says(text: &str) -> String {
        parsed(text.as_bytes(), 1 << 20).err().map(|e| e.to_string()).unwrap_or_default()
    }

    fn parsed(bytes: &[u8], limit: u64) -> Result<GltfDocument, SceneError> {
        let files = MemoryFiles::default();
        parse(bytes, &ImportContext::new(&files, &MemoryPool::new(limit)), &mut ImportWarnings::default())
            .map(|(document, _)| document)
    }

    #[test]
    fn errors_name_the_place() {
        assert_eq!(
            says(r#"{"asset": {"version": "2.0"}, "accessors": [{"type": "VEC3", "componentType": 5126, "count": -1}]}"#),
            "/accessors/0/count (line 1, column 95): the number -1 stands here, expected a non-negative integer; correct it or export the file again"
        );
        assert!(says(r#"{"accessors": 3}"#).starts_with("is no glTF file"));
        assert!(says(r#"{"asset": {}}"#).starts_with("/asset (line 1, column 12): missing field `version`"));
        assert!(says("{\n\"asset\" 1}").starts_with("line 2, column 9: not valid JSON: expected `:`"));
        assert!(says("{\"asset\": {\"version\": \"2.0\"}} x").contains("trailing characters"));
        assert!(parsed(b"\xff", 1 << 20).err().unwrap().to_string().starts_with("byte 0: not UTF-8"));
        assert!(says("\u{feff}{}").contains("byte order mark"));
    }

    #[test]
    fn braces_in_strings_are_no_objects() {
        let text = format!("{{\"asset\": {{\"version\": \"2.0\", \"x\": \"\\\"{}\"}}}}", "{".repeat(100_000));
        assert_eq!(says(&text), "");
    }

    #[test]
    fn too_many_objects_are_refused() {
        let text = format!("[{}{{}}]", "{},".repeat(10_000));
        assert!(says(&text).starts_with("needs 6.8 MiB for its JSON"), "{}", says(&text));
    }
}
