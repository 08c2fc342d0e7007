//! Costs of each pixel, polygon, object and frame.
//!
//! Every unit cycle, busy or waiting, is charged to the token of the step that ends it, and to the pixels of that token. Nothing is
//! estimated: the cycles of pixels, of everything else, and of no token sum exactly to the accounts of the units (law 9).

mod accumulator;
mod cycle_breakdown;
mod pixels;
mod polygons;
mod probe;
mod report;
mod run_costs;
mod step_polygons;

pub use accumulator::{ActivityCost, PARTS, UnitCost};
pub use cycle_breakdown::{CostKind, CycleBreakdown};
pub use polygons::PolygonCost;
pub(crate) use probe::{CostOptions, CostProbe};
pub use run_costs::{PixelActivity, PixelCost, RunCosts};
pub(crate) use step_polygons::StepPolygons;
