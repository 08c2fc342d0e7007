//! Errors of serde and `serde_json` in terms of the text that they read: lists, numbers, and objects of JSON or tables of TOML.
//!
//! These functions read the English texts of both libraries, because `serde_json` fixes the error type of its deserializer. A
//! wrapper with an error type of its own would map about fifty methods, and syntax errors would still be texts. A text that is
//! unknown here passes unchanged.

/// Format of a text, which names its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextFormat {
    /// JSON, which has objects.
    Json,
    /// TOML, which has tables.
    Toml,
}

impl TextFormat {
    /// Name of a value with named fields.
    fn fields(self) -> &'static str {
        match self {
            Self::Json => "an object",
            Self::Toml => "a table",
        }
    }
}

/// Text of an error, without line and column.
pub(crate) fn error_text(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let text = text.strip_suffix(&format!(" at line {} column {}", error.line(), error.column())).unwrap_or(&text);
    if error.is_data() { plain_message(text, TextFormat::Json) } else { syntax_text(text) }
}

/// Returns a message of serde, or of a library that reads with serde, without terms of the programming language.
///
/// ```
/// use basrelief_input::{TextFormat, plain_message};
///
/// let message = plain_message("invalid type: string \"x\", expected f64", TextFormat::Toml);
/// assert_eq!(message, "the text \"x\" stands here, expected a number");
/// ```
pub fn plain_message(message: &str, format: TextFormat) -> String {
    // Messages of the TOML reader about a name that is a number or a table.
    if ["wanted string or table", "expected table, found ", "expected empty "].iter().any(|start| message.starts_with(start)) {
        return format!("expected {ONE_OF_ITS_NAMES}");
    }
    let Some((found, expected)) = message.rsplit_once(", expected ") else { return shorten(message) };
    let found_value = ["invalid type: ", "invalid value: ", "invalid length "].into_iter().find_map(|start| {
        let found = found.strip_prefix(start)?;
        Some(if start.ends_with("length ") { format!("a list of {found}") } else { found_text(found, format) })
    });
    match found_value {
        Some(found) => format!("{found} stands here, expected {}", expected_text(expected, format)),
        // The known names are few, but a given name can be as long as the file.
        None => {
            let variant = found.strip_prefix("unknown variant ").map(|name| format!("unknown value {name}"));
            format!("{}, expected {expected}", shorten(variant.as_deref().unwrap_or(found)))
        }
    }
}

/// Expectation of an enum.
const ONE_OF_ITS_NAMES: &str = "one of its names in quotes";

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
fn found_text(found: &str, format: TextFormat) -> String {
    let number = found.strip_prefix("integer ").or_else(|| found.strip_prefix("floating point "));
    match found {
        "map" => format.fields().into(),
        "sequence" => "a list".into(),
        "null" | "unit value" => "null".into(),
        "unit variant" => "a name alone".into(),
        _ => match (number, found.strip_prefix("string "), found.strip_prefix("boolean ")) {
            (Some(number), ..) => format!("the number {}", number.split('`').nth(1).unwrap_or(number)),
            (_, Some(text), _) => format!("the text {}", shorten(text)),
            (.., Some(value)) => value.trim_matches('`').into(),
            _ => shorten(found),
        },
    }
}

/// Name of the value expected.
fn expected_text(expected: &str, format: TextFormat) -> String {
    match expected {
        "a sequence" => "a list".into(),
        "a map" => format.fields().into(),
        "f32" | "f64" => "a number".into(),
        "u8" => format!("a whole number 0..={}", u8::MAX),
        "u16" => format!("a whole number 0..={}", u16::MAX),
        "u32" => format!("a whole number 0..={}", u32::MAX),
        "u64" | "usize" => format!("a whole number 0..={}", u64::MAX),
        "a nonzero u64" => format!("a whole number 1..={}", u64::MAX),
        "i64" => format!("a whole number {}..={}", i64::MIN, i64::MAX),
        "a boolean" => "true or false".into(),
        "a string" => "a text in quotes".into(),
        "newtype variant" => "a name and what it holds".into(),
        other if other.starts_with("an array of length ") => format!("a list of {}", &other["an array of length ".len()..]),
        "string or map" => ONE_OF_ITS_NAMES.into(),
        other if other.starts_with("struct ") => format.fields().into(),
        other if other.starts_with("enum ") => {
            format!("one of its names, or {} with one of them as its key", format.fields())
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_the_language_become_plain_words() {
        for (message, plain) in [
            (
                "invalid value: integer `-1`, expected usize",
                "the number -1 stands here, expected a whole number 0..=18446744073709551615",
            ),
            ("invalid type: map, expected a string", "a table stands here, expected a text in quotes"),
            ("invalid type: boolean `true`, expected struct Point", "true stands here, expected a table"),
            (
                "invalid type: integer `3`, expected string or map",
                "the number 3 stands here, expected one of its names in quotes",
            ),
            ("invalid type: integer `9` as i128, expected f64", "the number 9 stands here, expected a number"),
            ("expected table, found integer", "expected one of its names in quotes"),
            ("wanted string or table", "expected one of its names in quotes"),
            ("invalid length 1, expected an array of length 2", "a list of 1 stands here, expected a list of 2"),
            ("unknown variant `a`, expected `b` or `c`", "unknown value `a`, expected `b` or `c`"),
            ("missing field `unknown variant`", "missing field `unknown variant`"),
        ] {
            assert_eq!(plain_message(message, TextFormat::Toml), plain);
        }
        assert_eq!(
            plain_message("invalid type: map, expected a map", TextFormat::Json),
            "an object stands here, expected an object"
        );
    }

    #[test]
    fn long_name_is_shortened_and_expectation_is_kept() {
        let names = ["field"; 40].join("`, `");
        let message =
            plain_message(&format!("unknown field `{}`, expected one of `{names}`", "x".repeat(1000)), TextFormat::Toml);
        assert!(
            message.starts_with("unknown field `xxx") && message.ends_with(&format!("x..., expected one of `{names}`")),
            "{message}"
        );
    }
}
