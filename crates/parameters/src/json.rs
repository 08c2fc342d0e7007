//! Configurations in JSON: an object of parameters, or a report of a run.

use crate::ConfigError;
use basrelief_input::{JsonFault, JsonStep, field_range, from_str};
use serde::Deserialize;
use serde::de::IgnoredAny;
use toml::{Table, Value};

/// Returns true if a configuration is JSON. No TOML text begins with a brace.
pub(crate) fn is_json(text: &str) -> bool {
    text.trim_start().starts_with('{')
}

/// Returns the parameters of a JSON text.
///
/// # Errors
/// A text that is not JSON, a value that no parameter can have, a name with dots.
pub(crate) fn parse_json(text: &str) -> Result<Table, ConfigError> {
    let table = from_str(text).map_err(|fault| json_error(&fault))?;
    match dotted_name(&table, "") {
        Some(key) => {
            let message = "has dots, which make one name of several; expected objects in objects, as in a report.json";
            Err(ConfigError::Type { key, message: message.into() })
        }
        None => Ok(table),
    }
}

/// Returns the first name with dots.
fn dotted_name(table: &Table, prefix: &str) -> Option<String> {
    table.iter().find_map(|(name, value)| {
        let key = format!("{prefix}{name}");
        match value {
            _ if name.contains('.') => Some(key),
            Value::Table(inner) => dotted_name(inner, &format!("{key}.")),
            _ => None,
        }
    })
}

fn json_error(fault: &JsonFault) -> ConfigError {
    let JsonFault { path, line, column, is_data, message } = fault;
    let message = message.replace("any valid TOML value", "a value");
    if !is_data {
        return ConfigError::Json(format!("line {line}, column {column}: {message}"));
    }
    let names = path.0.iter().map_while(|step| if let JsonStep::Key(name) = step { Some(name.as_str()) } else { None });
    ConfigError::Type { key: names.collect::<Vec<_>>().join("."), message }
}

/// Configuration of a report of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportConfig {
    /// Name of the machine.
    pub machine: String,
    /// The parameters as JSON. They have the same lines and columns as in the report.
    pub text: String,
}

/// Schemas of reports whose configuration is read.
const SCHEMAS: [&str; 2] = ["basrelief-report/2", "basrelief-report/3"];

/// Fields of a report that tell it from an object of parameters.
#[derive(Deserialize)]
struct ReportHead {
    schema: Option<String>,
    machine: Option<String>,
    config: Option<IgnoredAny>,
}

impl ReportConfig {
    /// Returns the configuration of a report; `None` for TOML, and for an object of parameters, which has no `config`.
    ///
    /// # Errors
    /// A text that begins as JSON and is not JSON, and a `config` without `machine`.
    pub fn of(text: &str) -> Result<Option<Self>, ConfigError> {
        if !is_json(text) {
            return Ok(None);
        }
        let head: ReportHead = from_str(text).map_err(|fault| json_error(&fault))?;
        let Some(range) = head.config.and_then(|_| field_range(text, "config")) else { return Ok(None) };
        let error = |message: &str| ConfigError::Type { key: "config".into(), message: message.into() };
        let machine =
            head.machine.ok_or_else(|| error("stands here without `machine`; expected a report.json, or parameters"))?;
        if let Some(schema) = head.schema.filter(|schema| !SCHEMAS.contains(&schema.as_str())) {
            let message =
                format!("is `{schema}`, expected `{}`; make the report again with this version", SCHEMAS.join("` or `"));
            return Err(ConfigError::Type { key: "schema".into(), message });
        }
        let start = range.start + text[range.clone()].find('{').ok_or_else(|| error("expected an object of parameters"))?;
        let blank = |c: char| if c == '\n' { c } else { ' ' };
        let text = text[..start].chars().map(blank).chain(text[start..range.end].chars()).collect();
        Ok(Some(Self { machine, text }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TomlFault;

    fn error(text: &str) -> String {
        let error = parse_json(text).unwrap_err();
        TomlFault::of_parameter(error.key(), error.to_string()).at_line(text)
    }

    #[test]
    fn object_of_parameters_is_a_table() {
        let toml = "a = 1\nb.c = 1.5\nb.d = [true, 'x']".parse::<Table>().unwrap();
        assert_eq!(parse_json(r#"{"a": 1, "b": {"c": 1.5, "d": [true, "x"]}}"#).unwrap(), toml);
    }

    #[test]
    fn errors_name_line_and_field() {
        assert_eq!(error("{\n\"a\": {\n\"b\": null}}"), "line 3: `a.b`: null stands here, expected a value");
        assert_eq!(error("{\n\"a\": {\n\"b\": [1, null]}}"), "line 3: `a.b`: null stands here, expected a value");
        assert_eq!(error("{\n\"a\" 1}"), "not valid JSON: line 2, column 5: expected `:`");
        let dots = "line 2: `a.b`: has dots, which make one name of several; expected objects in objects, as in a report.json";
        assert_eq!(error("{\n\"a.b\": 1}"), dots);
        assert_eq!(error("{\"a\":{\"c\":1,\n\"b\":1, \"b\": 2}}"), "line 2: `a.b`: duplicate key: `b`");
    }

    #[test]
    fn config_of_a_report_keeps_its_lines() {
        let report = "{\"machine\": \"bump\",\n  \"config\": {\n\"a\": null}, \"derived\": {\"a\": null}}";
        let config = ReportConfig::of(report).unwrap().unwrap();
        assert_eq!(
            config,
            ReportConfig { machine: "bump".into(), text: format!("{}\n{}{{\n\"a\": null}}", " ".repeat(19), " ".repeat(12)) }
        );
        assert_eq!(error(&config.text), "line 3: `a`: null stands here, expected a value");
    }

    #[test]
    fn text_without_config_is_no_report() {
        for text in ["", "a = 1", "{}", r#"{"machine": "bump", "a": {"config": {}}}"#] {
            assert_eq!(ReportConfig::of(text).unwrap(), None, "{text}");
        }
    }

    #[test]
    fn config_of_no_report_is_an_error() {
        let error = |text| ReportConfig::of(text).unwrap_err().to_string();
        assert!(error(r#"{"config": {}}"#).contains("`config`: stands here without `machine`"));
        assert!(error(r#"{"machine": "bump", "config": 3}"#).contains("`config`: expected an object of parameters"));
        let unknown = error(r#"{"schema": "basrelief-report/9", "machine": "bump", "config": {}}"#);
        assert!(unknown.contains("`schema`: is `basrelief-report/9`, expected `basrelief-report/2` or"), "{unknown}");
        assert!(ReportConfig::of(r#"{"schema": "basrelief-report/3", "machine": "bump", "config": {}}"#).is_ok());
        assert!(error(r#"{"config": {"#).contains("not valid JSON: line 1, column "));
    }
}
