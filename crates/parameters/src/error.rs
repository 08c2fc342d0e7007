//! Errors of configurations.

/// What is wrong with a configuration, where, and what to write instead.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The text is no TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// No parameter has this name.
    #[error("unknown parameter `{key}`{} (`basrelief describe` lists all)", hint(nearest))]
    Unknown {
        /// As given.
        key: String,
        /// The nearest known name, if any is near.
        nearest: Option<String>,
    },
    /// The value has the wrong type.
    #[error("`{key}`: {message}")]
    Type {
        /// Dotted name.
        key: String,
        /// What was expected.
        message: String,
    },
    /// The value is out of range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Other parameters do not follow from this one as the rest stands.
    #[error("`{key}`: {message}")]
    Unfit {
        /// Dotted name.
        key: String,
        /// What is wrong, what was expected, what to do.
        message: String,
    },
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// A value outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` is {value}, expected {expected}")]
pub struct RangeError {
    /// Dotted name.
    pub key: String,
    /// What was given.
    pub value: String,
    /// What is allowed.
    pub expected: String,
}
