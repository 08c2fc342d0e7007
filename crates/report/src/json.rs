//! Reports as JSON, there and back, and the schema that they keep to.

use crate::model::Report;
use basrelief_input::JsonFault;
use std::io::{self, Write};

/// Format and version of a report.
pub const SCHEMA: &str = "basrelief-report/2";

/// A text that is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// Not JSON, or a field is missing or has the wrong type.
    #[error("not a report: at `{field}`: {message}; `basrelief schema report` prints the format")]
    Format {
        /// Path of the field.
        field: String,
        /// Line and column, what stands there, and what was expected.
        message: String,
    },
    /// A report of another version.
    #[error("field `schema` is `{found}`, expected `{SCHEMA}`: make the report again with this version")]
    Version {
        /// What stands there.
        found: String,
    },
}

impl Report {
    /// The report as indented JSON, with a line feed at the end.
    ///
    /// # Errors
    /// If `config` holds what is no JSON; a value made by `serde_json::to_value` never does.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }

    /// Writes what [`Report::to_json`] gives, piece by piece: the text of a long run is never in memory as a whole.
    ///
    /// # Errors
    /// As [`Report::to_json`], or if `out` fails.
    pub fn write_json(&self, mut out: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut out, self)?;
        out.write_all(b"\n")
    }

    /// Reads what [`Report::to_json`] wrote.
    ///
    /// # Errors
    /// If the text is no report, or one of another version.
    pub fn from_json(text: &str) -> Result<Self, ReadError> {
        let report: Self = basrelief_input::from_str(text).map_err(|fault| {
            let JsonFault { path, line, column, message, .. } = fault;
            ReadError::Format { field: path.to_string(), message: format!("line {line}, column {column}: {message}") }
        })?;
        if report.schema == SCHEMA { Ok(report) } else { Err(ReadError::Version { found: report.schema }) }
    }
}

/// The JSON schema of a report.
pub fn schema() -> serde_json::Value {
    let mut schema = schemars::schema_for!(Report);
    if let Some(title) = schema.get_mut("properties").and_then(|p| p.pointer_mut("/schema")) {
        title["const"] = SCHEMA.into();
    }
    schema.to_value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn a_report_keeps_to_its_schema() {
        let validator = jsonschema::validator_for(&schema()).unwrap();
        for report in [samples::balanced(), samples::costed(), samples::functional()] {
            let json = serde_json::to_value(&report).unwrap();
            let errors: Vec<String> = validator.iter_errors(&json).map(|e| format!("{}: {e}", e.instance_path())).collect();
            assert!(errors.is_empty(), "{errors:?}");
        }
        let mut other = serde_json::to_value(samples::balanced()).unwrap();
        other["schema"] = "basrelief-report/1".into();
        assert!(!validator.is_valid(&other));
        other["schema"] = SCHEMA.into();
        other["cycles"]["total"] = "many".into();
        assert!(!validator.is_valid(&other));
    }

    #[test]
    fn json_goes_there_and_back() {
        for report in [samples::balanced(), samples::costed(), samples::functional()] {
            let text = report.to_json().unwrap();
            assert_eq!(Report::from_json(&text).unwrap(), report);
            let mut written = Vec::new();
            report.write_json(&mut written).unwrap();
            assert_eq!(written, text.as_bytes());
        }
    }

    #[test]
    fn a_functional_report_has_no_time() {
        let json = serde_json::to_value(samples::functional()).unwrap();
        for part in ["cycles", "units", "fifos", "memories", "caches", "host"] {
            assert!(json.get(part).is_none(), "{part}");
        }
    }

    #[test]
    fn what_is_no_report_is_refused_with_its_place() {
        let says = |text: &str, part: &str| {
            let message = Report::from_json(text).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        };
        says("", "line 1, column 0: the text ends within a value");
        says("[[", "at `.`: line 1, column 0: a list stands here, expected an object");
        let good = samples::balanced().to_json().unwrap();
        says(&good.replace("basrelief-report/2", "basrelief-report/9"), "`basrelief-report/9`");
        says(&good.replacen("\"total\": 1", "\"total\": -1", 1), "at `cycles.total`: line ");
        says(&good.replacen("\"total\": 1", "\"total\": -1", 1), "the number -1");
        says(&format!("{good} x"), "trailing");
    }
}
