//! Atomic outputs: files are written under temporary names and renamed when all are complete.
//!
//! One list holds the unfinished files, so that the signal thread can remove them. Every change of the file system here happens under the
//! lock of that list. A killed run leaves its [`partial`] files; the next run in the same folder removes them.

mod distinct;
mod file;
mod folder;
mod partial;
#[cfg(test)]
mod tests;
mod unfinished;

pub use distinct::{OF_A_RUN, REPORT, RUN_RECORDING, check_distinct, check_outputs_keep_inputs, recording_in};
pub use file::PartialFile;
pub use folder::OutputFolder;
pub use partial::remove_remains;
pub use unfinished::remove_all;
