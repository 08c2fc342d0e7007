//! A machine with its parameters.

use crate::error::{CommandError, PythonResult, budget};
use basrelief_input::MemoryPool;
use basrelief_sim::{MachineConfig, MachineInfo, Overrides, OverridesError};
use pyo3::{pyclass, pymethods};

/// A machine with a consistent set of parameters.
#[pyclass(frozen, module = "basrelief._basrelief")]
pub struct Config {
    pub config: MachineConfig,
    pub given: Overrides,
}

#[pymethods]
impl Config {
    /// Makes a configuration from the defaults, the text of the file `name`, and single settings, in this order.
    #[new]
    fn new(machine: &str, file: (String, String), settings: Vec<(String, String)>) -> PythonResult<Self> {
        let (file, text) = file;
        let machine = MachineInfo::named(machine).map_err(CommandError::usage)?;
        let in_place = |wrong| match wrong {
            OverridesError::File(error) => CommandError::in_input(&file)(error),
            OverridesError::Settings(error) => CommandError::usage(error),
        };
        let given = Overrides::of_file(machine, text, settings).map_err(in_place)?;
        let config = given.load_checked(machine, &budget(MemoryPool::DEFAULT)).map_err(in_place)?;
        Ok(Self { config, given })
    }

    /// Returns all parameters with every fact about them, as `basrelief describe --json` prints them.
    fn described(&self) -> PythonResult<String> {
        Ok(serde_json::to_string(&self.config.described()).map_err(CommandError::bad_input)?)
    }
}
