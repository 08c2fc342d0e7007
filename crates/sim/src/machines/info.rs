//! What there is to know of a machine before it runs.

use super::{MACHINES, MachineConfig, MachineSpec};
use crate::exhibits::content::ExhibitInfo;
use basrelief_machines::UnitInfo;
use basrelief_parameters::{ConfigError, Loader, Parameter, resolved};
use serde_json::Value;
use std::fmt;

/// What there is to know of a machine before it runs.
#[derive(Clone, Copy, Debug)]
pub struct MachineInfo {
    /// As `--machine` names it.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// The patent's block diagram in characters.
    pub diagram: &'static str,
    /// The demo scenes that are made for it; the first is drawn where none is named.
    pub demos: &'static [&'static str],
    /// Its textures come over a path, from a server that may be elsewhere.
    pub fetches_tiles: bool,
    /// The parameter that says when views are left for the next, where there is one.
    pub left_at: Option<&'static str>,
    /// It has methods to compare at the same error.
    pub has_methods: bool,
    units: fn() -> Vec<UnitInfo>,
    exhibits: fn() -> Vec<ExhibitInfo>,
    table: fn() -> Vec<Parameter>,
    schema: fn() -> Value,
    loader: fn(&str) -> Result<ConfigLoader, ConfigError>,
}

/// Makes configurations of a machine, of one TOML text and settings over it.
pub struct ConfigLoader(Box<Load>);

type Load = dyn Fn(&[(&str, &str)]) -> Result<MachineConfig, ConfigError> + Send + Sync;

impl ConfigLoader {
    /// A configuration: defaults, then the text, then these settings in order.
    ///
    /// # Errors
    /// As [`basrelief_parameters::load`].
    pub fn load(&self, settings: &[(&str, &str)]) -> Result<MachineConfig, ConfigError> {
        (self.0)(settings)
    }
}

impl fmt::Debug for ConfigLoader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ConfigLoader")
    }
}

impl MachineInfo {
    pub(super) const fn of<S: MachineSpec>() -> Self
    where
        MachineConfig: From<S>,
    {
        Self {
            name: S::NAME,
            about: S::ABOUT,
            diagram: S::DIAGRAM,
            units: S::units,
            demos: S::DEMOS,
            fetches_tiles: S::FETCHES_TILES,
            left_at: S::LEFT_AT,
            has_methods: S::METHODS.is_some(),
            exhibits: || S::EXHIBITS.iter().map(|e| e.info).collect(),
            table: || resolved(&S::default()),
            schema: || schemars::schema_for!(S).to_value(),
            loader: |toml| {
                let loader = Loader::<S>::new(toml)?;
                Ok(ConfigLoader(Box::new(move |settings| loader.load(settings).map(MachineConfig::from))))
            },
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

    /// The machine that a demo scene is made for, by the name of the demo, with its tessellation or not.
    pub fn of_demo(demo: &str) -> &'static Self {
        let name = demo.split('@').next().unwrap_or(demo);
        MACHINES.iter().find(|m| m.demos.contains(&name)).unwrap_or(&MACHINES[0])
    }

    /// The boxes of the block diagram.
    pub fn units(&self) -> Vec<UnitInfo> {
        (self.units)()
    }

    /// What it shows beside its finished pictures.
    pub fn exhibits(&self) -> Vec<ExhibitInfo> {
        (self.exhibits)()
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
        self.loader(toml)?.load(settings)
    }

    /// What makes many configurations of one TOML text.
    ///
    /// # Errors
    /// A text that is no TOML.
    pub fn loader(&self, toml: &str) -> Result<ConfigLoader, ConfigError> {
        (self.loader)(toml)
    }

    /// What is wrong with a configuration. A parameter of another machine is no slip of the pen.
    pub fn explain(&self, error: &ConfigError) -> String {
        let ConfigError::Unknown { key, .. } = error else { return error.to_string() };
        let group = format!("{key}.");
        if let Some(first) = self.parameters().iter().find(|p| p.key.starts_with(&group)) {
            return format!("`{key}` is a group of parameters; set one of them, such as `{}`", first.key);
        }
        let knows = |m: &&Self| m.parameters().iter().any(|p| p.key == *key || p.key.starts_with(&group));
        MACHINES.iter().filter(|m| m.name != self.name).find(knows).map_or_else(
            || error.to_string(),
            |other| {
                let (name, other) = (self.name, other.name);
                format!("`{key}` is a parameter of machine `{other}`, and this is `{name}`; --machine {other} takes that one")
            },
        )
    }
}
