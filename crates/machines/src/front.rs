//! Front ends of the machines: the host with the geometry processor (102), or a trace (display list).

use basrelief_geometry_processor::{
    BumpConfig, DisplayListConfig, DisplayListSource, GeometryConfig, GeometryProcessor, PolygonLink, SceneSource,
};
use basrelief_kernel::{Fifo, Operators, Stage, Visitor};
use basrelief_signals::{Control, Draw, VertexAttributes};
use std::fmt::Display;

/// Draw commands of any scene. One type for all, because each type of iterator would be another machine to compile.
pub type BoxedDraws = Box<dyn Iterator<Item = Draw>>;

/// Commands of any trace, each with its arrival. One type for all, because each type of iterator would be another machine to compile.
pub type BoxedControls = Box<dyn Iterator<Item = Result<(Control, Option<u64>), String>>>;

/// Stages at the front of a machine, which fill the FIFO `polygons`.
pub trait FrontEnd {
    /// Visits the stages, with two FIFOs of the machine: `polygons`, which the front end fills, and `draws`, between host and geometry
    /// processor.
    fn wire<V: Visitor>(&mut self, v: &mut V, draws: &mut Fifo<Draw>, polygons: &mut Fifo<Control>);
}

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

/// Front end for a scene: host and geometry processor (102).
#[derive(Debug)]
pub struct SceneFront<I: Iterator<Item = Draw>> {
    host: Stage<SceneSource<I>>,
    geometry: Stage<GeometryProcessor>,
}

impl<I: Iterator<Item = Draw>> SceneFront<I> {
    /// Creates a front end for these draw commands.
    pub fn new(draws: I, config: impl Into<FrontConfig>) -> Self {
        let geometry = config.into().geometry_processor();
        Self { host: Stage::new("host", SceneSource::new(draws)), geometry: Stage::new("geometry", geometry) }
    }
}

impl<I: Iterator<Item = Draw>> FrontEnd for SceneFront<I> {
    fn wire<V: Visitor>(&mut self, v: &mut V, draws: &mut Fifo<Draw>, polygons: &mut Fifo<Control>) {
        v.stage(self.host.between((), &mut *draws));
        v.stage(self.geometry.between(draws, polygons));
    }
}

/// Front end for a trace: the recorded output of a geometry processor.
#[derive(Debug)]
pub struct TraceFront<I> {
    display_list: Stage<DisplayListSource<I>>,
}

impl<I: Iterator<Item = Result<(Control, Option<u64>), E>>, E: Display> TraceFront<I> {
    /// Creates a front end that replays these commands.
    pub fn new(controls: I, config: impl Into<FrontConfig>) -> Self {
        let FrontConfig { geometry, display_list, taken, .. } = config.into();
        let link = PolygonLink { bytes_per_cycle: geometry.link_bytes, taken };
        let source = DisplayListSource::new(display_list, link, controls);
        Self { display_list: Stage::new("display-list", source) }
    }
}

impl<I: Iterator<Item = Result<(Control, Option<u64>), E>>, E: Display> FrontEnd for TraceFront<I> {
    fn wire<V: Visitor>(&mut self, v: &mut V, _: &mut Fifo<Draw>, polygons: &mut Fifo<Control>) {
        v.stage(self.display_list.between((), polygons));
    }
}
