//! Errors of configurations.

/// An error in a configuration: its place and its cure.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The text is not valid TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// No parameter has this name.
    #[error("unknown parameter `{key}`{} (`basrelief describe` lists all)", hint(nearest))]
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

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// A value outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{key}` is {value}, expected {expected}")]
pub struct RangeError {
    /// Dotted name.
    pub key: String,
    /// The given value.
    pub value: String,
    /// The allowed values.
    pub expected: String,
}
