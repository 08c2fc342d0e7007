//! The display in a report.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Scan-out of the front buffer, and flips to finished pictures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Display {
    /// Memory with the colour buffers.
    pub memory: String,
    /// Finished pictures that were passed to the display.
    pub flips: u64,
    /// Pictures that the display showed before the end of the run.
    pub pictures_shown: u64,
    /// Cycles from the end of a picture to its flip, summed over all flips.
    pub flip_wait: u64,
    /// The most cycles of one flip.
    pub longest_flip_wait: u64,
    /// Reads of the front buffer.
    pub reads: u64,
    /// Underruns: reads answered after their deadline, which is the time of the next read.
    pub underruns: u64,
    /// Contention: cycles of the data buses of the memory that the display took.
    pub bus_cycles: u64,
}
