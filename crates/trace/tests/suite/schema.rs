//! The published schema matches the written lines.

use crate::common::*;
use basrelief_trace::{TraceForm, schema};
use proptest::prelude::*;

fn validator() -> jsonschema::Validator {
    jsonschema::validator_for(&schema()).unwrap()
}

#[test]
fn sample_lines_match_schema() {
    let validator = validator();
    for line in SAMPLE.lines() {
        let value = serde_json::from_str(line).unwrap();
        assert!(validator.is_valid(&value), "{line}: {:?}", validator.iter_errors(&value).collect::<Vec<_>>());
    }
}

#[test]
fn schema_has_all_commands_and_refuses_others() {
    let validator = validator();
    let text = schema().to_string();
    for name in basrelief_trace::TraceCommand::NAMES {
        assert!(text.contains(&format!("\"{name}\"")), "{name}");
    }
    for line in [r#"{"frame_end":{"x":1}}"#, r#"{"colour":{}}"#, r#"{"end":{}}"#, "{}"] {
        assert!(!validator.is_valid(&serde_json::from_str(line).unwrap()), "{line}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn recorded_lines_match_schema(controls in controls()) {
        let validator = validator();
        for line in String::from_utf8(record(&controls, TraceForm::default()).unwrap()).unwrap().lines() {
            prop_assert!(validator.is_valid(&serde_json::from_str(line).unwrap()), "{}", line);
        }
    }
}
