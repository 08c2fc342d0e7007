//! A unit in its place.

use crate::Unit;

/// A unit together with its name. Where its cycles go is kept by the engine.
#[derive(Clone, Debug)]
pub struct Stage<U> {
    name: String,
    /// The unit; its state may be read between runs.
    pub unit: U,
}

impl<U: Unit> Stage<U> {
    /// A unit under the name it has in the block diagram.
    pub fn new(name: &str, unit: U) -> Self {
        Self { name: name.into(), unit }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }
}
