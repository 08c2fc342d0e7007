//! Nothing half-written: files are written beside their place and renamed when all is done.
//!
//! What is not finished is listed in one place, so that Ctrl-C can remove it from its own thread; every change of the
//! file system here is made under the lock of that list. A run that is killed leaves its [`partial`]s behind: the next one
//! that writes there removes them.

mod distinct;
mod file;
mod folder;
mod partial;
#[cfg(test)]
mod tests;
mod unfinished;

pub use distinct::{REPORT, RUN_TAPE, check_distinct, check_not_read};
pub use file::PartialFile;
pub use folder::Outputs;
pub use partial::remove_remains;
pub use unfinished::abandon;
