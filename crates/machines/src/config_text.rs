//! Text of a configuration file.

use crate::MachineInfo;
use basrelief_parameters::{ConfigError, ReportConfig, TomlFault};

impl MachineInfo {
    /// Returns the text of a configuration file: the `config` of a report, or the text itself. `choice` as in
    /// [`explain`](Self::explain).
    ///
    /// # Errors
    /// A report of another machine, and JSON that is not valid.
    pub fn config_text(&self, text: String, choice: impl Fn(&str) -> String) -> Result<String, String> {
        let with_line = |error: ConfigError| TomlFault::of_parameter(error.key(), error.to_string()).at_line(&text);
        match ReportConfig::of(&text).map_err(with_line)? {
            None => Ok(text),
            Some(config) if config.machine == self.name => Ok(config.text),
            Some(ReportConfig { machine, .. }) => {
                Err(format!("is a report of machine `{machine}`, and this is `{}`; {}", self.name, choice(&machine)))
            }
        }
    }
}
