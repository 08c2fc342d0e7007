//! What stands in front of every machine: the host with the geometry processor (102), or a recorded display list.

use basrelief_geometry_processor::{
    BumpConfig, DisplayListConfig, DisplayListSource, GeometryConfig, GeometryProcessor, PolygonLink, SceneSource,
};
use basrelief_kernel::{Fifo, Operators, Stage, Visitor};
use basrelief_signals::{Control, Draw, VertexAttributes};
use std::fmt::Display;

/// The way in: whatever ends in the FIFO `polygons`.
pub trait FrontEnd {
    /// Shows its stages to `v`, with two FIFOs of the machine: the one that it fills, and `draws`, for a host in front of it.
    fn wire<V: Visitor>(&mut self, v: &mut V, draws: &mut Fifo<Draw>, polygons: &mut Fifo<Control>);
}

/// What the way in needs of a machine's configuration: made from a reference to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrontConfig {
    /// Geometry processor (102).
    pub geometry: GeometryConfig,
    /// Which polygons are bump targets.
    pub bump: BumpConfig,
    /// How a display list is fed.
    pub display_list: DisplayListConfig,
    /// How long arithmetic takes.
    pub operators: Operators,
    /// What the machine takes of vertices.
    pub taken: VertexAttributes,
}

impl FrontConfig {
    /// A geometry processor in front of this machine.
    pub fn geometry_processor(self) -> GeometryProcessor {
        GeometryProcessor::new(self.geometry, self.bump, self.taken, self.operators)
    }
}

/// What the way in needs of this configuration, in which it has the same names as in every machine's; and what the machine takes of
/// vertices, which follows from the configuration.
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

/// Host and geometry processor (102): draws a scene.
#[derive(Debug)]
pub struct SceneFront<I: Iterator<Item = Draw>> {
    host: Stage<SceneSource<I>>,
    geometry: Stage<GeometryProcessor>,
}

impl<I: Iterator<Item = Draw>> SceneFront<I> {
    /// A front end that draws `draws`.
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

/// A recorded display list: what a geometry processor handed on.
#[derive(Debug)]
pub struct TraceFront<I> {
    display_list: Stage<DisplayListSource<I>>,
}

impl<I: Iterator<Item = Result<(Control, Option<u64>), E>>, E: Display> TraceFront<I> {
    /// A front end that replays `controls`.
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
