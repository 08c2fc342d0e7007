//! The machines by name, and the configuration of any machine. To add a machine, add a line to the list in this file and a folder
//! with its [`MachineSpec`].

use crate::bump::BumpProcessorConfig;
use crate::configuration_schema::with_ranges;
use crate::defer::DeferConfig;
use crate::front::FrontConfig;
use crate::problem::ConfigProblem;
use crate::shade::ShadeConfig;
use crate::spec::{CostPoints, MachineSpec, Shortcut, TileFetch, empty_machine};
use crate::texel::TexelMachineConfig;
use crate::unit_info::UnitInfo;
use basrelief_deferred_renderer::PicturePreview;
use basrelief_kernel::{AreaModel, Hardware, Machine as _};
use basrelief_parameters::{ConfigError, Loader, Parameter, resolved, to_json};
use basrelief_signals::schema_of;
use serde_json::Value;
use std::any::Any;
use std::fmt;

/// Declares the machines: the enum [`MachineConfig`], the list [`MACHINES`], and the macro `for_machine!(config, spec => expression)`,
/// which evaluates an expression for the configured machine. (`$` is an argument because a macro cannot write it into the macro
/// that it declares.)
macro_rules! machines {
    ($d:tt $($(#[$about:meta])+ $machine:ident($config:ty),)+) => {
        /// Configuration of any machine.
        #[derive(Clone, Debug, PartialEq)]
        pub enum MachineConfig {
            $($(#[$about])+ $machine($config),)+
        }

        $(impl From<$config> for MachineConfig {
            fn from(config: $config) -> Self {
                Self::$machine(config)
            }
        })+

        /// All machines, the default machine first.
        // A constant would be instantiated in every crate that names it, with all functions that it refers to.
        pub static MACHINES: &[MachineInfo] = &[$(MachineInfo::of::<$config>()),+];

        /// Evaluates an expression for the configured machine: `for_machine!(config, spec => expression)`.
        #[macro_export]
        macro_rules! for_machine {
            ($d config:expr, $d machine:ident => $d body:expr) => {
                match $d config {
                    $($d crate::MachineConfig::$machine($d machine) => $d body,)+
                }
            };
        }
    };
}

machines! { $
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
        BumpProcessorConfig::default().into()
    }
}

impl MachineConfig {
    /// Returns the machine.
    // Inlined in another crate, it would be compiled there with all functions that it refers to.
    #[inline(never)]
    pub fn machine(&self) -> &'static MachineInfo {
        fn info<S: MachineSpec>(_: &S) -> &'static MachineInfo
        where
            MachineConfig: From<S>,
        {
            const { &MachineInfo::of::<S>() }
        }
        for_machine!(self, machine => info(machine))
    }

    /// Returns the configuration of machine `S`; `None` for another machine.
    pub fn spec<S: MachineSpec>(&self) -> Option<&S> {
        for_machine!(self, machine => (machine as &dyn Any).downcast_ref())
    }

    /// Returns true if the user leaves views at given times, so that the work depends on the timing.
    pub fn acts_at_times(&self) -> bool {
        for_machine!(self, machine => machine.acts_at_times())
    }

    /// Returns all parameters, in groups as in TOML.
    pub fn to_value(&self) -> Value {
        for_machine!(self, machine => to_json(machine)).unwrap_or_default()
    }

    /// Returns all parameters with their values and provenance, in the order of the block diagram.
    pub fn parameters(&self) -> Vec<Parameter> {
        for_machine!(self, machine => resolved(machine))
    }

    /// Checks that the parameters fit together.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn check(&self) -> Result<(), ConfigProblem> {
        for_machine!(self, spec => empty_machine(spec).map(|_| ()))
    }

    /// Returns the names of the memories, by number, each with its burst size \[bytes\].
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn memories(&self) -> Result<Vec<(String, u32)>, ConfigProblem> {
        for_machine!(self, spec => {
            let mut machine = empty_machine(spec)?;
            Ok(machine.memories().names_and_bursts().map(|(name, bytes)| (name.to_owned(), bytes)).collect())
        })
    }

    /// Returns the hardware, unit by unit, each unit before its output FIFOs; then caches and ports.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    pub fn hardware(&self) -> Result<Vec<Hardware>, ConfigProblem> {
        for_machine!(self, machine => machine.hardware())
    }

    /// Returns the data that give the area of the hardware.
    pub fn area_model(&self) -> AreaModel {
        for_machine!(self, machine => machine.area_model())
    }

    /// Returns the variants of an ablation: the configured machine, the machine without each short cut, and without all short cuts.
    /// Empty if the machine has no short cuts.
    pub fn ablations(&self) -> Vec<(String, Self)> {
        for_machine!(self, machine => ablations(machine))
    }

    /// Returns how the machine requests tiles; `None` if it fetches none.
    pub fn tile_fetch(&self) -> Option<TileFetch> {
        for_machine!(self, machine => machine.tile_fetch())
    }

    /// Returns the colouring of partial pictures; `None` if the machine fetches no tiles.
    pub fn preview(&self) -> Option<PicturePreview> {
        for_machine!(self, machine => MachineSpec::preview(machine))
    }

    /// Returns the FIFOs at which fragments are created and finished.
    pub fn cost_points(&self) -> CostPoints {
        fn of<S: MachineSpec>(_: &S) -> CostPoints {
            S::COST_POINTS
        }
        for_machine!(self, machine => of(machine))
    }

    /// Returns the configuration of the front end.
    pub fn front(&self) -> FrontConfig {
        for_machine!(self, machine => machine.front())
    }
}

fn ablations<S: MachineSpec>(machine: &S) -> Vec<(String, MachineConfig)>
where
    MachineConfig: From<S>,
{
    if S::SHORTCUTS.is_empty() {
        return vec![];
    }
    let without = |shortcuts: &[Shortcut<S>]| {
        let mut machine = machine.clone();
        shortcuts.iter().for_each(|(_, disable)| disable(&mut machine));
        MachineConfig::from(machine)
    };
    let each = S::SHORTCUTS.iter().map(|one| (format!("without {}", one.0), without(&[*one])));
    let all = ("without any".into(), without(S::SHORTCUTS));
    std::iter::once(("as configured".into(), without(&[]))).chain(each).chain([all]).collect()
}

/// Properties of a machine that do not depend on its configuration.
#[derive(Clone, Copy, Debug)]
pub struct MachineInfo {
    /// Name, as in `--machine NAME`.
    pub name: &'static str,
    /// Description in a few words.
    pub about: &'static str,
    /// The patent's block diagram in characters.
    pub diagram: &'static str,
    /// Demo scenes made for this machine. The first one is the default.
    pub demos: &'static [&'static str],
    /// True if textures come from a server over a path.
    pub fetches_tiles: bool,
    /// Parameter with the times at which the user leaves each view.
    pub left_at: Option<&'static str>,
    /// True if the machine has methods to compare at the same error.
    pub has_methods: bool,
    /// True if it has short cuts for an ablation.
    pub has_shortcuts: bool,
    units: fn() -> Vec<UnitInfo>,
    default: fn() -> MachineConfig,
    table: fn() -> Vec<Parameter>,
    schema: fn() -> Value,
    loader: fn(&str) -> Result<ConfigLoader, ConfigError>,
}

/// Loader of many configurations that share one text.
pub struct ConfigLoader(Box<LoadFn>);

type LoadFn = dyn Fn(&[(&str, &str)]) -> Result<MachineConfig, ConfigError> + Send + Sync;

impl ConfigLoader {
    /// Returns a configuration: defaults, then the text, then these settings in order.
    ///
    /// # Errors
    /// Errors of [`basrelief_parameters::load`].
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
    const fn of<S: MachineSpec>() -> Self
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
            default: || S::default().into(),
            has_methods: S::METHODS.is_some(),
            has_shortcuts: !S::SHORTCUTS.is_empty(),
            table: || resolved(&S::default()),
            schema: || with_ranges(schema_of::<S>(&format!("config-{}", S::NAME)).to_value(), &S::table()),
            loader: |toml| {
                let loader = Loader::<S>::new(toml)?;
                Ok(ConfigLoader(Box::new(move |settings| loader.load(settings).map(MachineConfig::from))))
            },
        }
    }

    /// Returns the machine with this name.
    ///
    /// # Errors
    /// An unknown name, with the names of all machines.
    pub fn named(name: &str) -> Result<&'static Self, String> {
        MACHINES.iter().find(|m| m.name == name).ok_or_else(|| {
            let names: Vec<&str> = MACHINES.iter().map(|m| m.name).collect();
            format!("no machine is called `{name}`; expected {}", names.join(", "))
        })
    }

    /// Returns the machine that a demo scene is made for. The name may include the tessellation, as in `goblet@8`.
    pub fn of_demo(demo: &str) -> &'static Self {
        let name = demo.split('@').next().unwrap_or(demo);
        MACHINES.iter().find(|m| m.demos.contains(&name)).unwrap_or(&MACHINES[0])
    }

    /// Returns the units of the block diagram.
    pub fn units(&self) -> Vec<UnitInfo> {
        (self.units)()
    }

    /// Returns the configuration that [`MachineInfo::load`] gives without text and settings. Nothing is parsed.
    pub fn default_config(&self) -> MachineConfig {
        (self.default)()
    }

    /// Returns all parameters, in the order of the block diagram.
    pub fn parameters(&self) -> Vec<Parameter> {
        (self.table)()
    }

    /// Returns the JSON schema of the configuration.
    pub fn schema(&self) -> Value {
        (self.schema)()
    }

    /// Loads a configuration: defaults, then the text (TOML or JSON), then single settings in order.
    ///
    /// # Errors
    /// Errors of [`basrelief_parameters::load`].
    pub fn load(&self, toml: &str, settings: &[(&str, &str)]) -> Result<MachineConfig, ConfigError> {
        self.loader(toml)?.load(settings)
    }

    /// Returns a loader of many configurations that share one text.
    ///
    /// # Errors
    /// A text that is neither TOML nor JSON.
    pub fn loader(&self, toml: &str) -> Result<ConfigLoader, ConfigError> {
        (self.loader)(toml)
    }

    /// Describes an error in a configuration. An unknown parameter that another machine has is reported with that machine. `choice`
    /// returns the cure: how the user chooses the machine of this name.
    pub fn explain(&self, error: &ConfigError, choice: impl Fn(&str) -> String) -> String {
        let ConfigError::Unknown { key, .. } = error else { return error.to_string() };
        if key == "machine" {
            return format!("`{key}` is no parameter; to choose the machine, {}", choice("NAME"));
        }
        let group = format!("{key}.");
        if let Some(first) = self.parameters().iter().find(|p| p.key.starts_with(&group)) {
            return format!("`{key}` is a group of parameters; set one of them, such as `{}`", first.key);
        }
        let knows = |m: &&Self| m.parameters().iter().any(|p| p.key == *key || p.key.starts_with(&group));
        MACHINES.iter().filter(|m| m.name != self.name).find(knows).map_or_else(
            || error.to_string(),
            |other| {
                let (name, other, cure) = (self.name, other.name, choice(other.name));
                format!("`{key}` is a parameter of machine `{other}`, and this is `{name}`; {cure}")
            },
        )
    }
}
