//! The machines: wiring and configuration, nothing else.
//!
//! | machine | device | block diagram |
//! |---|---|---|
//! | [`bump`] | Sony's quantized bump-mapping processor | [`bump::BumpProcessor`] |
//! | [`shade`] | Hitachi's figure shading device | [`shade::FigureShadingDevice`] |
//! | [`texel`] | Sun's texture mapping system | [`texel::TextureMappingSystem`] |
//! | [`defer`] | HP's renderer for a rate-limited path | [`defer::DeferredRenderer`] |

pub mod bump;
mod config;
pub mod defer;
mod diagram;
mod draws;
mod fifos;
mod front;
mod memories;
mod problem;
pub mod shade;
pub mod texel;
mod unit_info;

pub use basrelief_kernel::stats::UnitStats;
pub use config::{ClockConfig, IdealConfig, ReferenceConfig, ReferenceFilter};
pub use diagram::{BlockDiagram, PlacedText, Side, WireCell, drawn_units, numeral_of};
pub use draws::Draws;
pub use front::{FrontConfig, FrontEnd, SceneFront, TraceFront};
pub use problem::{ConfigProblem, slow_fifos};
pub use unit_info::{UnitInfo, units};
