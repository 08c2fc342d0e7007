//! Time, FIFOs, memories, engines and cycle accounting.

pub mod traffic;
pub mod unit;

pub use traffic::{Request, Traffic};
pub use unit::{Demand, Step, Unit};
