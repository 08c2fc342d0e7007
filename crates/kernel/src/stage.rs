//! Stages: units with their names.

use crate::Unit;

/// A unit together with its name. The engine keeps the account of its cycles.
#[derive(Clone, Debug)]
pub struct Stage<U> {
    name: String,
    /// The unit; its state may be read between runs.
    pub unit: U,
    ideal: bool,
}

impl<U: Unit> Stage<U> {
    /// Creates a stage from a unit and its name in the block diagram.
    pub fn new(name: &str, unit: U) -> Self {
        Self { name: name.into(), unit, ideal: false }
    }

    /// Makes the unit fully pipelined (occupancy 1), for a relaxation. Each step delivers as much earlier as its occupancy
    /// shrinks. Its memory requests stay the same.
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
