//! Geometry processor (102): creates the display list.
//!
//! ```text
//!  scene source --> geometry processor (102) --> display list: frames, objects, polygons with LOD and bump flag
//!                   display-list source -------^ (replays a recorded one in its place)
//! ```

pub mod clip;
pub mod config;
mod cost;
pub mod display_list_source;
mod link;
mod object_lod;
pub mod scene_source;
pub mod state;
pub mod transform;
pub mod unit;
mod window;
mod work;

pub use config::{BumpConfig, BumpTargets, BumpUnit, CommandArrival, DisplayListConfig, GeometryConfig};
pub use display_list_source::{DisplayListSource, DisplayListSourceCounters, DisplayListSourceState};
pub use link::PolygonLink;
pub use scene_source::{SceneDraws, SceneSource, SceneSourceCounters, SceneSourceState};
pub use state::{GeometryProcessorCounters, GeometryProcessorState, VertexCache};
pub use unit::GeometryProcessor;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
