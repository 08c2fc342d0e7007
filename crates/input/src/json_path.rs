//! Path of a place in a JSON text.

use std::fmt;

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
        let mut open = Self::default();
        let mut rest = text;
        while let Some((&byte, behind)) = rest.split_first() {
            let length = if byte == b'"' { 1 + string_length(behind) } else { 1 };
            open.pass(byte, &rest[..length]);
            rest = &rest[length..];
        }
        open
    }

    /// Passes a token that begins with this byte.
    fn pass(&mut self, first: u8, token: &[u8]) {
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
}
