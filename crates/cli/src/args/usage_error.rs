//! Cures in the usage errors of the option parser.

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Reason why `--functional` excludes other options.
const NO_TIMING: &str = "functional mode has no timing; remove `--functional` or the other option";

/// Replaces the tips of a usage error by a cure. The parser suggests to pass an unknown long option as a value, which no command expects.
pub fn with_cure(mut error: clap::Error) -> clap::Error {
    match error.kind() {
        ErrorKind::UnknownArgument => {
            if let Some(ContextValue::StyledStrs(mut tips)) = error.remove(ContextKind::Suggested) {
                tips.retain(|tip| !tip.to_string().contains("'-- --"));
                if !tips.is_empty() {
                    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
                }
            }
        }
        ErrorKind::ArgumentConflict if names_functional_mode(&error) => {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(NO_TIMING)]));
        }
        _ => {}
    }
    error
}

fn names_functional_mode(error: &clap::Error) -> bool {
    error.context().any(|(kind, value)| match (kind, value) {
        (ContextKind::InvalidArg | ContextKind::PriorArg, ContextValue::String(text)) => text == "--functional",
        (ContextKind::PriorArg, ContextValue::Strings(all)) => all.iter().any(|text| text == "--functional"),
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use crate::args::command;

    fn error(line: &str) -> String {
        let words = ["basrelief"].into_iter().chain(line.split(' '));
        super::with_cure(command().try_get_matches_from(words).unwrap_err()).to_string()
    }

    #[test]
    fn functional_mode_refuses_timing_options_with_reason() {
        for option in ["--costs", "--bottlenecks", "--max-cycles 5", "--engine timed", "--sensitivity"] {
            for line in [format!("demo --functional {option}"), format!("demo {option} --functional")] {
                let error = error(&line);
                assert!(error.contains("cannot be used with") && error.contains(super::NO_TIMING), "{line}: {error}");
            }
        }
        let other = error("demo --bottlenecks --no-bottlenecks");
        assert!(!other.contains(super::NO_TIMING), "{other}");
    }

    #[test]
    fn unknown_option_has_no_misleading_tip() {
        let unknown = error("resimulate out --machine shade");
        assert!(unknown.contains("unexpected argument '--machine' found") && !unknown.contains("'-- --machine'"), "{unknown}");
        let near = error("demo --costt");
        assert!(near.contains("'--costs'"), "{near}");
    }
}
