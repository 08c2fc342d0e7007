//! Step calculator: the positions of the division points (Figures 4A and 4B).

mod cost;
mod state;
mod step;
mod subdivision;
mod unit;

pub use state::{BINS, StepCalculatorCounters, StepCalculatorState, bin_of};
pub use step::{Reach, RootTable, StepEquation, keeps_bound, largest_displacement};
pub use subdivision::Subdivision;
pub use unit::StepCalculator;
