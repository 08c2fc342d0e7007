//! Access to the files that a model refers to.

use crate::SceneError;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Largest file that is read \[bytes\].
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Where a model's other files come from: buffers, pictures, material libraries.
pub trait Files {
    /// The bytes of a file, named relative to the model, `/` between folders.
    ///
    /// # Errors
    /// Whatever kept the file from being read; `NotFound` where there is none.
    fn read(&self, relative: &str) -> io::Result<Vec<u8>>;
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
    fn read(&self, relative: &str) -> io::Result<Vec<u8>> {
        read_regular(&self.folder.join(relative))
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
    fn read(&self, relative: &str) -> io::Result<Vec<u8>> {
        self.files.get(relative).cloned().ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))
    }
}

/// Reads a regular file; pipes and devices are refused, since reading them may never end.
pub(crate) fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = std::fs::File::open(path)?;
    if !file.metadata()?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    let mut bytes = Vec::new();
    file.by_ref().take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(io::Error::other(format!("larger than {MAX_FILE_BYTES} bytes")));
    }
    Ok(bytes)
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

/// Reads a referenced file, with an error that names it and the place that refers to it.
pub(crate) fn read_reference(files: &dyn Files, reference: &str, place: &str) -> Result<Vec<u8>, SceneError> {
    let name = relative_name(reference).map_err(|why| {
        SceneError::at(place, format!("`{}` {why}", shorten(reference)))
            .expected("a path relative to the model")
            .cure("copy the file next to the model and refer to it by its name")
    })?;
    files.read(name).map_err(|e| {
        SceneError::at(place, format!("cannot read `{}`: {e}", shorten(name)))
            .expected("a file at this path, relative to the model")
            .cure("put the file there or correct the reference")
    })
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
        assert_eq!(files.read("a").unwrap(), b"xyz");
        assert!(files.read(".").is_err());
        assert_eq!(files.read("b").unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn a_missing_file_is_named_with_its_place() {
        let e = read_reference(&Memory::default(), "a.bin", "/buffers/0/uri").unwrap_err().in_file("m.gltf");
        let text = e.to_string();
        assert!(text.starts_with("m.gltf: /buffers/0/uri: cannot read `a.bin`"), "{text}");
    }
}
