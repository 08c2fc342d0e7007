//! A machine with its parameters.

use crate::error::{Done, bad, budget, usage, within};
use basrelief_input::Budget;
use basrelief_sim::{MachineConfig, MachineInfo, Overrides, OverridesError};
use pyo3::{pyclass, pymethods};

/// A machine with its parameters, which fit together.
#[pyclass(frozen, module = "basrelief._basrelief")]
pub struct Config {
    pub config: MachineConfig,
    pub given: Overrides,
}

#[pymethods]
impl Config {
    /// The machine of this name with defaults, then the TOML text of a file of this name, then single settings.
    #[new]
    fn new(machine: &str, file: (String, String), settings: Vec<(String, String)>) -> Done<Self> {
        let (file, toml) = file;
        let machine = MachineInfo::named(machine).map_err(usage)?;
        let given = Overrides { toml, settings };
        let config = given.checked(machine, &budget(Budget::DEFAULT)).map_err(|wrong| match wrong {
            OverridesError::File(error) => within(&file)(error),
            OverridesError::Settings(error) => usage(error),
        })?;
        Ok(Self { config, given })
    }

    /// All parameters with every fact about them, as `basrelief describe --json` prints them.
    fn described(&self) -> Done<String> {
        serde_json::to_string(&self.config.described()).map_err(bad)
    }
}
