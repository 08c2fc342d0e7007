//! Access to the files that a model refers to.

use basrelief_input::{Budget, Held, read_to_end};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Where a model's other files come from: buffers, pictures, material libraries.
pub trait Files {
    /// The bytes of a file, named relative to the model, `/` between folders, and what they take of the budget.
    ///
    /// # Errors
    /// Whatever kept the file from being read; `NotFound` where there is none,
    /// [`OverBudget`](basrelief_input::OverBudget) where it is larger than the budget allows.
    fn read(&self, relative: &str, budget: &Budget) -> io::Result<(Vec<u8>, Held)>;
}

/// The files of a folder, read with `std::fs`.
#[derive(Clone, Debug)]
pub struct Directory {
    folder: PathBuf,
}

impl Directory {
    /// Files relative to this folder.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }
}

impl Files for Directory {
    fn read(&self, relative: &str, budget: &Budget) -> io::Result<(Vec<u8>, Held)> {
        read_regular(&self.folder.join(relative), budget)
    }
}

/// Files held in memory, by name: for tests, and where there is no file system.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    files: BTreeMap<String, Vec<u8>>,
}

impl Memory {
    /// Adds a file.
    #[must_use]
    pub fn with(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(name.into(), bytes.into());
        self
    }
}

impl Files for Memory {
    fn read(&self, relative: &str, budget: &Budget) -> io::Result<(Vec<u8>, Held)> {
        let bytes = self.files.get(relative).ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))?;
        let held = budget.take(bytes.len() as u64, FILE)?;
        Ok((bytes.clone(), held))
    }
}

/// What is counted when a file is read.
const FILE: &str = "a file";

/// Reads a regular file; pipes and devices are refused, since reading them may never end.
pub(crate) fn read_regular(path: &Path, budget: &Budget) -> io::Result<(Vec<u8>, Held)> {
    // Looked at before it is opened: opening a pipe waits for somebody who writes into it.
    let facts = std::fs::metadata(path)?;
    if !facts.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    read_to_end(&mut std::fs::File::open(path)?, facts.len(), budget, FILE)
}

/// Turns a reference in a model into a name for [`Files::read`]: relative paths only. `..` is allowed, since models
/// often keep textures in a sibling folder; URLs and absolute paths are refused.
pub(crate) fn relative_name(reference: &str) -> Result<&str, &'static str> {
    if reference.is_empty() {
        return Err("is empty");
    }
    if reference.contains('\0') {
        return Err("contains a NUL character");
    }
    if reference.starts_with(['/', '\\']) {
        return Err("is an absolute path");
    }
    let first = reference.split(['/', '\\']).next().unwrap_or(reference);
    if first.contains(':') {
        return Err("is a URL or an absolute path");
    }
    Ok(reference)
}

/// The beginning of a text that may be very long.
pub(crate) fn shorten(text: &str) -> String {
    const LONGEST: usize = 80;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outside::Outside;

    #[test]
    fn only_relative_names_are_read() {
        for bad in ["", "/etc/passwd", "\\\\server\\share", "C:\\a", "http://x/y", "file:///x", "a\0b"] {
            assert!(relative_name(bad).is_err(), "{bad:?}");
        }
        for good in ["a.png", "../textures/a.png", "x/y:z.png", "ä b.png"] {
            assert_eq!(relative_name(good), Ok(good));
        }
    }

    #[test]
    fn a_folder_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a"), b"xyz").unwrap();
        let files = Directory::new(folder.path());
        let budget = Budget::default();
        assert_eq!(files.read("a", &budget).unwrap().0, b"xyz");
        assert!(files.read(".", &budget).is_err());
        assert_eq!(files.read("b", &budget).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_no_file_and_nobody_waits_for_it() {
        let folder = tempfile::tempdir().unwrap();
        let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status();
        assert!(made.unwrap().success());
        let error = Directory::new(folder.path()).read("pipe", &Budget::default()).unwrap_err();
        assert_eq!(error.to_string(), "not a regular file");
    }

    #[test]
    fn a_missing_file_is_named_with_its_place() {
        let files = Memory::default();
        let outside = Outside::new(&files, &Budget::default());
        let e = outside.read("a.bin", "/buffers/0/uri").unwrap_err().in_file("m.gltf");
        let text = e.to_string();
        assert!(text.starts_with("m.gltf: /buffers/0/uri: cannot read `a.bin`"), "{text}");
    }
}
