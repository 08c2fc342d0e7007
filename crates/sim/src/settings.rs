//! What to run, and how.

use crate::exhibits::content::ExhibitInfo;
use crate::machines::MachineConfig;
use crate::prepared::Prepared;
use crate::tape::Given;
use basrelief_deferred_renderer::TileSource;
use basrelief_input::Budget;
use basrelief_kernel::Engine;
use basrelief_trace::{Files, NoFiles};
use std::io::Read;

/// What is drawn.
pub enum RunInput {
    /// A scene: goes through the geometry processor.
    Scene(Prepared),
    /// A display list in any form, read once, as a stream.
    Trace {
        /// Its bytes.
        reader: Box<dyn Read>,
        /// The files beside it.
        files: Box<dyn Files>,
        /// For messages, and without its folders for the report.
        name: String,
    },
    /// A scene whose texels are [elsewhere](basrelief_signals::Texture::elsewhere), for a machine that fetches tiles: it goes through
    /// the geometry processor as any scene does. No exact picture is drawn of it.
    Remote {
        /// The scene.
        scene: Prepared,
        /// The server's tiles.
        tiles: Box<dyn TileSource>,
        /// For messages: where it comes from.
        name: String,
    },
}

impl RunInput {
    /// As the user named it.
    pub fn name(&self) -> &str {
        match self {
            Self::Scene(prepared) => &prepared.scene().name,
            Self::Trace { name, .. } | Self::Remote { name, .. } => name,
        }
    }

    /// A scene.
    pub fn scene(scene: impl Into<Prepared>) -> Self {
        Self::Scene(scene.into())
    }

    /// A display list that stands alone.
    pub fn trace(reader: impl Read + 'static, name: &str) -> Self {
        Self::Trace { reader: Box::new(reader), files: Box::new(NoFiles), name: name.into() }
    }
}

/// Which runs something is done for that takes the longer the more they do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum When {
    /// None.
    #[default]
    Never,
    /// Those that make no more steps than are timed again, some twenty times, in the time that pictures and metrics take.
    IfShort,
    /// All, however long it takes.
    Always,
}

/// How to run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// The machine, with all its parameters.
    pub config: MachineConfig,
    /// The engine; `None` is the functional model, without time.
    pub engine: Option<Engine>,
    /// No step starts in this cycle or later.
    pub max_cycles: u64,
    /// Draw the exact picture too, and measure against it.
    pub exact: bool,
    /// What the observer is shown beside the finished pictures, of what the machine has
    /// ([`MachineInfo::exhibits`](crate::MachineInfo::exhibits)); costs nothing where it is empty.
    pub exhibits: Vec<ExhibitInfo>,
    /// Whether what [limits](basrelief_report::model::Limit) the run is measured; of the timed and the ticked engine, and of a run
    /// that comes to its end.
    pub limits: When,
    /// What the user gave of the parameters: `config` follows from it. Needed where limits are measured, or a tape is made.
    pub given: Given,
    /// Whether the observer is shown the run's [tape](crate::Observer::tape); costs nothing otherwise.
    pub tape: When,
    /// Add up what each pixel, polygon, object and frame costs, and show the observer the [pictures](crate::COST_PICTURES) of it; of the
    /// timed and the ticked engine. Costs nothing otherwise.
    pub costs: bool,
    /// Show the observer every [request](crate::Observer::requests) that a memory takes in; costs nothing otherwise.
    pub requests: bool,
    /// Seconds on a clock that does not run backwards, for the host figures; libraries read none themselves. It must
    /// not influence anything else, and does not.
    pub clock: fn() -> f64,
    /// For what a trace makes the run hold, and for the copies that a machine makes of textures.
    pub budget: Budget,
}

impl Default for RunOptions {
    /// Default machine, timed engine, exact picture, no clock, a budget of its own.
    fn default() -> Self {
        let config = MachineConfig::default();
        Self {
            config,
            engine: Some(Engine::Timed),
            max_cycles: u64::MAX,
            exact: true,
            exhibits: vec![],
            limits: When::Never,
            given: Given::default(),
            tape: When::Never,
            costs: false,
            requests: false,
            clock: || 0.0,
            budget: Budget::default(),
        }
    }
}
