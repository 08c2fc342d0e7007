//! Step calculator: the positions of the division points (Figures 4A and 4B).

mod cost;
mod state;
mod step;
mod subdivision;
mod unit;

pub use state::{BINS, StepCalculatorCounters, StepCalculatorState, bin_of};
pub use step::{RootTable, StepEquation, StepReach, keeps_bound, largest_displacement};
pub use subdivision::ChildSubdivision;
pub use unit::StepCalculator;
