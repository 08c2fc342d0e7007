//! Errors of serde and `serde_json` in terms of JSON: lists, objects and numbers.
//!
//! These functions read the English texts of both libraries, because `serde_json` fixes the error type of its deserializer. A
//! wrapper with an error type of its own would map about fifty methods, and syntax errors would still be texts. A text that is
//! unknown here passes unchanged.

/// Text of an error, without line and column.
pub(crate) fn error_text(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text.strip_suffix(&format!(" at line {} column {}", error.line(), error.column())).unwrap_or(&text);
    if !error.is_data() {
        return syntax_text(text);
    }
    let found = ["invalid type: ", "invalid value: ", "invalid length "].into_iter().find_map(|start| {
        let (found, expected) = text.strip_prefix(start)?.rsplit_once(", expected ")?;
        Some((if start.ends_with("length ") { format!("a list of {found}") } else { found_text(found) }, expected))
    });
    found.map_or_else(
        || shorten(&text.replacen("unknown variant", "unknown value", 1)),
        |(found, expected)| format!("{found} stands here, expected {}", expected_text(expected)),
    )
}

fn syntax_text(text: &str) -> String {
    match text {
        "EOF while parsing a value"
        | "EOF while parsing an object"
        | "EOF while parsing a list"
        | "EOF while parsing a string" => {
            format!("the text ends within {}", text.trim_start_matches("EOF while parsing "))
        }
        "expected value" => "expected a value: a number, a text in quotes, a list, an object, true, false or null".into(),
        "key must be a string" => "expected a key in quotes".into(),
        "trailing characters" => "something stands after the end: trailing characters".into(),
        "recursion limit exceeded" => "lists and objects lie too deep in each other, expected at most 127 levels".into(),
        other => other.into(),
    }
}

/// Name of the value found.
fn found_text(found: &str) -> String {
    let number = found.strip_prefix("integer ").or_else(|| found.strip_prefix("floating point "));
    match found {
        "map" => "an object".into(),
        "sequence" => "a list".into(),
        "null" | "unit value" => "null".into(),
        "unit variant" => "a name alone".into(),
        _ => match (number, found.strip_prefix("string "), found.strip_prefix("boolean ")) {
            (Some(number), ..) => format!("the number {}", number.trim_matches('`')),
            (_, Some(text), _) => format!("the text {}", shorten(text)),
            (.., Some(value)) => value.trim_matches('`').into(),
            _ => shorten(found),
        },
    }
}

/// Name of the value expected.
fn expected_text(expected: &str) -> String {
    match expected {
        "a sequence" => "a list".into(),
        "a map" => "an object".into(),
        "f32" | "f64" => "a number".into(),
        "u8" => format!("a whole number 0..={}", u8::MAX),
        "u16" => format!("a whole number 0..={}", u16::MAX),
        "u32" => format!("a whole number 0..={}", u32::MAX),
        "u64" | "usize" => format!("a whole number 0..={}", u64::MAX),
        "i64" => format!("a whole number {}..={}", i64::MIN, i64::MAX),
        "a boolean" => "true or false".into(),
        "a string" => "a text in quotes".into(),
        "newtype variant" => "a name and what it holds".into(),
        other if other.starts_with("an array of length ") => format!("a list of {}", &other["an array of length ".len()..]),
        other if other.starts_with("struct ") => "an object".into(),
        other if other.starts_with("enum ") => "one of its names, or an object with one of them as its key".into(),
        other => other.into(),
    }
}

/// Beginning of a text that can be as long as the file.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 120;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}
