//! Device figures: what the units of a machine counted, by name.

use serde_json::Value;

/// An ordered list of named figures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counts(Vec<(String, Value)>);

impl Counts {
    /// Adds a figure.
    pub fn add(&mut self, name: &str, value: impl Into<Value>) {
        self.0.push((name.into(), value.into()));
    }

    /// All figures, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.0.iter().map(|(n, v)| (n.as_str(), v))
    }

    /// A whole figure; 0 where there is none of this name.
    pub fn number(&self, name: &str) -> u64 {
        self.iter().find(|(n, _)| *n == name).and_then(|(_, v)| v.as_u64()).unwrap_or(0)
    }
}
