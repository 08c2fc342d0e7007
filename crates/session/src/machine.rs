//! The machines by name, and the configuration of any of them.

use crate::device::{Device, ShortCut};
use basrelief_deferred_renderer::RenderMode;
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::defer::DeferConfig;
use basrelief_machines::shade::ShadeConfig;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_machines::{FrontConfig, UnitInfo};
use basrelief_parameters::{ConfigError, Parameter};
use serde_json::Value;

/// The configuration of any machine.
#[derive(Clone, Debug, PartialEq)]
pub enum MachineConfig {
    /// The quantized bump-mapping processor.
    Bump(BumpProcessorConfig),
    /// The figure shading device.
    Shade(ShadeConfig),
    /// The texture mapping system.
    Texel(TexelMachineConfig),
    /// The rate-limited renderer.
    Defer(DeferConfig),
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

impl From<ShadeConfig> for MachineConfig {
    fn from(config: ShadeConfig) -> Self {
        Self::Shade(config)
    }
}

impl From<TexelMachineConfig> for MachineConfig {
    fn from(config: TexelMachineConfig) -> Self {
        Self::Texel(config)
    }
}

impl From<DeferConfig> for MachineConfig {
    fn from(config: DeferConfig) -> Self {
        Self::Defer(config)
    }
}

/// Does the same for whichever machine is configured: `for_device!(config, device => expression)`.
macro_rules! for_device {
    ($config:expr, $device:ident => $body:expr) => {
        match $config {
            $crate::machine::MachineConfig::Bump($device) => $body,
            $crate::machine::MachineConfig::Shade($device) => $body,
            $crate::machine::MachineConfig::Texel($device) => $body,
            $crate::machine::MachineConfig::Defer($device) => $body,
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

    /// The machine as it is, without each of its short cuts in turn, and without any: names and configurations. Nothing
    /// where it has none.
    pub(crate) fn ablations(&self) -> Vec<(String, Self)> {
        for_device!(self, device => ablations(device))
    }

    /// Where the machine keeps logs of its texels ([`Settings::log`](crate::Settings::log)): the error bound that its
    /// displacements are to keep \[pixels\].
    pub fn texel_error_bound(&self) -> Option<f64> {
        match self {
            Self::Texel(config) => Some(config.texel.error_bound),
            Self::Bump(_) | Self::Shade(_) | Self::Defer(_) => None,
        }
    }

    /// Whether each frame may be shown in several pictures, each better than the one before.
    pub fn shows_rounds(&self) -> bool {
        matches!(self, Self::Defer(config) if config.defer.mode == RenderMode::Progressive)
    }

    pub(crate) fn front(&self) -> FrontConfig {
        for_device!(self, device => device.front())
    }
}

fn ablations<D: Device>(device: &D) -> Vec<(String, MachineConfig)>
where
    MachineConfig: From<D>,
{
    if D::SHORT_CUTS.is_empty() {
        return vec![];
    }
    let without = |short_cuts: &[ShortCut<D>]| {
        let mut device = device.clone();
        short_cuts.iter().for_each(|(_, switch_off)| switch_off(&mut device));
        MachineConfig::from(device)
    };
    let each = D::SHORT_CUTS.iter().map(|one| (format!("without {}", one.0), without(&[*one])));
    let all = ("without any".into(), without(D::SHORT_CUTS));
    std::iter::once(("as configured".into(), without(&[]))).chain(each).chain([all]).collect()
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
pub const MACHINES: &[MachineInfo] = &[
    MachineInfo::of::<BumpProcessorConfig>(),
    MachineInfo::of::<ShadeConfig>(),
    MachineInfo::of::<TexelMachineConfig>(),
    MachineInfo::of::<DeferConfig>(),
];

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

    /// The machine that a demo scene is made for, by the name of the demo, with its tessellation or not.
    pub fn of_demo(demo: &str) -> &'static Self {
        let name = demo.split('@').next().unwrap_or(demo);
        MACHINES.iter().find(|m| m.demos.contains(&name)).unwrap_or(&MACHINES[0])
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
    fn every_demo_is_made_for_one_machine() {
        let mut made_for: Vec<&str> = MACHINES.iter().flat_map(|m| m.demos).copied().collect();
        let mut all: Vec<&str> = DEMOS.iter().map(|d| d.name).collect();
        made_for.sort_unstable();
        all.sort_unstable();
        assert_eq!(made_for, all);
        assert_eq!(MachineInfo::of_demo("goblet@8").name, "shade");
        assert_eq!(MachineInfo::of_demo("coin").name, "bump");
    }

    #[test]
    fn an_ablation_switches_off_one_short_cut_at_a_time_and_then_all() {
        let variants = MachineConfig::from(ShadeConfig::default()).ablations();
        let off = |c: &MachineConfig| {
            let MachineConfig::Shade(c) = c else { panic!("another machine") };
            let s = &c.shortcut;
            [!s.specular_negligible.enabled, !s.flatness.enabled, !s.same_plane.enabled]
        };
        let switched: Vec<[bool; 3]> = variants.iter().map(|(_, c)| off(c)).collect();
        assert_eq!(switched, [[false; 3], [true, false, false], [false, true, false], [false, false, true], [true; 3]]);
        assert_eq!(variants[0].0, "as configured");
        assert!(MachineConfig::default().ablations().is_empty());
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
        assert!(MachineInfo::named("lathe").unwrap_err().contains("expected bump, shade, texel, defer"));
    }
}
