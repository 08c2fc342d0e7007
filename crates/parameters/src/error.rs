//! Errors of configurations.

/// An error in a configuration: its place and its cure.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The text is not valid TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// The text begins as JSON, and is not valid JSON.
    #[error("not valid JSON: {0}")]
    Json(String),
    /// No parameter has this name.
    #[error("unknown parameter `{key}`{} (`basrelief describe MACHINE` lists all)", hint(nearest))]
    Unknown {
        /// The name as given.
        key: String,
        /// The nearest known name, if there is one.
        nearest: Option<String>,
    },
    /// The value has the wrong type.
    #[error("`{key}`: {message}")]
    Type {
        /// Dotted name.
        key: String,
        /// The expected values.
        message: String,
    },
    /// The value is out of range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Dependent parameters cannot follow from this parameter and the others.
    #[error("`{key}`: {message}")]
    Unfit {
        /// Dotted name.
        key: String,
        /// The error, the expectation and the cure.
        message: String,
    },
}

impl ConfigError {
    /// Returns the dotted name of the parameter at fault. A text that is not valid TOML or JSON has none.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Syntax(_) | Self::Json(_) => None,
            Self::Unknown { key, .. } | Self::Type { key, .. } | Self::Unfit { key, .. } => Some(key),
            Self::Range(error) => Some(&error.key),
        }
    }
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// Maximum number of characters of a value in a message. A list can be as long as the file.
const LONGEST_VALUE: usize = 80;

fn shortened(value: &str) -> String {
    match value.char_indices().nth(LONGEST_VALUE) {
        Some((end, _)) => format!("{}... ({} characters)", &value[..end], value.chars().count()),
        None => value.into(),
    }
}

/// Returns the allowed values with their unit, which belongs to the numbers before a comma: `1..=64 bytes, or a list of these`.
pub(crate) fn allowed(range: &str, unit: &str) -> String {
    let (numbers, others) = range.split_at(range.find(", ").unwrap_or(range.len()));
    format!("{numbers} {unit}").trim_end().to_owned() + others
}

/// A value outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` is {}, expected {expected}", shortened(value))]
pub struct RangeError {
    /// Dotted name.
    pub key: String,
    /// The given value.
    pub value: String,
    /// The allowed values.
    pub expected: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_value_is_shortened_in_message() {
        let error = |value: String| RangeError { key: "a".into(), value, expected: "1..=8".into() }.to_string();
        assert_eq!(error("[1, 9]".into()), "`a` is [1, 9], expected 1..=8");
        let long = error(format!("[{}1]", "1,".repeat(100_000)));
        assert!(long.starts_with("`a` is [1,1") && long.ends_with("1... (200003 characters), expected 1..=8"), "{long}");
        assert!(long.len() < 200, "{}", long.len());
    }
}
