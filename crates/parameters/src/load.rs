//! From TOML, JSON and `key=value` pairs to a checked configuration.

use crate::error::allowed;
use crate::fields::{from_json, to_json};
use crate::json::{is_json, parse_json};
use crate::settings::{check_known, check_tree, insert_setting, merge, parse_value, rename, settings_in};
use crate::toml_fault::syntax;
use crate::{ConfigError, Parameter, Parameters, RangeError, UserSettings};
use basrelief_input::{TextFormat, plain_message};
use serde_json::Value as Json;
use std::marker::PhantomData;
use toml::{Table, Value};

/// Reads a configuration: defaults, then the text, then single settings in order. The text is TOML, or an object of parameters in JSON.
/// Dependent parameters ([`Parameters::complete`]) that the user has not set replace their defaults last, so the order of the settings
/// does not matter.
///
/// A setting's value is TOML (`32`, `[256, 128]`, `true`). Any other text is a string, so `replacement.codebook=fixed` needs no
/// quotes.
pub fn load<C: Parameters>(text: &str, settings: &[(&str, &str)]) -> Result<C, ConfigError> {
    Loader::new(text)?.load(settings)
}

/// Returns true if the text or one of the settings gives this parameter. An invalid text gives none.
pub fn is_given(text: &str, settings: &[(String, String)], key: &str) -> bool {
    let in_text = || parse_text(text).is_ok_and(|table| UserSettings(&table).contains(key));
    settings.iter().any(|(given, _)| given == key) || in_text()
}

/// Loads many configurations over one text. Work that does not depend on the settings is done once.
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
    /// If the text is not valid TOML or JSON. Other errors are found when a configuration is loaded.
    pub fn new(text: &str) -> Result<Self, ConfigError> {
        let given = parse_text(text)?;
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

/// Parses a text of parameters: JSON if it begins with a brace, otherwise TOML.
fn parse_text(text: &str) -> Result<Table, ConfigError> {
    if is_json(text) { parse_json(text) } else { text.parse().map_err(|error| ConfigError::Syntax(syntax(text, &error))) }
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
            // Only a whole number refuses a fraction by its type.
            let is_fraction = value.parse::<f64>().is_ok() && value.contains(['.', 'e']);
            let whole = if is_fraction { "a whole number " } else { "" };
            let expected = format!("{whole}{}", allowed(&known.range, known.unit));
            RangeError { key, value, expected }.into()
        }
        None => ConfigError::Type { key, message: plain_message(message, TextFormat::Toml) },
    }
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
        let c: All = load(r#"{"search": {"lanes": 4, "pipelined": true}}"#, &[("search.lanes", "2")]).unwrap();
        assert_eq!((c.search.lanes, c.search.pipelined), (2, true));
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
        says("", &[("search.lanes", "1.5")], "`search.lanes` is 1.5, expected a whole number 1..=4096 inner products/cycle");
        says("search.lanes = 1e2", &[], "`search.lanes` is 100.0, expected a whole number 1..=4096 inner products/cycle");
        says("[search", &[], "not valid TOML");
        says("\"search.lanes\" = 3", &[], "`search.lanes`: has quotes around dots");
        says("search.pipelined = 3", &[], "`search.pipelined`: the number 3 stands here, expected true or false");
        says("search.pipelined.a = 3", &[], "`search.pipelined`: a table stands here, expected true or false");
        let long = format!("a = 1\nb = {}", "[".repeat(100_000));
        let message = load::<All>(&long, &[]).unwrap_err().to_string();
        assert!(message.starts_with("not valid TOML: line 2, column ") && message.len() < 1100, "{message:.200}");
        says("", &[("search.lanes", "-1")], "expected 1..=4096");
        says("", &[("zzz", "1")], "unknown parameter `zzz` (`basrelief describe MACHINE` lists all)");
        says(r#"{"search": {"lane": 1}}"#, &[], "did you mean `search.lanes`");
        says(r#"{"search": {"lanes": 0}}"#, &[], "`search.lanes` is 0, expected 1..=4096");
        // Only the group is near.
        says("", &[("search.foo", "1")], "unknown parameter `search.foo` (");
    }
}
