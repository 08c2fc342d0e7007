//! Machines: wiring, configuration, and the list of machines by name.
//!
//! | machine | device | block diagram |
//! |---|---|---|
//! | [`bump`] | Sony's quantized bump-mapping processor | [`bump::BumpProcessor`] |
//! | [`shade`] | Hitachi's figure shading device | [`shade::FigureShadingDevice`] |
//! | [`texel`] | Sun's texture mapping system | [`texel::TextureMappingSystem`] |
//! | [`defer`] | HP's renderer for a rate-limited path | [`defer::DeferredRenderer`] |
//!
//! # Limits of time and area
//!
//! - All operators of the rasterizer count as floating point, as their latencies do. Its edge functions are integers in the model.
//! - A slot of a FIFO of polygons holds a triangle with all attributes that the machine accepts. The further corners of a clipped polygon, and
//!   polygons whose tokens wait in FIFOs behind, have no storage but the set-up registers of the units.
//! - The `texel` machine computes in fixed point, but its operators have the latencies `operators.multiply`, `add` and `divide` of the
//!   machine, whatever their width.
//! - The CPU of the `shade` machine has the area of its floating-point unit and memory. Its integer unit and program have none.
//! - A flag of a clear line is read in the cycle of the look-up that it replaces (`flag_latency`). The display examines no flags: the end
//!   of a frame writes the lines that are still clear.

pub mod bump;
mod config;
mod config_text;
mod configuration_schema;
pub mod defer;
mod diagram;
mod display;
mod draws;
mod engines;
mod fifos;
mod front;
mod memories;
mod methods;
mod neighbours;
mod parameter_info;
mod problem;
mod registry;
pub mod shade;
mod spec;
pub mod texel;
mod unit_info;

pub use basrelief_kernel::stats::UnitStats;
pub use config::{ClockConfig, IdealConfig, ReferenceConfig, ReferenceFilter};
pub use diagram::{BlockDiagram, CellSide, PlacedText, WireCell, drawn_units, numeral_of};
pub use draws::PictureMachine;
pub use engines::MachineEngines;
pub use front::{FrontConfig, FrontEnd};
pub use methods::{MethodNumber, MethodSpec, MethodSpecs};
pub use parameter_info::{AllowedValues, ParameterChoice, ParameterInfo, ValueSource};
pub use problem::{ConfigProblem, slow_fifos};
pub use registry::{ConfigLoader, MACHINES, MachineConfig, MachineInfo};
pub use spec::{CostPoints, InputKind, LoggingMachine, MachineSpec, PictureRecord, RunSummary, TileFetch};
pub use unit_info::{UnitInfo, units};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
