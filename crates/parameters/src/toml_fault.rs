//! Errors of fields in a TOML text, or in a configuration in JSON, with their lines.

use crate::json::is_json;
use crate::nearest;
use basrelief_input::{TextFormat, field_range, plain_message};
use std::fmt::Display;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Error of a field of a TOML text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TomlFault {
    /// Names that lead to the field, and numbers of elements of lists. Empty if no field is at fault.
    field: Vec<String>,
    message: String,
}

impl TomlFault {
    /// Creates an error. `field` is a path as in [`FieldPositions::start_of`]. The message states place, error, expectation and cure.
    pub fn new(field: &[impl AsRef<str>], message: impl Into<String>) -> Self {
        Self { field: field.iter().map(|name| name.as_ref().to_owned()).collect(), message: message.into() }
    }

    /// Creates an error whose message begins with the field.
    pub fn at(field: &[impl AsRef<str>], error: impl Display) -> Self {
        let mut fault = Self::new(field, "");
        fault.message = match field {
            [] => error.to_string(),
            _ => format!("{}: {error}", path_text(&fault.field)),
        };
        fault
    }

    /// Creates an error of the parameter with this dotted name; `None` if no parameter is at fault.
    pub fn of_parameter(key: Option<&str>, message: impl Into<String>) -> Self {
        Self::new(key.as_slice(), message)
    }

    /// Describes an error of the TOML reader.
    pub fn of_reader(text: &str, error: &toml::de::Error) -> Self {
        let Ok(whole) = DeTable::parse(text) else { return Self::of_parameter(None, syntax(text, error)) };
        let field = error.span().and_then(|span| path_in_table(whole.get_ref(), &span)).unwrap_or_default();
        let path: Vec<&str> = field.iter().map(String::as_str).collect();
        let is_date = field_in_table(whole.get_ref(), &path).is_some_and(|(_, value)| value.is_datetime());
        // The reader passes a date as a map.
        let message = if is_date { error.message().replacen("type: map", "type: a date", 1) } else { error.message().to_owned() };
        let message = plain_message(&message, TextFormat::Toml);
        Self::at(&field, message + &nearest_hint(error.message()))
    }

    /// Returns the message, after the line of the field if the text gives the field.
    pub fn at_line(self, text: &str) -> String {
        let start = if is_json(text) {
            field_range(text, &self.field.join(".")).map(|range| range.start)
        } else {
            FieldPositions::of(text).start_of(&self.field)
        };
        match start.and_then(|start| text.get(..start)) {
            Some(before) => format!("line {}: {}", line_after(before), self.message),
            None => self.message,
        }
    }

    /// Returns the message without a line.
    pub fn into_message(self) -> String {
        self.message
    }
}

/// Positions of the fields of a TOML text.
#[derive(Debug)]
pub struct FieldPositions<'a>(Option<Spanned<DeTable<'a>>>);

impl<'a> FieldPositions<'a> {
    /// Parses the text. An invalid text has no fields.
    pub fn of(text: &'a str) -> Self {
        Self(DeTable::parse(text).ok())
    }

    /// Returns the offset of a field \[bytes\]; `None` if the text does not give it.
    ///
    /// The path consists of the names that lead to the field. A name with dots also stands for the names between its dots. In a list,
    /// a number selects the element.
    pub fn start_of(&self, path: &[impl AsRef<str>]) -> Option<usize> {
        let path: Vec<&str> = path.iter().map(AsRef::as_ref).collect();
        field_in_table(self.0.as_ref()?.get_ref(), &path).map(|(start, _)| start)
    }
}

/// Returns the offset of a field and its value.
fn field_in_table<'t, 'a>(table: &'t DeTable<'a>, path: &[&str]) -> Option<(usize, &'t DeValue<'a>)> {
    let (first, rest) = path.split_first()?;
    let parts = first.match_indices('.').map(|(dot, _)| (&first[..dot], Some(&first[dot + 1..])));
    std::iter::once((*first, None)).chain(parts).find_map(|(name, tail)| {
        let (key, value) = table.get_key_value(name)?;
        let rest: Vec<&str> = tail.into_iter().chain(rest.iter().copied()).collect();
        if rest.is_empty() { Some((key.span().start, value.get_ref())) } else { field_in_value(value.get_ref(), &rest) }
    })
}

fn field_in_value<'t, 'a>(value: &'t DeValue<'a>, path: &[&str]) -> Option<(usize, &'t DeValue<'a>)> {
    match value {
        DeValue::Table(table) => field_in_table(table, path),
        DeValue::Array(elements) => {
            let (number, rest) = path.split_first()?;
            let element = elements.get(number.parse::<usize>().ok()?)?;
            if rest.is_empty() {
                Some((element.span().start, element.get_ref()))
            } else {
                field_in_value(element.get_ref(), rest)
            }
        }
        _ => None,
    }
}

/// Returns the path to the key or value at this place.
fn path_in_table(table: &DeTable<'_>, place: &Range<usize>) -> Option<Vec<String>> {
    table.iter().find_map(|(key, value)| {
        let inner = path_in_value(value, place).or_else(|| (key.span() == *place).then(Vec::new))?;
        Some([vec![key.get_ref().to_string()], inner].concat())
    })
}

/// Returns the path from a value to the key or value at this place, which is empty for the value itself.
fn path_in_value(value: &Spanned<DeValue<'_>>, place: &Range<usize>) -> Option<Vec<String>> {
    let inner = match value.get_ref() {
        DeValue::Table(table) => path_in_table(table, place),
        DeValue::Array(elements) => elements.iter().enumerate().find_map(|(number, element)| {
            let inner = path_in_value(element, place)?;
            Some([vec![number.to_string()], inner].concat())
        }),
        _ => None,
    };
    inner.or_else(|| (value.span() == *place).then(Vec::new))
}

/// Text of a path, such as `views[0].orbit`.
fn path_text(path: &[String]) -> String {
    path.iter().fold(String::new(), |text, name| match name.parse::<usize>() {
        Ok(number) => format!("{text}[{number}]"),
        Err(_) if text.is_empty() => name.clone(),
        Err(_) => format!("{text}.{name}"),
    })
}

/// Returns a hint at the known name that is nearest to an unknown name in a message of serde.
fn nearest_hint(message: &str) -> String {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let known = names.split_first().filter(|_| message.starts_with("unknown "));
    let near = known.and_then(|(given, known)| nearest(given, known.iter().copied()));
    near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"))
}

/// Returns the number of the line, from 1, that follows this beginning of a text or is cut by it.
fn line_after(before: &str) -> usize {
    before.bytes().filter(|byte| *byte == b'\n').count() + 1
}

/// Maximum length of a message that quotes a line \[bytes\]. A line can be as long as the file.
const LONGEST: usize = 1000;

/// Describes an error in a text that is not valid TOML, with line and column.
pub(crate) fn syntax(text: &str, error: &toml::de::Error) -> String {
    let whole = error.to_string();
    if whole.len() <= LONGEST {
        return whole.trim_end().to_owned();
    }
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = line_after(before);
    let column = before.len() - before.rfind('\n').map_or(0, |at| at + 1) + 1;
    // The message itself is short, apart from names that it quotes.
    let words: String = error.message().chars().take(LONGEST).collect();
    format!("line {line}, column {column}: {words}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line_of(text: &str, path: &[&str]) -> Option<usize> {
        let start = FieldPositions::of(text).start_of(path)?;
        Some(line_after(&text[..start]))
    }

    #[test]
    fn fields_have_a_line_where_the_text_gives_them() {
        let text = "a.b = 1\n\n[search]\n# lanes\nlanes = 2\n";
        let lines = ["a.b", "search", "search.lanes", "search.foo", "lanes", "a.b.c"].map(|key| line_of(text, &[key]));
        assert_eq!(lines, [Some(1), Some(3), Some(5), None, None, None]);
        assert_eq!(line_of("[search", &["search"]), None);
        let lists = "[[zip]]\na = 1\n[[zip]]\nb.c = 2\n";
        let paths: [&[&str]; 7] =
            [&["zip", "0", "a"], &["zip", "1", "b.c"], &["zip", "1", "a"], &["zip", "2", "a"], &["zip", "a"], &["zip", "1"], &[]];
        assert_eq!(paths.map(|path| line_of(lists, path)), [Some(2), Some(4), None, None, None, Some(3), None]);
        assert_eq!(line_of("a = [\n1,\n[2,\n3]]", &["a", "1", "1"]), Some(4));
    }

    #[test]
    fn quoted_names_with_dots_have_a_line() {
        let text = "[axes]\n\"a.b.c\" = 1\n\"a.b\".d = 2\na.'e.f' = 3\na.b.g = 4\n[[zip]]\n\"h.i\" = 5\n";
        let lines = ["a.b.c", "a.b.d", "a.e.f", "a.b.g", "a.b.h"].map(|key| line_of(text, &["axes", key]));
        assert_eq!(lines, [Some(2), Some(3), Some(4), Some(5), None]);
        assert_eq!(line_of(text, &["zip", "0", "h.i"]), Some(7));
        let both = "a.b = 1\n\"a.b\" = 2";
        assert_eq!([line_of(both, &["a", "b"]), line_of(both, &["a.b"])], [Some(1), Some(2)]);
    }

    #[test]
    fn message_follows_the_line() {
        let says = |key| TomlFault::of_parameter(key, "wrong").at_line("\n[search]\nlanes = 2");
        assert_eq!([Some("search.lanes"), Some("lanes"), None].map(says), ["line 3: wrong", "wrong", "wrong"]);
    }

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only errors are of interest")]
    struct Written {
        lanes: u32,
        #[serde(default)]
        parts: Vec<Part>,
    }

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only errors are of interest")]
    struct Part {
        size: [f64; 2],
    }

    #[test]
    fn reader_errors_name_line_and_field_in_plain_words() {
        for (text, says) in [
            ("\nlanes = \"x\"", "line 2: lanes: the text \"x\" stands here, expected a whole number 0..=4294967295"),
            ("lanes = 1\nlane = 2", "line 2: lane: unknown field `lane`, expected `lanes` or `parts`; did you mean `lanes`?"),
            (
                "lanes = 1\n[[parts]]\nsize = [1, 2]\n[[parts]]\nsize = [1,\ntrue]",
                "line 6: parts[1].size[1]: true stands here, expected a number",
            ),
            ("lanes = 1\nparts = [\n{ size = 3 }]", "line 3: parts[0].size: the number 3 stands here, expected a list of 2"),
            ("lanes = 1\nparts = [\n3]", "line 3: parts[0]: the number 3 stands here, expected a table"),
            ("lanes = 1\n\n[[parts]]\n", "line 3: parts[0]: missing field `size`"),
            ("parts = []", "missing field `lanes`"),
        ] {
            let error = toml::from_str::<Written>(text).unwrap_err();
            assert_eq!(TomlFault::of_reader(text, &error).at_line(text), says);
        }
        let error = toml::from_str::<Written>("lanes = 1\nlanes").unwrap_err();
        let said = TomlFault::of_reader("lanes = 1\nlanes", &error).at_line("lanes = 1\nlanes");
        assert!(said.starts_with("TOML parse error at line 2, column 6\n"), "{said}");
    }
}
