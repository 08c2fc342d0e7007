//! Front ends of the machines: the host with the geometry processor (102), or a trace (display list).

use basrelief_geometry_processor::{
    BumpConfig, DisplayListConfig, DisplayListSource, GeometryConfig, GeometryProcessor, PolygonLink, SceneSource,
};
use basrelief_kernel::{Fifo, Operators, Stage, Visitor};
use basrelief_signals::{Control, Draw, VertexAttributes};
use std::fmt;

/// Configuration of a front end, converted from a reference to the machine's configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrontConfig {
    /// Geometry processor (102).
    pub geometry: GeometryConfig,
    /// Selection of bump targets.
    pub bump: BumpConfig,
    /// Arrival of the commands of a trace.
    pub display_list: DisplayListConfig,
    /// Latency and initiation interval of operators.
    pub operators: Operators,
    /// Vertex attributes that the machine uses.
    pub taken: VertexAttributes,
}

impl FrontConfig {
    /// Creates a geometry processor for this machine.
    pub fn geometry_processor(self) -> GeometryProcessor {
        GeometryProcessor::new(self.geometry, self.bump, self.taken, self.operators)
    }
}

/// Implements the conversion of a machine's configuration to [`FrontConfig`]. The second argument is a function from the configuration to
/// the vertex attributes that the machine uses.
macro_rules! front_of {
    ($config:ty, |$c:ident| $taken:expr) => {
        impl From<&$config> for $crate::FrontConfig {
            fn from($c: &$config) -> Self {
                Self {
                    geometry: $c.geometry.clone(),
                    bump: $c.bump.clone(),
                    display_list: $c.display_list.clone(),
                    operators: $c.operators.clone(),
                    taken: $taken,
                }
            }
        }
    };
}
pub(crate) use front_of;

/// Draw commands of any scene.
type Draws = Box<dyn Iterator<Item = Draw>>;

/// Commands of any trace, each with its arrival.
type Controls = Box<dyn Iterator<Item = Result<(Control, Option<u64>), String>>>;

/// Stages at the front of a machine, which fill the FIFO `polygons`.
///
/// One type for both kinds of input and for all iterators, because each type would be another machine to compile.
pub struct FrontEnd(FrontStages);

/// Units in front of every machine: two of scenes, and one of traces.
const HOST: &str = "host";
const GEOMETRY: &str = "geometry";
const DISPLAY_LIST: &str = "display-list";
pub(crate) const FRONT_UNITS: [&str; 3] = [HOST, GEOMETRY, DISPLAY_LIST];

enum FrontStages {
    /// Host and geometry processor (102).
    Scene(Stage<SceneSource<Draws>>, Box<Stage<GeometryProcessor>>),
    /// The recorded output of a geometry processor.
    Trace(Stage<DisplayListSource<Controls>>),
}

impl fmt::Debug for FrontEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let input = match self.0 {
            FrontStages::Scene(..) => "scene",
            FrontStages::Trace(_) => "trace",
        };
        f.debug_tuple("FrontEnd").field(&input).finish()
    }
}

impl FrontEnd {
    /// Creates the front end for the draw commands of a scene: host and geometry processor (102).
    pub fn of_scene(draws: impl Iterator<Item = Draw> + 'static, config: impl Into<FrontConfig>) -> Self {
        let (host, geometry) = (SceneSource::new(Box::new(draws) as Draws), config.into().geometry_processor());
        Self(FrontStages::Scene(Stage::new(HOST, host), Box::new(Stage::new(GEOMETRY, geometry))))
    }

    /// Creates the front end that replays the commands of a trace (display list), each with its arrival.
    pub fn of_trace(
        controls: impl Iterator<Item = Result<(Control, Option<u64>), String>> + 'static,
        config: impl Into<FrontConfig>,
    ) -> Self {
        let FrontConfig { geometry, display_list, taken, .. } = config.into();
        let link = PolygonLink { bytes_per_cycle: geometry.link_bytes, taken };
        let source = DisplayListSource::new(display_list, link, Box::new(controls) as Controls);
        Self(FrontStages::Trace(Stage::new(DISPLAY_LIST, source)))
    }

    /// Visits the stages, with two FIFOs of the machine: `polygons`, which the front end fills, and `draws`, between host and geometry
    /// processor.
    pub(crate) fn wire<V: Visitor>(&mut self, v: &mut V, draws: &mut Fifo<Draw>, polygons: &mut Fifo<Control>) {
        match &mut self.0 {
            FrontStages::Scene(host, geometry) => {
                v.stage(host.between((), &mut *draws));
                v.stage(geometry.between(draws, polygons));
            }
            FrontStages::Trace(display_list) => v.stage(display_list.between((), polygons)),
        }
    }
}
