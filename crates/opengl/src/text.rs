//! From the text of a dump to its values.

use crate::dump::GlDump;
use basrelief_input::{MemoryPool, MemoryReservation, json_weight};
use basrelief_scene::{SceneError, json_error, over_budget};
use std::borrow::Cow;

/// Parses a dump, with its reservation. apitrace writes control characters in strings as they are; they are accepted.
pub(crate) fn parse(bytes: &[u8], budget: &MemoryPool) -> Result<(GlDump, MemoryReservation), SceneError> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        SceneError::at(format!("byte {}", e.valid_up_to()), "not UTF-8")
            .expected("JSON text in UTF-8, as `apitrace replay -D CALL` writes it")
            .cure("write the dump again")
    })?;
    let reserve = |bytes, what| budget.try_reserve(bytes, what).map_err(|e| over_budget("", &e));
    let held = reserve(json_weight(bytes), "the values of a dump")?;
    let (text, copy) = if has_raw_controls(text) {
        // The longest escape has two characters.
        let copy = reserve(2 * text.len() as u64, "a dump with escaped characters")?;
        (Cow::Owned(with_escapes(text)), Some(copy))
    } else {
        (Cow::Borrowed(text), None)
    };
    let dump: GlDump = basrelief_input::from_str(&text).map_err(|mut fault| {
        fault.line = original_line(bytes, &text, fault.line, fault.column);
        json_error(&fault)
    })?;
    drop(copy);
    check_is_dump(&dump)?;
    Ok((dump, held))
}

/// Refuses the JSON of another program. A dump of any draw call has parameters.
fn check_is_dump(dump: &GlDump) -> Result<(), SceneError> {
    if !dump.parameters.0.is_empty() {
        return Ok(());
    }
    Err(SceneError::at("", "is no state dump of OpenGL, because `parameters` is missing or empty")
        .expected("the JSON that `apitrace replay -D CALL TRACE` writes")
        .cure("name the dumps that `basrelief capture` keeps, for example"))
}

/// Calls `each` with every character and whether it is inside a string.
fn walk(text: &str, mut each: impl FnMut(char, bool)) {
    let (mut in_string, mut escaped) = (false, false);
    for character in text.chars() {
        each(character, in_string);
        if in_string {
            in_string = escaped || character != '"';
            escaped = character == '\\' && !escaped;
        } else {
            in_string = character == '"';
        }
    }
}

fn has_raw_controls(text: &str) -> bool {
    let mut found = false;
    walk(text, |character, in_string| found |= in_string && character < ' ');
    found
}

/// Escapes control characters in strings: line ends and tabs as such, others as blanks.
fn with_escapes(text: &str) -> String {
    let mut result = String::with_capacity(2 * text.len());
    walk(text, |character, in_string| match character {
        '\n' if in_string => result.push_str("\\n"),
        '\t' if in_string => result.push_str("\\t"),
        _ if in_string && character < ' ' => result.push(' '),
        _ => result.push(character),
    });
    result
}

/// Returns the line of the original text that holds a place of the escaped text.
fn original_line(bytes: &[u8], escaped: &str, line: usize, column: usize) -> usize {
    let end = basrelief_input::fault_offset(escaped.as_bytes(), line, column);
    let mut at = 0;
    let mut lines = 1;
    for &byte in bytes {
        if at >= end {
            break;
        }
        let rest = escaped.as_bytes().get(at..).unwrap_or_default();
        let is_escape = byte < b' ' && rest.first() == Some(&b'\\');
        at += if is_escape { 2 } else { 1 };
        lines += usize::from(byte == b'\n');
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<GlDump, String> {
        parse(text.as_bytes(), &MemoryPool::default()).map(|(dump, _)| dump).map_err(|e| e.to_string())
    }

    #[test]
    fn raw_control_characters_are_read_as_text() {
        let dump =
            parsed("{\"parameters\": {\"A\": 1}, \"shaders\": {\"GL_VERTEX_SHADER\": \"a\nb\tc\u{1}d \\\" \n\"}}").unwrap();
        assert_eq!(dump.shaders["GL_VERTEX_SHADER"], "a\nb\tc d \" \n");
    }

    #[test]
    fn error_names_line_of_original_text() {
        let error = parsed("{\"shaders\": {\"A\": \"x\ny\nz\"},\n\"uniforms\": 3\n\n}").err().unwrap();
        assert!(error.starts_with("/uniforms (line 4, column"), "{error}");
        assert!(error.contains("the number 3 stands here, expected"), "{error}");
    }

    #[test]
    fn dump_over_memory_limit_is_an_error() {
        let text = format!("{{\"uniforms\": {{\"a\": [{}0]}}}}", "0,".repeat(10_000));
        let error = parse(text.as_bytes(), &MemoryPool::new(100_000)).err().unwrap();
        assert!(error.over_budget && error.to_string().contains("the values of a dump"), "{error}");
    }

    #[test]
    fn deep_nesting_is_an_error() {
        let error = parsed(&format!("{{\"uniforms\": {{\"a\": {}", "[".repeat(100_000))).err().unwrap();
        assert!(error.contains("not valid JSON"), "{error}");
    }
}
