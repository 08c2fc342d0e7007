//! The machines by name, and the configuration of any of them.

use crate::device::Device;
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::{FrontConfig, UnitInfo};
use basrelief_parameters::{ConfigError, Parameter};
use serde_json::Value;

/// The configuration of any machine.
#[derive(Clone, Debug, PartialEq)]
pub enum MachineConfig {
    /// The quantized bump-mapping processor.
    Bump(BumpProcessorConfig),
}

impl Default for MachineConfig {
    fn default() -> Self {
        Self::Bump(BumpProcessorConfig::default())
    }
}

impl From<BumpProcessorConfig> for MachineConfig {
    fn from(config: BumpProcessorConfig) -> Self {
        Self::Bump(config)
    }
}

/// Does the same for whichever machine is configured: `for_device!(config, device => expression)`.
macro_rules! for_device {
    ($config:expr, $device:ident => $body:expr) => {
        match $config {
            $crate::machine::MachineConfig::Bump($device) => $body,
        }
    };
}
pub(crate) use for_device;

impl MachineConfig {
    /// The machine.
    pub fn machine(&self) -> &'static MachineInfo {
        fn info<D: Device>(_: &D) -> &'static MachineInfo
        where
            MachineConfig: From<D>,
        {
            const { &MachineInfo::of::<D>() }
        }
        for_device!(self, device => info(device))
    }

    /// All parameters, in groups as in TOML.
    pub fn to_value(&self) -> Value {
        for_device!(self, device => serde_json::to_value(device)).unwrap_or_default()
    }

    pub(crate) fn front(&self) -> FrontConfig {
        for_device!(self, device => device.front())
    }
}

/// What there is to know of a machine before it runs.
#[derive(Clone, Copy, Debug)]
pub struct MachineInfo {
    /// As `--machine` names it.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// The patent's block diagram in characters.
    pub diagram: &'static str,
    /// The boxes of the block diagram.
    pub units: &'static [UnitInfo],
    /// The demo scenes that are made for it; the first is drawn where none is named.
    pub demos: &'static [&'static str],
    table: fn() -> Vec<Parameter>,
    schema: fn() -> Value,
    load: Load,
}

/// Makes a configuration of TOML and single settings.
type Load = fn(&str, &[(&str, &str)]) -> Result<MachineConfig, ConfigError>;

/// All machines, the default one first.
pub const MACHINES: &[MachineInfo] = &[MachineInfo::of::<BumpProcessorConfig>()];

impl MachineInfo {
    const fn of<D: Device>() -> Self
    where
        MachineConfig: From<D>,
    {
        Self {
            name: D::NAME,
            about: D::ABOUT,
            diagram: D::DIAGRAM,
            units: D::UNITS,
            demos: D::DEMOS,
            table: D::table,
            schema: || schemars::schema_for!(D).to_value(),
            load: |toml, settings| basrelief_parameters::load::<D>(toml, settings).map(MachineConfig::from),
        }
    }

    /// The machine of this name.
    ///
    /// # Errors
    /// A sentence with the names that there are.
    pub fn named(name: &str) -> Result<&'static Self, String> {
        MACHINES.iter().find(|m| m.name == name).ok_or_else(|| {
            let names: Vec<&str> = MACHINES.iter().map(|m| m.name).collect();
            format!("no machine is called `{name}`; expected {}", names.join(", "))
        })
    }

    /// All parameters, in the order of the block diagram.
    pub fn parameters(&self) -> Vec<Parameter> {
        (self.table)()
    }

    /// JSON schema of the configuration.
    pub fn schema(&self) -> Value {
        (self.schema)()
    }

    /// A configuration: defaults, then the TOML text, then single settings in order.
    ///
    /// # Errors
    /// As [`basrelief_parameters::load`].
    pub fn load(&self, toml: &str, settings: &[(&str, &str)]) -> Result<MachineConfig, ConfigError> {
        (self.load)(toml, settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_scene::DEMOS;

    #[test]
    fn no_demo_is_made_for_two_machines() {
        let made_for: Vec<&str> = MACHINES.iter().flat_map(|m| m.demos).copied().collect();
        for name in &made_for {
            assert_eq!(made_for.iter().filter(|n| n == &name).count(), 1, "{name}");
            assert!(DEMOS.iter().any(|d| d.name == *name), "{name}");
        }
    }

    #[test]
    fn a_machine_is_found_by_its_name_and_configures_itself() {
        for machine in MACHINES {
            let config = MachineInfo::named(machine.name).unwrap().load("", &[]).unwrap();
            assert_eq!(config.machine().name, machine.name);
            let first = &machine.parameters()[0];
            assert_eq!(config.to_value().pointer(&format!("/{}", first.key.replace('.', "/"))), Some(&first.default));
        }
        assert_eq!(MachineConfig::default().machine().name, MACHINES[0].name);
        assert!(MachineInfo::named("lathe").unwrap_err().contains("expected bump"));
    }
}
