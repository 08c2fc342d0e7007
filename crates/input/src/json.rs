//! Parser of JSON with errors that name their place in plain words.

use crate::error_text::error_text;
use crate::json_path::{JsonPath, JsonStep, list_around_item};
use crate::reject_seq::{FaultTrail, RejectSeqForStruct};
use serde::de::DeserializeOwned;
use serde_ignored::Path;
use serde_json::Deserializer;
use serde_json::de::Read;

/// Fault of a JSON text, with its place.
#[derive(Debug)]
pub struct JsonFault {
    /// Path in the document; empty if it is unknown.
    pub path: JsonPath,
    /// Line, from 1; 0 if unknown.
    pub line: usize,
    /// Column \[bytes, from 1\]; 0 if unknown.
    pub column: usize,
    /// The text is JSON, but has a wrong type, key or value.
    pub is_data: bool,
    /// The value found and, if known, the value expected.
    pub message: String,
}

/// Reads a value. A list for an object and text behind the value are errors.
///
/// # Errors
/// Not JSON, or not the JSON that was expected.
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, JsonFault> {
    read(Deserializer::from_str(text), text.as_bytes())
}

/// Parses like [`from_str`], from bytes that should be UTF-8.
///
/// # Errors
/// Errors of [`from_str`].
pub fn from_slice<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, JsonFault> {
    read(Deserializer::from_slice(bytes), bytes)
}

/// Parses like [`from_str`], and passes on the path of each key that the type does not have.
///
/// # Errors
/// Errors of [`from_str`].
pub fn from_str_with_ignored<T: DeserializeOwned>(text: &str, ignored: &mut dyn FnMut(JsonPath)) -> Result<T, JsonFault> {
    let trail = FaultTrail::default();
    let mut json = Deserializer::from_str(text);
    let mut pass_on = |path: Path<'_>| ignored(path_of(&path));
    let strict = RejectSeqForStruct(&mut json, &trail);
    let value = T::deserialize(serde_ignored::Deserializer::new(strict, &mut pass_on));
    ended(json, value, text.as_bytes(), &trail)
}

/// Returns the path of an ignored key.
fn path_of(path: &Path<'_>) -> JsonPath {
    let (parent, step) = match path {
        Path::Root => return JsonPath::default(),
        Path::Seq { parent, index } => (parent, Some(JsonStep::Item(*index))),
        Path::Map { parent, key } => (parent, Some(JsonStep::Key(key.clone()))),
        Path::Some { parent } | Path::NewtypeStruct { parent } | Path::NewtypeVariant { parent } => (parent, None),
    };
    let mut all = path_of(parent);
    all.0.extend(step);
    all
}

fn read<'a, T: DeserializeOwned>(mut json: Deserializer<impl Read<'a>>, text: &[u8]) -> Result<T, JsonFault> {
    let trail = FaultTrail::default();
    let value = T::deserialize(RejectSeqForStruct(&mut json, &trail));
    ended(json, value, text, &trail)
}

/// Returns the value if nothing follows it.
fn ended<'a, T>(
    mut json: Deserializer<impl Read<'a>>,
    value: Result<T, serde_json::Error>,
    text: &[u8],
    trail: &FaultTrail,
) -> Result<T, JsonFault> {
    value.and_then(|value| json.end().map(|()| value)).map_err(|error| fault(text, &error, trail))
}

/// Locates an error. Its path follows from its line and column. (A reader that keeps track of the path is slower, so it
/// would be a second reader of every type: 7 to 17 % of the intermediate code of a crate.)
fn fault(text: &[u8], error: &serde_json::Error, trail: &FaultTrail) -> JsonFault {
    let (line, column) = (error.line(), error.column());
    let offset = fault_offset(text, line, column);
    if let Some((path, message)) = long_list(text, offset, error) {
        return JsonFault { path, line, column, is_data: true, message };
    }
    let (beginning, is_data) = (&text[..offset], error.is_data());
    let path = if is_data {
        JsonPath::of_value_at_end(beginning, trail.depth_without_line())
    } else {
        JsonPath::of_gap_at_end(beginning)
    };
    JsonFault { path, line, column, is_data, message: error_text(error) }
}

/// Returns path and message if the error is an item that a list has no room for. `serde_json` calls the item trailing characters.
fn long_list(text: &[u8], offset: usize, error: &serde_json::Error) -> Option<(JsonPath, String)> {
    if !error.to_string().starts_with("trailing characters at ") {
        return None;
    }
    let (path, expected, count) = list_around_item(text, offset.checked_sub(1)?)?;
    Some((path, format!("a list of {count} stands here, expected a list of {expected}")))
}

/// Returns the number of bytes of a text up to the line and column of a [`JsonFault`].
pub fn fault_offset(text: &[u8], line: usize, column: usize) -> usize {
    let lines_before = text.split_inclusive(|byte| *byte == b'\n').take(line.saturating_sub(1));
    (lines_before.map(<[u8]>::len).sum::<usize>() + column).min(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use std::collections::BTreeMap;

    #[derive(Debug, Deserialize, PartialEq)]
    struct Inner {
        a: u32,
        #[serde(default)]
        b: Option<[f32; 2]>,
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(rename_all = "snake_case")]
    enum Choice {
        New(Inner),
        Fields { x: u32 },
        Empty(Empty),
    }

    #[derive(Debug, Deserialize, PartialEq)]
    struct Empty {}

    #[derive(Debug, Deserialize, PartialEq)]
    struct Outer {
        one: Option<Inner>,
        #[serde(default)]
        many: Vec<Inner>,
        #[serde(default)]
        named: BTreeMap<String, Inner>,
        #[serde(default)]
        choices: Vec<Choice>,
    }

    #[test]
    fn keys_that_a_type_does_not_have_are_passed_on() {
        let mut ignored = Vec::new();
        let text = r#"{"on": 1, "one": {"a": 1, "B": 2}, "named": {"x": {"a": 1, "c": [{}]}}, "many": [{"a": 1, "d": null}]}"#;
        let read: Outer = from_str_with_ignored(text, &mut |path| ignored.push(path.to_string())).unwrap();
        assert_eq!((read, ignored.join(" ")), (from_str(text).unwrap(), "on one.B named.x.c many[0].d".into()));
        let fault = from_str_with_ignored::<Outer>(r#"{"one": [1, null]}"#, &mut |_| ()).unwrap_err();
        assert_eq!(fault.path.to_string(), "one");
    }

    fn says(text: &str) -> (String, String) {
        let fault = from_str::<Outer>(text).unwrap_err();
        (fault.path.to_string(), fault.message)
    }

    /// serde reads a list as a struct, field by field. Each place that can hold a list is tested.
    #[test]
    fn a_list_is_no_object_anywhere() {
        let expected = "a list stands here, expected an object";
        for (text, path) in [
            (r#"[null]"#, "."),
            (r#"{"one": [1, null]}"#, "one"),
            (r#"{"many": [{"a": 1}, [1, null]]}"#, "many[1]"),
            (r#"{"named": {"x": [1, null]}}"#, "named.x"),
            (r#"{"choices": [{"new": [1, null]}]}"#, "choices[0].new"),
            (r#"{"choices": [{"fields": [1]}]}"#, "choices[0].fields"),
            (r#"{"choices": [{"empty": []}]}"#, "choices[0].empty"),
        ] {
            assert_eq!(says(text), (path.into(), expected.into()), "{text}");
        }
    }

    /// `serde_json` finds the line of an error of `try_from` behind the object around the value, if nothing else stands there.
    #[test]
    fn error_of_a_conversion_has_the_path_of_its_value() {
        #[derive(Debug, Deserialize)]
        #[serde(try_from = "Vec<u32>")]
        struct Pair([u32; 2]);
        impl TryFrom<Vec<u32>> for Pair {
            type Error = String;
            fn try_from(given: Vec<u32>) -> Result<Self, String> {
                given.try_into().map(Self).map_err(|_| "two numbers wanted".into())
            }
        }
        #[derive(Debug, Deserialize)]
        struct Pairs {
            a: Pair,
            b: Option<BTreeMap<String, Pair>>,
            c: Option<Either>,
        }
        #[derive(Debug, Deserialize)]
        enum Either {
            New(Pair),
            Fields { x: Pair },
        }
        for (text, path) in [
            (r#"[{"a": [1]}]"#, "[0].a"),
            (r#"[{"a": [1] }, {"a": [1, 2]}]"#, "[0].a"),
            (r#"[{"a": [1], "b": {}}]"#, "[0].a"),
            (r#"[{"b": {}, "a": [1]}]"#, "[0].a"),
            (r#"[{"a": [1, 2]}, {"a": [1, 2], "b": {"x": [1, 2], "y": []}}]"#, "[1].b.y"),
            (r#"[{"b": {"x": []}, "a": [1, 2]}]"#, "[0].b.x"),
            (r#"[{"a": [1, 2], "c": {"New": []}, "b": {}}]"#, "[0].c.New"),
            (r#"[{"a": [1, 2], "c": {"Fields": {"x": []}}}]"#, "[0].c.Fields.x"),
        ] {
            let fault = from_str::<Vec<Pairs>>(text).unwrap_err();
            assert_eq!((fault.path.to_string(), fault.message.as_str()), (path.into(), "two numbers wanted"), "{text}");
        }
        let pairs = from_str::<Pairs>(r#"{"a": [1, 2], "b": {"x": [3, 4]}, "c": {"Fields": {"x": [5, 6]}}}"#).unwrap();
        let Some(Either::New(c) | Either::Fields { x: c }) = pairs.c else { panic!("`c` is read") };
        assert_eq!((pairs.a.0, pairs.b.unwrap()["x"].0, c.0), ([1, 2], [3, 4], [5, 6]));
    }

    #[test]
    fn valid_value_is_read() {
        let text = r#"{"one": {"a": 1, "b": [1, 2]}, "many": [{"a": 2}], "named": {"x": {"a": 3}},
            "choices": [{"new": {"a": 4}}, {"fields": {"x": 5}}, {"empty": {}}]}"#;
        let inner = |a| Inner { a, b: None };
        let expected = Outer {
            one: Some(Inner { a: 1, b: Some([1.0, 2.0]) }),
            many: vec![inner(2)],
            named: [("x".to_owned(), inner(3))].into(),
            choices: vec![Choice::New(inner(4)), Choice::Fields { x: 5 }, Choice::Empty(Empty {})],
        };
        assert_eq!(from_str::<Outer>(text).unwrap(), expected);
        assert_eq!(from_slice::<Outer>(text.as_bytes()).unwrap(), expected);
    }

    #[test]
    fn list_that_is_too_long_has_its_path_and_length() {
        for (list, count) in [("[1, 2, 3]", 3), ("[1, 2 ,\n \"a],\", {\"x\": [1, 2]}, [[], 1]]", 5), ("[1,2,[3,4]]", 3)] {
            let expected = format!("a list of {count} stands here, expected a list of 2");
            assert_eq!(says(&format!(r#"{{"many": [{{"a": 1, "b": {list}}}]}}"#)), ("many[0].b".into(), expected), "{list}");
        }
        for text in [r#"{"one": {"a": 1, "b": [1, 2 3]}}"#, r#"{"one": {"a": 1, "b": [1, 2, 3"#, "{}, 1]"] {
            assert!(says(text).1.contains("trailing characters"), "{text}");
        }
    }

    #[test]
    fn errors_are_in_plain_words() {
        let message = |text: &str| says(text).1;
        assert_eq!(message(r#"{"many": {}}"#), "an object stands here, expected a list");
        assert_eq!(message(r#"{"many": 3}"#), "the number 3 stands here, expected a list");
        assert_eq!(message(r#"{"one": {"a": -1}}"#), "the number -1 stands here, expected a whole number 0..=4294967295");
        assert_eq!(message(r#"{"one": {"a": "x"}}"#), "the text \"x\" stands here, expected a whole number 0..=4294967295");
        assert_eq!(message(r#"{"one": {"a": 1, "b": [1]}}"#), "a list of 1 stands here, expected a list of 2");
        assert_eq!(message(r#"{"one": {"a": null}}"#), "null stands here, expected a whole number 0..=4294967295");
        assert_eq!(message(r#"{"choices": ["new"]}"#), "a name alone stands here, expected a name and what it holds");
        assert_eq!(message(r#"{"choices": [{"old": 1}]}"#), "unknown value `old`, expected one of `new`, `fields`, `empty`");
        assert_eq!(message(r#"{"one": {}}"#), "missing field `a`");
        assert_eq!(message(r#"{"one": "#), "the text ends within a value");
        assert_eq!(message("{one: 1}"), "expected a key in quotes");
        assert_eq!(message("{} {}"), "something stands after the end: trailing characters");
        let long = format!(r#"{{"one": "{}"}}"#, "x".repeat(1000));
        assert!(message(&long).len() < 200, "{}", message(&long));
    }
}
