//! Parameters as they were given, checked: what is wrong with them, and where.

use crate::machines::{MachineConfig, MachineInfo};
use crate::tape::Given;
use basrelief_input::Budget;
use basrelief_parameters::ConfigError;

/// What a TOML text takes when it is read, at most: short keys with short values do \[times its length\].
pub const TOML_GROWTH: u64 = 200;

/// What is wrong with parameters, in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Misconfigured {
    /// The file.
    File(String),
    /// The single settings.
    Settings(String),
}

impl Given {
    /// The machine's configuration that these come to: defaults, then the file, then single settings; and that it fits together.
    ///
    /// # Errors
    /// What the machine has not, or cannot be, and which of the two says so.
    pub fn checked(&self, machine: &MachineInfo, budget: &Budget) -> Result<MachineConfig, Misconfigured> {
        let growth = budget.take(TOML_GROWTH * self.toml.len() as u64, "what a configuration says");
        let _growth = growth.map_err(|error| Misconfigured::File(error.to_string()))?;
        // Single settings may mend what does not fit together in the file, or the other way round.
        let file_fits = match machine.load(&self.toml, &[]) {
            Err(ConfigError::Unfit { .. }) => false,
            Err(error) => return Err(Misconfigured::File(machine.explain(&error))),
            Ok(config) => config.check().is_ok(),
        };
        let blame = |error: String| if file_fits { Misconfigured::Settings(error) } else { Misconfigured::File(error) };
        let single: Vec<(&str, &str)> = self.settings.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        let config = machine.load(&self.toml, &single).map_err(|error| match &error {
            ConfigError::Unfit { .. } => blame(error.to_string()),
            _ => Misconfigured::Settings(machine.explain(&error)),
        })?;
        config.check().map_err(|problem| blame(problem.to_string()))?;
        Ok(config)
    }
}
