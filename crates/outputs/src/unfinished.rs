//! Files to remove if a run does not finish.

use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

static UNFINISHED: Mutex<Vec<Leftover>> = Mutex::new(Vec::new());

/// A file or folder to remove.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leftover {
    File(PathBuf),
    /// A hidden folder with its content.
    Partial(PathBuf),
    /// A folder created for the outputs; removed only if empty.
    Made(PathBuf),
}

impl Leftover {
    pub(super) fn remove(&self) {
        // A failure has no consequences, because the files are hidden.
        let _ = match self {
            Self::File(path) => fs::remove_file(path),
            Self::Partial(path) => fs::remove_dir_all(path),
            Self::Made(path) => fs::remove_dir(path),
        };
    }
}

/// The locked list.
pub struct UnfinishedFiles(MutexGuard<'static, Vec<Leftover>>);

impl UnfinishedFiles {
    pub(super) fn lock() -> Self {
        Self(UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Adds an entry.
    pub(super) fn add(&mut self, leftover: Leftover) {
        self.0.push(leftover);
    }

    /// Removes entries.
    pub(super) fn forget(&mut self, leftovers: &[Leftover]) {
        self.0.retain(|l| !leftovers.contains(l));
    }
}

/// Removes all unfinished files. While the returned lock is held, no file is created.
pub fn remove_all() -> UnfinishedFiles {
    let mut unfinished = UnfinishedFiles::lock();
    unfinished.0.drain(..).rev().for_each(|l| l.remove());
    unfinished
}
