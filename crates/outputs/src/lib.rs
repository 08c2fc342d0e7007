//! Atomic outputs: files are written under temporary names and renamed when all are complete.
//!
//! One list holds the unfinished files, so that a signal handler can remove them. Every change of the file system here happens under the
//! lock of that list. A killed program leaves hidden files; the next program that writes into the same folder removes them.

mod file;
mod folder;
mod partial;
#[cfg(test)]
mod tests;
mod unfinished;

pub use file::PartialFile;
pub use folder::OutputFolder;
pub use partial::remove_remains;
pub use unfinished::{UnfinishedFiles, remove_all};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
