//! Access to the files that a model refers to.

use basrelief_input::{MemoryPool, MemoryReservation, read_to_end};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Source of the other files of a model: buffers, pictures, material libraries.
pub trait ModelFiles {
    /// Reads a file, with its reservation. The name is relative to the model, with `/` between folders.
    ///
    /// # Errors
    /// A failed read, `NotFound` if there is no such file, or [`OverBudget`](basrelief_input::OverBudget) if it exceeds the
    /// memory limit.
    fn read(&self, relative: &str, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)>;
}

/// The files of a folder, read with `std::fs`.
#[derive(Clone, Debug)]
pub struct FolderFiles {
    folder: PathBuf,
    allow_outside: bool,
    on_read: Option<OnRead>,
}

/// Function that receives the path of each file that a model names, before the file is read.
pub type OnRead = fn(&Path);

impl FolderFiles {
    /// Files relative to this folder, and only files in it or below it.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), allow_outside: false, on_read: None }
    }

    /// Allows or forbids names with `..` that lead out of the folder.
    #[must_use]
    pub fn allow_outside(self, allow_outside: bool) -> Self {
        Self { allow_outside, ..self }
    }

    /// Calls `on_read` with the path of each file.
    #[must_use]
    pub fn on_read(self, on_read: Option<OnRead>) -> Self {
        Self { on_read, ..self }
    }
}

/// A name leads out of the folder of a [`FolderFiles`], which does not allow it.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("leads out of the folder of the model")]
pub(crate) struct OutsideFolder;

/// A file was not given together with the model.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("it is not among the given files")]
pub(crate) struct NotGiven;

/// True if the parts of a name lead out of the folder that it starts in.
fn leads_outside(relative: &str) -> bool {
    let depths = relative.split(['/', '\\']).scan(0, |depth, part| {
        match part {
            "" | "." => {}
            ".." => *depth -= 1,
            _ => *depth += 1,
        }
        Some(*depth)
    });
    depths.into_iter().any(|depth: i64| depth < 0)
}

impl ModelFiles for FolderFiles {
    fn read(&self, relative: &str, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)> {
        if !self.allow_outside && leads_outside(relative) {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, OutsideFolder));
        }
        let path = self.folder.join(relative);
        self.on_read.iter().for_each(|on_read| on_read(&path));
        read_regular(&path, budget)
    }
}

/// Files in memory, by name, for tests and for platforms without a file system.
#[derive(Clone, Debug, Default)]
pub struct MemoryFiles {
    files: BTreeMap<String, Vec<u8>>,
}

impl MemoryFiles {
    /// Adds a file.
    #[must_use]
    pub fn with(mut self, name: &str, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(name.into(), bytes.into());
        self
    }
}

impl ModelFiles for MemoryFiles {
    fn read(&self, relative: &str, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)> {
        let bytes = self.files.get(relative).ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, NotGiven))?;
        let held = budget.try_reserve(bytes.len() as u64, FILE)?;
        Ok((bytes.clone(), held))
    }
}

/// Reason for taking memory.
const FILE: &str = "a file";

/// Reads a regular file; pipes and devices are refused, since reading them may never end.
pub(crate) fn read_regular(path: &Path, budget: &MemoryPool) -> io::Result<(Vec<u8>, MemoryReservation)> {
    // Checked before the file is opened, because opening a pipe waits for its writer.
    let facts = std::fs::metadata(path)?;
    if !facts.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    read_to_end(&mut std::fs::File::open(path)?, facts.len(), budget, FILE)
}

/// Turns a reference in a model into a name for [`ModelFiles::read`]: relative paths only. URLs and absolute paths are refused.
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
    use crate::outside::ImportContext;

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
    fn names_that_lead_outside_are_refused_unless_allowed() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("model")).unwrap();
        std::fs::write(folder.path().join("a"), b"xyz").unwrap();
        std::fs::write(folder.path().join("model/b"), b"b").unwrap();
        let budget = MemoryPool::default();
        let files = FolderFiles::new(folder.path().join("model"));
        assert_eq!(files.read("../model/../a", &budget).unwrap_err().kind(), io::ErrorKind::PermissionDenied);
        assert_eq!(
            ImportContext::new(&files, &budget).read("../a", "/uri").unwrap_err().to_string(),
            "/uri: `../a` leads out of the folder of the model; expected a file in this folder or below it; \
             move the file there, or allow it with --allow-outside"
        );
        assert_eq!(files.read("x/../b", &budget).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(files.allow_outside(true).read("../a", &budget).unwrap().0, b"xyz");
    }

    #[test]
    fn folder_as_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a"), b"xyz").unwrap();
        let files = FolderFiles::new(folder.path());
        let budget = MemoryPool::default();
        assert_eq!(files.read("a", &budget).unwrap().0, b"xyz");
        assert!(files.read(".", &budget).is_err());
        assert_eq!(files.read("b", &budget).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn pipe_is_refused_without_blocking() {
        let folder = tempfile::tempdir().unwrap();
        let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status();
        assert!(made.unwrap().success());
        let error = FolderFiles::new(folder.path()).read("pipe", &MemoryPool::default()).unwrap_err();
        assert_eq!(error.to_string(), "not a regular file");
    }

    #[test]
    fn missing_file_is_named_with_its_place() {
        let files = MemoryFiles::default();
        let outside = ImportContext::new(&files, &MemoryPool::default());
        let e = outside.read("a.bin", "/buffers/0/uri").unwrap_err().in_file("m.gltf");
        let text = e.to_string();
        assert!(text.starts_with("m.gltf: /buffers/0/uri: cannot read `a.bin`: it is not among the given files"), "{text}");
        assert!(text.ends_with("drop or choose the model together with all its files"), "{text}");
    }
}
