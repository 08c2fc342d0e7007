//! Files that a user or a display list names.

use crate::memory_pool::{MemoryPool, MemoryReservation, read_to_end};
use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Component, Path};

/// Reads a text file, with its reservation. A device that never ends exceeds the limit.
///
/// # Errors
/// A failed read, [`OverBudget`](crate::OverBudget), or `InvalidData` if the file is not UTF-8.
pub fn read_text(path: &Path, budget: &MemoryPool) -> io::Result<(String, MemoryReservation)> {
    let (bytes, held) = read_to_end(&mut File::open(path)?, 0, budget, "a text")?;
    String::from_utf8(bytes).map(|text| (text, held)).map_err(|_| io::ErrorKind::InvalidData.into())
}

/// Opens files in a folder; names with `..` or an absolute path are refused.
pub fn open_in_folder(folder: &Path) -> impl FnMut(&str) -> io::Result<Box<dyn Read>> + 'static {
    let folder = folder.to_path_buf();
    move |name| {
        let plain = Path::new(name).components().all(|c| matches!(c, Component::Normal(_)));
        if !plain {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "expected a relative name without `..`"));
        }
        let path = folder.join(name);
        if !fs::metadata(&path)?.is_file() {
            return Err(io::Error::other("not a regular file"));
        }
        Ok(Box::new(BufReader::new(File::open(path)?)))
    }
}
