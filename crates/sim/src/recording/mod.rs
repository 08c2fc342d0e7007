//! Recordings: the steps of a run in a file, whose timing [`resimulate`] computes anew under other timing parameters.

mod error;
mod file;
mod format;
mod kept;
mod loaded;
mod reader;
mod resimulation;
mod shared;

pub use error::RecordingError;
pub use file::Recording;
pub(crate) use format::{CHUNK_BYTES, RecordingSeal, WorkHash, end, header, steps};
pub(crate) use kept::KeptSteps;
pub(crate) use loaded::LoadedRecording;
pub(crate) use loaded::{config_error, of_build};
pub use reader::looks_like_recording;
pub use resimulation::{ResimulateOptions, ResimulationResult, resimulate, resimulate_to};
pub(crate) use resimulation::{netlist_of_same_work, resimulated_cycles};
pub(crate) use shared::SharedRecording;
