//! The texture mapping system (300) around its texel value generator (310).
//!
//! ```text
//!  scan converter --spans--> step calculator --segments--------------> approximate calculator (310a) --texels--> (depth test)
//!    |                       + storage element                           ^            | gradients                 |
//!    |                         | points                                  |            v                           v
//!    |                         +-----------> dividers --quotients--------+   MIP-map selector (320) --levels--> texture look-up
//!    |                                                                                                          table (330)
//!    | lit_spans                                                                                                  |
//! texture_values
//!    +----------> illuminance value generator (340) --illuminances-----------------------------------> combiner (350) --> (360)
//! ```
//!
//! A texel value needs two divisions per pixel: `u = U / W`, `v = V / W`, with U, V and W linear on the screen. Here they are
//! divided at the ends of a scan line and at division points between them, as far apart as the accuracy criterion allows, and
//! interpolated in between. No pixel has the texel of a position more than e pixels away. [`StepEquation`] computes the longest
//! step; [`signals`] defines the number formats.
//!
//! Control tokens travel on both paths of each fork, and are paired where the paths meet.

mod approximate_calculator;
mod combiner;
mod config;
mod divider;
mod fixed;
mod illuminance_value_generator;
mod join_streams;
mod log;
mod mip_map_selector;
mod pixel_pace;
mod scan_converter;
pub mod signals;
mod step_calculator;
mod storage_element;
mod texture_look_up_table;
mod widths;

pub use approximate_calculator::{
    ApproximateCalculator, ApproximateCalculatorCounters, ApproximateCalculatorState, DisplacementStats, displacement,
};
pub use combiner::{Combiner, CombinerCounters, CombinerState, PixelValueBuffer};
pub use config::{
    ApproximationConfig, CombineMode, CombinerConfig, DividerConfig, Division, IlluminanceConfig, IlluminanceMode, LookUpConfig,
    March, Method, MipConfig, MipMode, MipPer, ScanConverterConfig, Snap, StepForm, TexelConfig,
};
pub use divider::{Divider, DividerCounters, DividerState};
pub use fixed::iterations;
pub use illuminance_value_generator::{
    IlluminanceValueGenerator, IlluminanceValueGeneratorCounters, IlluminanceValueGeneratorState,
};
pub use log::{DisplacementMap, FrameLog, SpanRecord};
pub use mip_map_selector::{MipMapSelector, MipMapSelectorCounters, MipMapSelectorState, level};
pub use scan_converter::{ScanConverter, ScanConverterCounters, ScanConverterState};
pub use step_calculator::{
    BINS, ChildSubdivision, RootTable, StepCalculator, StepCalculatorCounters, StepCalculatorState, StepEquation, StepReach,
    bin_of, keeps_bound, largest_displacement,
};
pub use storage_element::StorageElement;
pub use texture_look_up_table::{TextureLookUpTable, TextureLookUpTableCounters, TextureLookUpTableState};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
