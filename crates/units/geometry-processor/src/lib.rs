//! Geometry processor (102): makes the display list.
//!
//! ```text
//!  scene source --> geometry processor (102) --> display list: frames, objects, polygons with LOD and bump flag
//!                   display-list source -------^ (replays a recorded one in its place)
//! ```

pub mod clip;
pub mod config;
pub mod source;
pub mod state;
pub mod transform;
pub mod unit;

pub use config::{Arrival, BumpConfig, DisplayListConfig, GeometryConfig, Targets};
pub use source::{DisplayListSource, DisplayListState, SceneDraws, SceneSource};
pub use state::{GeometryCounters, GeometryState, VertexCache};
pub use unit::GeometryProcessor;
