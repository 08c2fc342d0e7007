//! Reports as JSON: writer, reader and schema.

use crate::derived::derive;
use crate::model::{ALWAYS_HITS, FULLY_PIPELINED, PictureQuality, Report, UNBOUNDED_FIFO};
use basrelief_input::JsonFault;
use basrelief_signals::schema_of;
use std::io::{self, Write};

/// Format and version of a report.
pub const SCHEMA: &str = "basrelief-report/3";
/// Format and version of the reports of version 0.1.
const SCHEMA_2: &str = "basrelief-report/2";

/// Error of a text that is not a report.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// Not JSON, or a field is missing or has the wrong type.
    #[error("not a report: at `{field}`: {message}; `basrelief schema report` prints the format")]
    Format {
        /// Path of the field.
        field: String,
        /// Line, column, the value found, and the expected value.
        message: String,
    },
    /// A report of another version.
    #[error("field `schema` is `{found}`, expected `{SCHEMA}`: make the report again with this version")]
    Version {
        /// The version found.
        found: String,
    },
}

impl Report {
    /// Returns the report as indented JSON, with a line feed at the end.
    ///
    /// # Errors
    /// A `config` that is not JSON. A value made by `serde_json::to_value` always is.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }

    /// Writes the text of [`Report::to_json`] in chunks, so that the whole text is never in memory.
    ///
    /// # Errors
    /// Errors of [`Report::to_json`], or if `out` fails.
    pub fn write_json(&self, mut out: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut out, self)?;
        out.write_all(b"\n")
    }

    /// Reads the text that [`Report::to_json`] wrote, in this version or in version 0.1.
    ///
    /// # Errors
    /// A text that is not a report, or a report of an unknown schema.
    pub fn from_json(text: &str) -> Result<Self, ReadError> {
        let mut report: Self = basrelief_input::from_str(text).map_err(|fault| {
            let JsonFault { path, line, column, message, .. } = fault;
            ReadError::Format { field: path.to_string(), message: format!("line {line}, column {column}: {message}") }
        })?;
        if report.bytes.is_none() {
            report.count_bytes();
        }
        report.quality.iter_mut().for_each(PictureQuality::summarize);
        match report.schema.as_str() {
            SCHEMA => Ok(report),
            SCHEMA_2 => Ok(from_schema_2(report)),
            _ => Err(ReadError::Version { found: report.schema }),
        }
    }
}

/// Maps the names within a report of version 0.1. Aliases of the fields have mapped its keys already.
fn from_schema_2(mut report: Report) -> Report {
    report.schema = SCHEMA.into();
    report.derived = derive(&report);
    for limit in report.bottlenecks.iter_mut().flat_map(|of| &mut of.single) {
        // Version 0.1 named FIFOs, memories and caches without the group of their parameters.
        let group = limit.set.first().and_then(|set| set.split_once('.')).map(|(group, _)| group);
        if let Some(group @ ("fifo" | "memory" | "cache")) = group {
            limit.resource = format!("{group}.{}", limit.resource);
        }
        limit.what = match limit.what.as_str() {
            "a cycle per step" => FULLY_PIPELINED,
            "slots without bound" => UNBOUNDED_FIFO,
            "no latency" => "zero latency",
            "a cycle per burst" => "one cycle per burst",
            "no latency, no row commands, a cycle per burst" => "zero latency, no row commands, one cycle per burst",
            "every look-up hits" => ALWAYS_HITS,
            other => other,
        }
        .to_owned();
    }
    report
}

/// The JSON schema of a report.
pub fn schema() -> serde_json::Value {
    let mut schema = schema_of::<Report>(&format!("report-{SCHEMA}"));
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
    fn psnr_description_states_pixels_and_limit() {
        let schema = schema();
        let about = schema["$defs"]["QualityMetrics"]["properties"]["psnr_db"]["description"].as_str().unwrap();
        assert!(about.contains("over the pixels that either image covers"), "{about}");
        assert!(
            about.ends_with(&format!("at most {0}; {0} if they are identical.", basrelief_reference::metrics::IDENTICAL_DB)),
            "{about}"
        );
    }

    // Claim: analysis: Moved bytes are those of whole bursts, in each memory and in all.
    #[test]
    fn old_report_gets_its_moved_bytes_from_bursts() {
        let report = samples::balanced();
        let bursts = |memory: &str| report.memories.as_ref().unwrap()[memory].clients.values().map(|c| c.bursts).sum::<u64>();
        let bytes = report.bytes.unwrap();
        assert_eq!(report.memories.as_ref().unwrap()["graphics"].bytes.moved, 64 * bursts("graphics"));
        assert_eq!(bytes.moved, 64 * (bursts("graphics") + bursts("normal_map")));
        assert_eq!(bytes.requested, 4 * 520_000);
        let mut old = serde_json::to_value(&report).unwrap();
        old.as_object_mut().unwrap().remove("bytes");
        for memory in old["memories"].as_object_mut().unwrap().values_mut() {
            memory.as_object_mut().unwrap().remove("bytes");
            for client in memory["clients"].as_object_mut().unwrap().values_mut() {
                client.as_object_mut().unwrap().remove("moved_bytes");
            }
        }
        assert_eq!(Report::from_json(&old.to_string()).unwrap(), report);
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

    /// A report of version 0.1: every renamed key under its old name.
    #[test]
    fn schema_2_report_is_read() {
        let report = Report { bottlenecks: None, ..samples::costed() };
        let keys = [
            ("write_tail", "drain"),
            ("lookups", "look_ups"),
            ("turnarounds", "turn_arounds"),
            ("description", "about"),
            ("non_pixel", "elsewhere"),
            ("unattributed", "nobody"),
            ("breakdown", "spent"),
        ];
        let mut text = report.to_json().unwrap().replace(SCHEMA, SCHEMA_2).replace("utilization", "utilisation");
        for (new, old) in keys {
            assert!(text.contains(&format!("\"{new}\"")), "{new}");
            text = text.replace(&format!("\"{new}\""), &format!("\"{old}\""));
        }
        assert_eq!(Report::from_json(&text).unwrap(), report);
        let limits = r#"[{"resource": "a", "what": "a cycle per step", "set": [], "cycles": 3, "saved": 1},
            {"resource": "a", "what": "no latency", "set": ["memory.a.cl=0"], "cycles": 3, "saved": 1}]"#;
        let text = text.replacen("\"figures\"", &format!("\"limits\": {limits}, \"figures\""), 1);
        let single = Report::from_json(&text).unwrap().bottlenecks.unwrap().single;
        assert_eq!([&*single[0].resource, &*single[0].what], ["a", FULLY_PIPELINED]);
        assert_eq!([&*single[1].resource, &*single[1].what], ["memory.a", "zero latency"]);
    }

    #[test]
    fn a_functional_report_has_no_time() {
        let json = serde_json::to_value(samples::functional()).unwrap();
        for part in ["cycles", "units", "fifos", "memories", "caches", "host"] {
            assert!(json.get(part).is_none(), "{part}");
        }
    }

    #[test]
    fn invalid_report_error_names_place() {
        let says = |text: &str, part: &str| {
            let message = Report::from_json(text).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        };
        says("", "line 1, column 0: the text ends within a value");
        says("[[", "at `.`: line 1, column 0: a list stands here, expected an object");
        let good = samples::balanced().to_json().unwrap();
        says(&good.replace(SCHEMA, "basrelief-report/9"), "`basrelief-report/9`");
        says(&good.replacen("\"total\": 1", "\"total\": -1", 1), "at `cycles.total`: line ");
        says(&good.replacen("\"total\": 1", "\"total\": -1", 1), "the number -1");
        says(&format!("{good} x"), "trailing");
    }
}
