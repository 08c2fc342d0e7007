//! Lines and words of errors in a TOML text.

use toml::de::{DeTable, DeValue};

/// Returns the line of a parameter in a TOML text, counted from 1; `None` if the text does not give it. In a list of tables, a number
/// selects the table: `zip.0.fifo.pixels.depth`.
pub fn line_of(toml_text: &str, key: &str) -> Option<usize> {
    let whole = DeTable::parse(toml_text).ok()?;
    let start = key_start(whole.get_ref(), key)?;
    Some(line_after(toml_text.get(..start)?))
}

/// Returns the offset of the last name of a dotted key.
fn key_start(table: &DeTable<'_>, key: &str) -> Option<usize> {
    let (name, rest) = key.split_once('.').map_or((key, None), |(name, rest)| (name, Some(rest)));
    let (found, value) = table.get_key_value(name)?;
    let Some(rest) = rest else { return Some(found.span().start) };
    match value.get_ref() {
        DeValue::Table(inner) => key_start(inner, rest),
        DeValue::Array(tables) => {
            let (number, rest) = rest.split_once('.').map_or((rest, None), |(number, rest)| (number, Some(rest)));
            let table = tables.get(number.parse::<usize>().ok()?)?;
            rest.map_or(Some(table.span().start), |rest| key_start(table.get_ref().as_table()?, rest))
        }
        _ => None,
    }
}

/// Returns the text of an error, after the line of its parameter if the TOML text gives the parameter.
pub fn at_line(toml_text: &str, key: Option<&str>, error: String) -> String {
    match key.and_then(|key| line_of(toml_text, key)) {
        Some(line) => format!("line {line}: {error}"),
        None => error,
    }
}

/// Returns the number of the line, from 1, that follows this beginning of a text or is cut by it.
fn line_after(before: &str) -> usize {
    before.bytes().filter(|byte| *byte == b'\n').count() + 1
}

/// Maximum length of a message that quotes a line \[bytes\]. A line can be as long as the file.
const LONGEST: usize = 1000;

/// Describes an error in a TOML text, with line and column.
pub fn syntax(text: &str, error: &toml::de::Error) -> String {
    let whole = error.to_string();
    if whole.len() <= LONGEST {
        return plain_words(whole.trim_end());
    }
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = line_after(before);
    let column = before.len() - before.rfind('\n').map_or(0, |at| at + 1) + 1;
    // The message itself is short, apart from names that it quotes.
    let words: String = error.message().chars().take(LONGEST).collect();
    format!("line {line}, column {column}: {}", plain_words(&words))
}

/// Returns the first line of a message of the deserializer.
pub(crate) fn first_line(message: &str) -> String {
    plain_words(message.trim().lines().next().unwrap_or_default())
}

/// Returns a message of the deserializer without terms of the programming language.
fn plain_words(message: &str) -> String {
    message.replacen("unknown variant", "unknown value", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_a_line_where_the_text_gives_them() {
        let text = "a.b = 1\n\n[search]\n# lanes\nlanes = 2\n";
        let lines = ["a.b", "search", "search.lanes", "search.foo", "lanes", "a.b.c"].map(|key| line_of(text, key));
        assert_eq!(lines, [Some(1), Some(3), Some(5), None, None, None]);
        assert_eq!(line_of("[search", "search"), None);
        let lists = "[[zip]]\na = 1\n[[zip]]\nb.c = 2\n";
        let lines = ["zip.0.a", "zip.1.b.c", "zip.1.a", "zip.2.a", "zip.a", "zip.1"].map(|key| line_of(lists, key));
        assert_eq!(lines, [Some(2), Some(4), None, None, None, Some(3)]);
        assert_eq!(at_line(text, Some("search.lanes"), "wrong".into()), "line 5: wrong");
        assert_eq!(at_line(text, Some("lanes"), "wrong".into()), "wrong");
    }
}
