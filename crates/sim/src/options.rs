//! Input and options of a run.

use crate::outputs::aux_output::AuxOutputInfo;
use crate::prepared::PreparedScene;
use basrelief_deferred_renderer::TileSource;
use basrelief_input::MemoryPool;
use basrelief_kernel::Engine;
use basrelief_machines::{InputKind, MachineConfig, MachineInfo};
use basrelief_parameters::{ConfigError, Loader, Parameters, TomlFault};
use basrelief_trace::{NoFiles, TextureFiles};
use serde::{Deserialize, Serialize};
use std::io::Read;

/// Input of a run.
pub enum RunInput {
    /// A scene, through the geometry processor.
    Scene(PreparedScene),
    /// A trace in any form, read once, as a stream.
    Trace {
        /// Bytes of the trace.
        reader: Box<dyn Read>,
        /// Files that the trace refers to.
        files: Box<dyn TextureFiles>,
        /// Name for messages. The report contains it without its folders.
        name: String,
    },
    /// A scene whose texels are [on a server](basrelief_signals::Texture::elsewhere), for a machine that fetches tiles. It passes
    /// through the geometry processor. No reference image is drawn.
    Remote {
        /// The scene.
        scene: PreparedScene,
        /// Tiles of the server.
        tiles: Box<dyn TileSource>,
        /// Origin of the scene, for messages.
        name: String,
    },
}

impl RunInput {
    /// Returns the name that the user gave.
    pub fn name(&self) -> &str {
        match self {
            Self::Scene(prepared) => &prepared.scene().name,
            Self::Trace { name, .. } | Self::Remote { name, .. } => name,
        }
    }

    /// Creates an input from a scene.
    pub fn scene(scene: impl Into<PreparedScene>) -> Self {
        Self::Scene(scene.into())
    }

    /// Creates an input from a trace that refers to no other files.
    pub fn trace(reader: impl Read + 'static, name: &str) -> Self {
        Self::Trace { reader: Box::new(reader), files: Box::new(NoFiles), name: name.into() }
    }

    /// Returns the kind of input.
    pub(crate) fn kind(&self) -> InputKind {
        match self {
            Self::Scene(_) | Self::Remote { .. } => InputKind::Scene,
            Self::Trace { .. } => InputKind::Trace,
        }
    }
}

/// Runs that are analysed. The cost of an analysis grows with the number of recorded steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AnalysisPolicy {
    /// None.
    #[default]
    Never,
    /// Runs so short that some twenty resimulations take no longer than pictures and metrics.
    IfShort,
    /// All runs.
    Always,
}

/// Parameters that the user gave, over the defaults.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Overrides {
    /// Text of a file of parameters: TOML, or an object in JSON.
    pub toml: String,
    /// Single settings, applied after the file.
    pub settings: Vec<(String, String)>,
}

impl Overrides {
    /// Creates overrides from the text of a file and from single settings. The text of a report stands for its `config`.
    ///
    /// # Errors
    /// A report of another machine, and JSON that is not valid.
    pub fn of_file(machine: &MachineInfo, text: String, settings: Vec<(String, String)>) -> Result<Self, OverridesError> {
        let text = machine.config_text(text, machine_option);
        Ok(Self { toml: text.map_err(OverridesError::File)?, settings })
    }

    /// Returns the machine's configuration with these overrides, then with `more` settings.
    ///
    /// # Errors
    /// Unknown parameters, and values out of range.
    pub fn config(&self, machine: &MachineInfo, more: &[(String, String)]) -> Result<MachineConfig, ConfigError> {
        machine.load(&self.toml, &self.with_overrides(more))
    }

    /// Returns a loader of configurations of type `C` with these overrides.
    pub(crate) fn loader<C: Parameters>(&self) -> Result<OverridesLoader<'_, C>, ConfigError> {
        Ok(OverridesLoader { overrides: self, loader: Loader::new(&self.toml)? })
    }

    /// Returns true if the user gave this parameter.
    pub(crate) fn contains(&self, key: &str) -> bool {
        basrelief_parameters::is_given(&self.toml, &self.settings, key)
    }

    fn with_overrides<'a>(&'a self, more: &'a [(String, String)]) -> Vec<(&'a str, &'a str)> {
        self.settings.iter().chain(more).map(|(key, value)| (key.as_str(), value.as_str())).collect()
    }

    /// Returns the checked configuration: defaults, then the file, then single settings.
    ///
    /// # Errors
    /// Unknown parameters, values out of range, and parameters that do not fit together, with the place of the error.
    pub fn load_checked(&self, machine: &MachineInfo, budget: &MemoryPool) -> Result<MachineConfig, OverridesError> {
        let growth = budget.try_reserve(TOML_GROWTH * self.toml.len() as u64, "the values of a configuration");
        let _growth = growth.map_err(|error| OverridesError::File(error.to_string()))?;
        let explain = |error: &ConfigError| machine.explain(error, machine_option);
        // Single settings may repair a file whose parameters do not fit together, and vice versa.
        let file_fits = match machine.load(&self.toml, &[]) {
            Err(ConfigError::Unfit { .. }) => false,
            Err(error) => return Err(OverridesError::File(self.at_line(error.key(), explain(&error)))),
            Ok(config) => config.check().is_ok(),
        };
        let config = self.config(machine, &[]).map_err(|error| match &error {
            ConfigError::Unfit { .. } if !file_fits => OverridesError::File(self.at_line(error.key(), error.to_string())),
            _ => OverridesError::Settings(explain(&error)),
        })?;
        match config.check() {
            Ok(()) => Ok(config),
            Err(problem) if file_fits => Err(OverridesError::Settings(problem.to_string())),
            Err(problem) => Err(OverridesError::File(self.at_line(Some(&problem.key), problem.to_string()))),
        }
    }

    /// Returns the text of an error, after the line of its parameter in the file if the file gives it.
    fn at_line(&self, key: Option<&str>, text: String) -> String {
        TomlFault::of_parameter(key, text).at_line(&self.toml)
    }
}

/// Loader of many configurations with the same overrides. A load takes a fifth of [`Overrides::load`].
#[derive(Debug)]
pub(crate) struct OverridesLoader<'a, C> {
    overrides: &'a Overrides,
    loader: Loader<C>,
}

impl<C: Parameters> OverridesLoader<'_, C> {
    /// Returns a configuration with the overrides, then with `more` settings.
    pub(crate) fn load(&self, more: &[(String, String)]) -> Result<C, ConfigError> {
        self.loader.load(&self.overrides.with_overrides(more))
    }
}

/// Cure for parameters of another machine.
fn machine_option(name: &str) -> String {
    format!("use --machine {name}")
}

/// Upper bound of the memory that parsing a text of parameters takes \[times its length\]; reached by short keys with short values.
pub const TOML_GROWTH: u64 = 200;

/// Error in the parameters that the user gave, as a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OverridesError {
    /// Error in the file.
    File(String),
    /// Error in the single settings.
    Settings(String),
}

/// Options of a run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// The machine, with all its parameters.
    pub config: MachineConfig,
    /// The engine; `None` is the functional model, without time.
    pub engine: Option<Engine>,
    /// First cycle in which no step may start.
    pub max_cycles: u64,
    /// Whether to draw the reference image and to compare the machine's image with it.
    pub exact: bool,
    /// Auxiliary outputs to pass to the observer, from [`aux_outputs`](crate::aux_outputs). They cost nothing if this is empty.
    pub aux_outputs: Vec<AuxOutputInfo>,
    /// Runs whose [bottlenecks](basrelief_report::model::Bottlenecks) are measured. Only completed runs of the timed and the ticked engine have
    /// bottlenecks.
    pub bottlenecks: AnalysisPolicy,
    /// Parameters that the user gave, from which `config` was loaded. Bottleneck analysis and recordings need them.
    pub overrides: Overrides,
    /// Runs whose [recording](crate::Observer::recording) is passed to the observer. It costs nothing otherwise.
    pub recording: AnalysisPolicy,
    /// Whether to attribute the cycles of the timed or the ticked engine to pixels, polygons, objects and frames, and to pass the
    /// [cost maps](crate::COST_PICTURES) to the observer. Costs nothing otherwise.
    pub costs: bool,
    /// Whether to pass every [memory request](crate::Observer::requests) to the observer. Costs nothing otherwise.
    pub requests: bool,
    /// Monotonic clock \[s\] for the host figures. It influences nothing else.
    pub clock: fn() -> f64,
    /// Memory pool for data whose size depends on the input.
    pub budget: MemoryPool,
}

impl Default for RunOptions {
    /// The default machine with the timed engine and the reference image, without a clock, and with its own memory pool.
    fn default() -> Self {
        Self {
            config: MachineConfig::default(),
            engine: Some(Engine::Timed),
            max_cycles: u64::MAX,
            exact: true,
            aux_outputs: vec![],
            bottlenecks: AnalysisPolicy::Never,
            overrides: Overrides::default(),
            recording: AnalysisPolicy::Never,
            costs: false,
            requests: false,
            clock: || 0.0,
            budget: MemoryPool::default(),
        }
    }
}
