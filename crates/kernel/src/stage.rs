//! A unit in its place.

use crate::Unit;

/// A unit together with its name. Where its cycles go is kept by the engine.
#[derive(Clone, Debug)]
pub struct Stage<U> {
    name: String,
    /// The unit; its state may be read between runs.
    pub unit: U,
    ideal: bool,
}

impl<U: Unit> Stage<U> {
    /// A unit under the name it has in the block diagram.
    pub fn new(name: &str, unit: U) -> Self {
        Self { name: name.into(), unit, ideal: false }
    }

    /// Makes it ideal: every step keeps the unit for one cycle, and delivers as much earlier as it keeps it shorter. What it asks of
    /// memories stays.
    pub fn make_ideal(&mut self) {
        self.ideal = true;
    }

    pub(crate) fn is_ideal(&self) -> bool {
        self.ideal
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }
}
