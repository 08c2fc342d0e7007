//! What must not stay behind when a run does not come to its end.

use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

static UNFINISHED: Mutex<Vec<Leftover>> = Mutex::new(Vec::new());

/// What must not stay behind.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leftover {
    File(PathBuf),
    /// A hidden folder, with all that is in it.
    Partial(PathBuf),
    /// A folder made for the outputs: goes only if it holds nothing else.
    Made(PathBuf),
}

impl Leftover {
    pub(super) fn remove(&self) {
        // Nothing to be done about a failure here: the files are hidden and of no use.
        let _ = match self {
            Self::File(path) => fs::remove_file(path),
            Self::Partial(path) => fs::remove_dir_all(path),
            Self::Made(path) => fs::remove_dir(path),
        };
    }
}

/// The list, locked.
pub struct Unfinished(MutexGuard<'static, Vec<Leftover>>);

impl Unfinished {
    pub(super) fn lock() -> Self {
        Self(UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Puts this on the list.
    pub(super) fn add(&mut self, leftover: Leftover) {
        self.0.push(leftover);
    }

    /// Takes these off the list.
    pub(super) fn settle(&mut self, leftovers: &[Leftover]) {
        self.0.retain(|l| !leftovers.contains(l));
    }
}

/// Removes all that is unfinished. Until the returned lock is dropped nothing more is created.
pub fn abandon() -> Unfinished {
    let mut unfinished = Unfinished::lock();
    unfinished.0.drain(..).rev().for_each(|l| l.remove());
    unfinished
}
