//! Microcomputer (10) = CPU (11) + memory (12), with a module for each process.
//!
//! | numeral | module |
//! |---|---|
//! | process 13, mode decision | `mode` |
//! | process 15, flatness decision | `flatness` |
//! | process 17, specular-negligible decision | `specular` |
//! | process 20, start of circuit (50) | `start` |
//! | process 22, brightness at the sample points | `sample_points` |
//! | process 23, transfer to circuit (21) | `transfer` |
//! | process 24, mean and its output | `mean` |
//! | memory (12), same plane as before | `memory` |

mod flatness;
mod limits;
mod mean;
mod memory;
mod mode;
mod normals;
mod operand_access;
mod operands;
mod outputs;
mod plane;
mod sample_points;
mod specular;
mod start;
mod state;
mod transfer;
mod unit;

pub use plane::StoredPlane;
pub use state::{CpuProcess, MicrocomputerCounters, MicrocomputerState, ProcessCounters};
pub use unit::Microcomputer;
