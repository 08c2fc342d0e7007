//! Approximate calculator (310a): the pixels between division points (Figure 6, step 630).

mod cost;
mod displacement;
mod state;
mod unit;

pub use displacement::{DisplacementStats, displacement};
pub use state::{ApproximateCalculatorCounters, ApproximateCalculatorState};
pub use unit::ApproximateCalculator;
