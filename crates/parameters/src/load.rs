//! From TOML and `key=value` pairs to a checked configuration.

use crate::error::allowed;
use crate::fields::{from_json, to_json};
use crate::{ConfigError, Parameter, Parameters, RangeError, UserSettings};
use serde::de::Unexpected;
use serde_json::Value as Json;
use std::marker::PhantomData;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// Reads a configuration: defaults, then the TOML text, then single settings in order. Dependent parameters
/// ([`Parameters::complete`]) that the user has not set replace their defaults last, so the order of the settings does not
/// matter.
///
/// A setting's value is TOML (`32`, `[256, 128]`, `true`). Any other text is a string, so `replacement.codebook=fixed` needs no
/// quotes.
pub fn load<C: Parameters>(toml_text: &str, settings: &[(&str, &str)]) -> Result<C, ConfigError> {
    Loader::new(toml_text)?.load(settings)
}

/// Returns true if the TOML text or one of the settings gives this parameter. An invalid text gives none.
pub fn is_given(toml_text: &str, settings: &[(String, String)], key: &str) -> bool {
    let in_text = || toml_text.parse().is_ok_and(|table| UserSettings(&table).contains(key));
    settings.iter().any(|(given, _)| given == key) || in_text()
}

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

/// Loads many configurations over one TOML text. Work that does not depend on the settings is done once.
#[derive(Clone, Debug)]
pub struct Loader<C> {
    given: Table,
    known: Vec<String>,
    default: Json,
    of: PhantomData<fn() -> C>,
}

impl<C: Parameters> Loader<C> {
    /// Parses the text.
    ///
    /// # Errors
    /// If the text is not valid TOML. Other errors are found when a configuration is loaded.
    pub fn new(toml_text: &str) -> Result<Self, ConfigError> {
        let given: Table = toml_text.parse().map_err(|e| ConfigError::Syntax(syntax(toml_text, &e)))?;
        let known = C::table().into_iter().map(|p| p.key).collect();
        let wrong = |error: serde_json::Error| ConfigError::Syntax(error.to_string());
        Ok(Self { given, known, default: to_json(&C::default()).map_err(wrong)?, of: PhantomData })
    }

    /// As [`load`] with its text and these settings.
    ///
    /// # Errors
    /// Errors of [`load`].
    pub fn load(&self, settings: &[(&str, &str)]) -> Result<C, ConfigError> {
        let mut tree = self.given.clone();
        for (key, value) in settings {
            if !C::renamed().iter().any(|(old, _)| old == key) {
                check_known(key, &self.known)?;
            }
            insert_setting(&mut tree, key, parse_value(value))?;
        }
        rename(&mut tree, C::renamed())?;
        check_tree(&tree, "", &self.known)?;
        let mut config = self.over_defaults(tree.clone()).map_err(|error| self.wrong_type(&tree, &error))?;
        config.check("")?;
        config.complete(&UserSettings(&tree))?;
        config.check("")?;
        Ok(config)
    }

    /// Merges the given values over the defaults of the whole configuration.
    fn over_defaults(&self, given: Table) -> Result<C, serde_json::Error> {
        let mut tree = self.default.clone();
        merge(&mut tree, Value::Table(given))?;
        from_json(tree)
    }

    /// Finds the first parameter that alone makes the configuration invalid. Returns its value and its range. If the table has no
    /// range, returns the deserializer's message, without the repeated place. (A deserializer that tracks its place, for every type
    /// of every machine, took a tenth of the build time.)
    fn wrong_type(&self, given: &Table, whole: &serde_json::Error) -> ConfigError {
        let alone = |(key, value): (String, &Value)| {
            let mut tree = Table::new();
            insert_setting(&mut tree, &key, value.clone()).ok()?;
            self.over_defaults(tree).err().map(|error| (key, value_text(value), error.to_string()))
        };
        let found = settings_in(given, "", &self.known).into_iter().find_map(alone);
        let (key, value, message) = found.unwrap_or_else(|| (String::new(), String::new(), whole.to_string()));
        wrong_type_of(&C::table(), key, value, &message)
    }
}

/// Returns the text of a value. (The writer of TOML is nowhere else in the web page.)
fn value_text(value: &Value) -> String {
    match value {
        Value::Float(number) => format!("{number:?}"),
        value => serde_json::to_value(value).map_or_else(|error| error.to_string(), |json| json.to_string()),
    }
}

fn wrong_type_of(table: &[Parameter], key: String, value: String, message: &str) -> ConfigError {
    match table.iter().find(|p| p.key == key && !p.range.is_empty()) {
        Some(known) => {
            let expected = allowed(&known.range, known.unit);
            RangeError { key, value, expected }.into()
        }
        None => ConfigError::Type { key, message: first_line(message) },
    }
}

/// Returns the first line of a message of the deserializer.
fn first_line(message: &str) -> String {
    plain_words(message.trim().lines().next().unwrap_or_default())
}

/// Returns a message of the deserializer without terms of the programming language.
fn plain_words(message: &str) -> String {
    message.replacen("unknown variant", "unknown value", 1)
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

/// Flattens the given values to dotted names.
fn settings_in<'a>(tree: &'a Table, prefix: &str, known: &[String]) -> Vec<(String, &'a Value)> {
    let leaf = |(name, value): (&String, &'a Value)| {
        let key = format!("{prefix}{name}");
        match value {
            Value::Table(inner) if !known.contains(&key) => settings_in(inner, &format!("{key}."), known),
            _ => vec![(key, value)],
        }
    };
    tree.iter().flat_map(leaf).collect()
}

fn merge(tree: &mut Json, given: Value) -> Result<(), serde_json::Error> {
    match given {
        Value::Table(given) if tree.is_object() => given.into_iter().try_for_each(|(key, value)| merge(&mut tree[key], value)),
        // JSON has no such numbers and would turn them into null.
        Value::Float(number) if !number.is_finite() => {
            Err(serde::de::Error::invalid_value(Unexpected::Float(number), &"a finite number"))
        }
        given => {
            *tree = serde_json::to_value(given)?;
            Ok(())
        }
    }
}

fn parse_value(text: &str) -> Value {
    format!("v = {text}")
        .parse::<Table>()
        .ok()
        .filter(|t| t.len() == 1)
        .and_then(|mut t| t.remove("v"))
        .unwrap_or_else(|| Value::String(text.into()))
}

fn insert_setting(tree: &mut Table, key: &str, value: Value) -> Result<(), ConfigError> {
    let (path, leaf) = key.rsplit_once('.').unwrap_or(("", key));
    let mut at = tree;
    for part in path.split('.').filter(|p| !p.is_empty()) {
        let next = at.entry(part).or_insert_with(|| Value::Table(Table::new()));
        at = next
            .as_table_mut()
            .ok_or_else(|| ConfigError::Type { key: key.into(), message: format!("`{part}` is a value, expected a table") })?;
    }
    at.insert(leaf.into(), value);
    Ok(())
}

fn check_tree(tree: &Table, prefix: &str, known: &[String]) -> Result<(), ConfigError> {
    for (name, value) in tree {
        let key = format!("{prefix}{name}");
        match value {
            Value::Table(inner) if !known.contains(&key) => {
                let group = format!("{key}.");
                if !known.iter().any(|k| k.starts_with(&group)) {
                    check_known(&key, known)?;
                }
                check_tree(inner, &group, known)?;
            }
            _ => check_known(&key, known)?,
        }
    }
    Ok(())
}

/// Replaces old names of parameters. A value under the new name takes precedence.
fn rename(tree: &mut Table, renamed: &[(&str, &str)]) -> Result<(), ConfigError> {
    for (old, new) in renamed {
        if let Some(value) = remove(tree, old)
            && !new.is_empty()
            && !UserSettings(tree).contains(new)
        {
            insert_setting(tree, new, value)?;
        }
    }
    Ok(())
}

/// Removes a setting, and its group if nothing is left in the group.
fn remove(tree: &mut Table, key: &str) -> Option<Value> {
    let Some((group, rest)) = key.split_once('.') else { return tree.remove(key) };
    let inner = tree.get_mut(group)?.as_table_mut()?;
    let value = remove(inner, rest)?;
    if inner.is_empty() {
        tree.remove(group);
    }
    Some(value)
}

fn check_known(key: &str, known: &[String]) -> Result<(), ConfigError> {
    if known.iter().any(|k| k == key) {
        return Ok(());
    }
    let nearest = nearest(key, known.iter().map(String::as_str)).map(str::to_owned);
    Err(ConfigError::Unknown { key: key.into(), nearest })
}

/// Returns the known name, dotted or not, that is nearest to the `given` one, if any is near.
pub fn nearest<'a>(given: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let near = known.filter_map(|k| Some((distance(given, k)?, k)));
    near.min_by_key(|(edits, _)| *edits).map(|(_, k)| k)
}

/// Returns the Levenshtein distance between the `given` name and a `known` name or its group; `None` if more than half of the name or of its
/// last part differs, because such a suggestion would mislead. An equal last part has a bonus, because users forget groups more often
/// than they mistype.
fn distance(given: &str, known: &str) -> Option<usize> {
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let is_near = |edits: usize, of: &str| 2 * edits <= of.len();
    let group = known.split('.').take(given.split('.').count()).collect::<Vec<_>>().join(".");
    let end = last(given);
    // The rest of a name may be missing.
    let has_near_end = |name: &str| last(name).starts_with(&end) || is_near(edits(&end, &last(name)), &end);
    let by_end = 1 + 2 * edits(&end, &last(known));
    let all = [(edits(given, known), known), (edits(given, &group), &group), (by_end, known)];
    let near = all.into_iter().filter(|(edits, name)| is_near(*edits, given) && has_near_end(name));
    near.map(|(edits, _)| edits).min()
}

fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let next = (row[j] + 1).min(row[j + 1] + 1).min(diagonal + usize::from(x != *y));
            diagonal = std::mem::replace(&mut row[j + 1], next);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::parameters! {
        /// A search.
        pub struct SearchConfig {
            /// Inner products per cycle.
            lanes: u32 = 8, unit: "inner products/cycle", Assumed("test"), range: 1..=4096;
            /// One search may start each cycle.
            pipelined: bool = false, unit: "", Assumed("test");
        }
    }
    crate::parameter_groups! {
        /// All.
        pub struct All {
            /// The search.
            search: SearchConfig = SearchConfig { lanes: 16, ..SearchConfig::default() },
        }
    }

    #[test]
    fn later_settings_win_over_toml() {
        let c: All = load("[search]\nlanes = 4", &[("search.lanes", "2")]).unwrap();
        assert_eq!(c.search.lanes, 2);
        assert_eq!(load::<All>("", &[]).unwrap().search.lanes, 16);
    }

    #[test]
    fn setting_one_parameter_keeps_its_group_defaults() {
        let c: All = load("", &[("search.pipelined", "true")]).unwrap();
        assert_eq!((c.search.lanes, c.search.pipelined), (16, true));
        let c: All = load("[search]\npipelined = true", &[]).unwrap();
        assert_eq!((c.search.lanes, c.search.pipelined), (16, true));
    }

    #[test]
    fn table_shows_default_of_group() {
        assert_eq!(All::table()[0].default, serde_json::json!(16));
        assert_eq!(All::table()[0].key, "search.lanes");
    }

    crate::parameter_groups! {
        /// Lanes follow from `wide.lanes` where they are not given.
        pub struct Following completed(follow) explained(note_reason) renamed(OLD_NAMES) {
            /// Leads.
            wide: SearchConfig = SearchConfig::default() => [lanes: Stated("claim 1")],
            /// Follows.
            narrow: SearchConfig = SearchConfig { lanes: 4, ..SearchConfig::default() },
        }
    }

    const OLD_NAMES: &[(&str, &str)] = &[("broad.lanes", "wide.lanes"), ("broad.gone", "")];

    fn follow(config: &mut Following, given: &UserSettings<'_>) -> Result<(), ConfigError> {
        if !given.contains("narrow.lanes") {
            config.narrow.lanes = config.wide.lanes / 2;
        }
        Ok(())
    }

    fn note_reason(_: &Following, table: &mut [crate::Parameter]) {
        table[2].provenance = crate::Provenance::Derived("half".into());
    }

    #[test]
    fn old_names_are_read_and_new_names_take_precedence() {
        let lanes = |toml: &str, set: &[(&str, &str)]| load::<Following>(toml, set).unwrap().wide.lanes;
        assert_eq!(lanes("[broad]\nlanes = 64\ngone = 1", &[]), 64);
        assert_eq!(lanes("", &[("broad.lanes", "32"), ("broad.gone", "5")]), 32);
        assert_eq!(lanes("[broad]\nlanes = 64", &[("wide.lanes", "8")]), 8);
        assert!(load::<Following>("[broad]\nlane = 64", &[]).is_err(), "never a name");
    }

    #[test]
    fn dependent_values_yield_to_given_values_in_any_order() {
        let lanes = |toml: &str, set: &[(&str, &str)]| load::<Following>(toml, set).unwrap().narrow.lanes;
        assert_eq!(lanes("", &[]), 4);
        assert_eq!(lanes("", &[("wide.lanes", "64")]), 32);
        assert_eq!(lanes("[wide]\nlanes = 64", &[("narrow.pipelined", "true")]), 32);
        for set in [[("wide.lanes", "64"), ("narrow.lanes", "9")], [("narrow.lanes", "9"), ("wide.lanes", "64")]] {
            assert_eq!(lanes("", &set), 9);
        }
        assert_eq!(lanes("[narrow]\nlanes = 9", &[("wide.lanes", "64")]), 9);
        // Dependent values must be in their range, too.
        let error = load::<Following>("", &[("wide.lanes", "1")]).unwrap_err().to_string();
        assert!(error.contains("`narrow.lanes` is 0"), "{error}");
    }

    #[test]
    fn resolved_table_has_values_and_provenance() {
        let table = crate::resolved(&load::<Following>("", &[("wide.lanes", "64")]).unwrap());
        let set = "set; the default is 8 (stated: claim 1)";
        assert_eq!((table[0].default.clone(), table[0].provenance.text()), (serde_json::json!(64), set));
        assert_eq!(crate::resolved(&Following::default())[0].provenance, crate::Provenance::Stated("claim 1".into()));
        assert_eq!((table[2].default.clone(), table[2].provenance.text()), (serde_json::json!(32), "half"));
        assert_eq!(table[1].provenance.text(), "test");
    }

    #[test]
    fn every_kind_of_error_is_named() {
        let says = |toml: &str, set: &[(&str, &str)], part: &str| {
            let e = load::<All>(toml, set).unwrap_err().to_string();
            assert!(e.contains(part), "{e}");
        };
        says("", &[("search.lane", "1")], "did you mean `search.lanes`");
        says("", &[("lanes", "1")], "did you mean `search.lanes`");
        says("[serch]\nlanes = 1", &[], "did you mean `search.lanes`");
        says("", &[("search.lanes", "0")], "`search.lanes` is 0, expected 1..=4096");
        says("", &[("search.lanes", "many")], "expected 1..=4096 inner products/cycle");
        says("[search", &[], "not valid TOML");
        let long = format!("a = 1\nb = {}", "[".repeat(100_000));
        let message = load::<All>(&long, &[]).unwrap_err().to_string();
        assert!(message.starts_with("not valid TOML: line 2, column ") && message.len() < 1100, "{message:.200}");
        says("", &[("search.lanes", "-1")], "expected 1..=4096");
        says("", &[("zzz", "1")], "unknown parameter `zzz` (`basrelief describe MACHINE` lists all)");
        // Only the group is near.
        says("", &[("search.foo", "1")], "unknown parameter `search.foo` (");
    }

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
