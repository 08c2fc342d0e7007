//! Files that models and traces name and that the program has read. They are inputs, so no output may overwrite them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn lock() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    READ.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Adds a file.
pub fn add(path: &Path) {
    lock().insert(path.to_path_buf());
}

/// Returns all files read so far.
pub fn files_read() -> Vec<PathBuf> {
    lock().iter().cloned().collect()
}
