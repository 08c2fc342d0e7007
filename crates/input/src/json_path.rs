//! Path of a place in a JSON text.

use std::fmt;
use std::ops::Range;

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JsonStep {
    /// The value of a key.
    Key(String),
    /// The item of a list with this number, from 0.
    Item(usize),
}

/// Path of a value from the outermost value inwards. Its text is `.` if it is empty, and otherwise as in `views[2].turn`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JsonPath(pub Vec<JsonStep>);

impl fmt::Display for JsonPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str(".");
        }
        for (number, step) in self.0.iter().enumerate() {
            match step {
                JsonStep::Item(item) => write!(f, "[{item}]")?,
                JsonStep::Key(key) if number == 0 => f.write_str(key)?,
                JsonStep::Key(key) => write!(f, ".{key}")?,
            }
        }
        Ok(())
    }
}

impl JsonPath {
    /// Returns the path of the value at the end of the beginning of a text: of the value that ends there or lies there in part,
    /// otherwise of the next one. Behind a key it is the path of its value. The beginning must be valid. With `depth`, the value lies in so
    /// many lists and objects, the last of which may end there.
    pub(crate) fn of_value_at_end(beginning: &[u8], depth: Option<usize>) -> Self {
        let mut open = OpenValues::at_end(beginning);
        if depth.is_some_and(|depth| open.steps.len() < depth) {
            let closed = open.closed.take();
            open.steps.push(closed);
        }
        open.into_path()
    }

    /// As [`JsonPath::of_value_at_end`], but behind a bracket or a value it is the path of the list or object around it.
    pub(crate) fn of_gap_at_end(beginning: &[u8]) -> Self {
        let mut open = OpenValues::at_end(beginning);
        if open.ends_in_gap {
            open.steps.pop();
        }
        open.into_path()
    }
}

/// Returns the range of a field of a valid text, from its key to the end of its value; `None` if the text does not have it. `name` joins
/// the keys of the objects around the field with dots. The first of equal names counts.
pub fn field_range(text: &str, name: &str) -> Option<Range<usize>> {
    let (mut open, mut at, mut found) = (OpenValues::default(), 0, None);
    while let Some(token) = token_at(text.as_bytes(), at) {
        open.pass(token);
        match found {
            None if token[0] == b'"' && open.is_named(name) => found = Some((at, open.steps.len() - 1)),
            Some((start, depth)) if !matches!(open.steps.get(depth), Some(Some(_))) => return Some(start..at),
            _ => {}
        }
        at += token.len();
    }
    None
}

/// Returns the path of the list around an item, the number of this item, and the number of all items. The item begins at an offset of a text.
/// `None` if no comma of a list precedes the item, or the list has no end.
pub(crate) fn list_around_item(text: &[u8], offset: usize) -> Option<(JsonPath, usize, usize)> {
    let beginning = text.get(..offset)?;
    let mut open = OpenValues::at_end(beginning);
    let Some(Some(JsonStep::Item(item))) = open.steps.last().cloned() else { return None };
    if !beginning.trim_ascii_end().ends_with(b",") {
        return None;
    }
    let (depth, mut at) = (open.steps.len(), offset);
    loop {
        let token = token_at(text, at)?;
        let last = open.steps.last().cloned();
        open.pass(token);
        if open.steps.len() < depth {
            let Some(Some(JsonStep::Item(last))) = last else { return None };
            return Some((open.into_path(), item, last + 1));
        }
        at += token.len();
    }
}

/// Returns the string or the byte that begins at an offset; `None` at the end.
fn token_at(text: &[u8], at: usize) -> Option<&[u8]> {
    let rest = &text[at..];
    let (&byte, behind) = rest.split_first()?;
    let length = if byte == b'"' { 1 + string_length(behind) } else { 1 };
    Some(&rest[..length])
}

/// Lists and objects that a text leaves open.
#[derive(Default)]
struct OpenValues {
    /// Of each its item, or its key once it is known.
    steps: Vec<Option<JsonStep>>,
    /// The last step in the list or object that ended last.
    closed: Option<JsonStep>,
    /// True if the text ends with a bracket or a string that is no key.
    ends_in_gap: bool,
}

impl OpenValues {
    fn at_end(text: &[u8]) -> Self {
        let (mut open, mut at) = (Self::default(), 0);
        while let Some(token) = token_at(text, at) {
            open.pass(token);
            at += token.len();
        }
        open
    }

    /// Passes a token of [`token_at`].
    fn pass(&mut self, token: &[u8]) {
        let first = token[0];
        self.ends_in_gap = matches!(first, b'{' | b'[' | b'}' | b']') || (first.is_ascii_whitespace() && self.ends_in_gap);
        match first {
            b'{' => self.steps.push(None),
            b'[' => self.steps.push(Some(JsonStep::Item(0))),
            b'}' | b']' => self.closed = self.steps.pop().flatten(),
            b',' => {
                if let Some(last) = self.steps.last_mut() {
                    *last = match last {
                        Some(JsonStep::Item(item)) => Some(JsonStep::Item(*item + 1)),
                        _ => None,
                    };
                }
            }
            b'"' => match self.steps.last_mut() {
                Some(last @ None) => *last = serde_json::from_slice(token).ok().map(JsonStep::Key),
                _ => self.ends_in_gap = true,
            },
            _ => {}
        }
    }

    /// Returns true if the open values are objects whose keys, joined with dots, are this name.
    fn is_named(&self, name: &str) -> bool {
        let mut rest = Some(name);
        for (number, step) in self.steps.iter().enumerate() {
            let Some(JsonStep::Key(key)) = step else { return false };
            let behind_dot = rest.and_then(|rest| if number == 0 { Some(rest) } else { rest.strip_prefix('.') });
            rest = behind_dot.and_then(|rest| rest.strip_prefix(key.as_str()));
        }
        rest == Some("") && !self.steps.is_empty()
    }

    fn into_path(self) -> JsonPath {
        JsonPath(self.steps.into_iter().flatten().collect())
    }
}

/// Length of the rest of a string with its closing quote, or of the whole text without one.
fn string_length(text: &[u8]) -> usize {
    let mut escaped = false;
    let end = text.iter().position(|&byte| {
        let ends = byte == b'"' && !escaped;
        escaped = byte == b'\\' && !escaped;
        ends
    });
    end.map_or(text.len(), |end| end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_leads_to_the_end_of_the_text() {
        for (text, path) in [
            ("", "."),
            ("3", "."),
            (r#"{"a": "#, "a"),
            (r#"{"a": 12"#, "a"),
            (r#"{"a": [1, {"b": "#, "a[1].b"),
            (r#"{"a": [1, {"b": {}"#, "a[1].b"),
            (r#"{"a": [1, {"b": {}}"#, "a[1]"),
            (r#"{"a": [1, {"b": {}}, "#, "a[2]"),
            (r#"{"a": [1, {"b": {}}]"#, "a"),
            (r#"{"a": [1, {"b": {}}]}"#, "."),
            (r#"{"a": 1, "b""#, "b"),
            (r#"{"a": 1, "#, "."),
            (r#"{"a\"\\": [["x,[", "]"#, r#"a"\[0][1]"#),
            (r#"[{"a": "b"#, "[0].a"),
        ] {
            assert_eq!(JsonPath::of_value_at_end(text.as_bytes(), None).to_string(), path, "{text}");
        }
    }

    #[test]
    fn depth_leads_into_what_ends_there() {
        let text = br#"{"a": [1, {"b": {}, "c": [5]}"#;
        for (depth, path) in [(3, "a[1].c"), (2, "a[1]")] {
            assert_eq!(JsonPath::of_value_at_end(text, Some(depth)).to_string(), path);
        }
    }

    #[test]
    fn gap_belongs_to_what_is_around_it() {
        for (text, path) in [
            (r#"{"a": [1, {"b": {} "#, "a[1]"),
            (r#"{"a": [1, {"b": {"#, "a[1].b"),
            (r#"{"a": ["#, "a"),
            (r#"{"a": [1, {"b": "c""#, "a[1]"),
            (r#"{"a": [1, {"b""#, "a[1].b"),
            (r#"{"a": [1, "#, "a[1]"),
            (r#"{"a": [12"#, "a[0]"),
            (r#""a""#, "."),
        ] {
            assert_eq!(JsonPath::of_gap_at_end(text.as_bytes()).to_string(), path, "{text}");
        }
    }

    #[test]
    fn field_has_the_range_of_key_and_value() {
        let text = r#"{"x": {"b": "a.b"}, "a": {"b": [1, {"c": "},"}], "d.e": 2}, "a.b": 3}"#;
        for (name, field) in [
            ("x", Some(r#""x": {"b": "a.b"}"#)),
            ("a.b", Some(r#""b": [1, {"c": "},"}]"#)),
            ("a.d.e", Some(r#""d.e": 2"#)),
            ("a.b.c", None),
            ("b", None),
            ("", None),
        ] {
            assert_eq!(field_range(text, name).map(|range| &text[range]), field, "{name}");
        }
        assert_eq!(field_range(r#"{"a": 1"#, "a"), None, "without an end");
    }
}
