//! Final rasterization (463, 464; 472, 473), with the texture-data memory (130) that it reads.

mod state;
mod unit;

pub use state::{RasterizationCounters, RasterizationState};
pub use unit::Rasterization;
