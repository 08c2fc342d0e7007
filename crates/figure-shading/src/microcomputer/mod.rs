//! Microcomputer (10) = CPU (11) + memory (12), with its processes.
//!
//! | process | module |
//! |---|---|
//! | 13 mode decision, 20 start of circuit (50), 23 transfer to circuit (21) | `unit` |
//! | 15 flatness decision | `flatness` |
//! | 17 specular-negligible decision | `specular` |
//! | 22 brightness at the sample points | `sample_points` |
//! | 24 mean and its output, Figure 7 | `mean`, `unit` |

mod flatness;
mod mean;
mod sample_points;
mod specular;
mod state;
mod unit;

pub use mean::Plane;
pub use state::{Counters, MicrocomputerState, Process, ProcessCounters};
pub use unit::Microcomputer;
