//! Text of a configuration file.

use crate::MachineInfo;
use crate::memories::MemoryNumbers;
use basrelief_kernel::MemoryConfig;
use basrelief_parameters::{ConfigError, ReportConfig, TomlFault};
use serde_json::Value;

impl MachineInfo {
    /// Returns the text of a configuration file: the `config` of a report, or the text itself. Numbers of memory parts in a report
    /// follow another part. `choice` as in [`explain`](Self::explain).
    ///
    /// # Errors
    /// A report of another machine, and JSON that is not valid.
    pub fn config_text(&self, text: String, choice: impl Fn(&str) -> String) -> Result<String, String> {
        let with_line = |error: ConfigError| TomlFault::of_parameter(error.key(), error.to_string()).at_line(&text);
        match ReportConfig::of(&text).map_err(with_line)? {
            None => Ok(text),
            Some(config) if config.machine == self.name => Ok(self.without_part_numbers(&config.text).unwrap_or(config.text)),
            Some(ReportConfig { machine, .. }) => {
                Err(format!("is a report of machine `{machine}`, and this is `{}`; {}", self.name, choice(&machine)))
            }
        }
    }

    /// Returns the configuration of a report without the numbers that its memory parts set at its clock, so that they follow another part
    /// and another clock. Returns `None` if that changes the configuration, and if it is not valid: then errors name lines of the report.
    fn without_part_numbers(&self, text: &str) -> Option<String> {
        let whole = self.load(text, &[]).ok()?.to_value();
        let hz = whole["clock"]["hz"].as_u64()?;
        let mut rest: Value = serde_json::from_str(text).ok()?;
        for (name, memory) in rest.get_mut("memory")?.as_object_mut()? {
            let config: MemoryConfig = serde_json::from_value(whole["memory"][name].clone()).ok()?;
            let numbers = MemoryNumbers::new(&config, hz, config.part);
            memory.as_object_mut()?.retain(|field, value| numbers.value_of_part(field).is_none_or(|of_part| *value != of_part));
        }
        let short = rest.to_string();
        (self.load(&short, &[]).ok()?.to_value() == whole).then_some(short)
    }
}
