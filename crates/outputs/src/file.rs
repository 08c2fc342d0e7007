//! A file written under a temporary name and renamed.

use super::partial::{make_file, remove_remains};
use super::unfinished::{Leftover, UnfinishedFiles};
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file under a temporary name. If dropped before [`PartialFile::publish`], it is removed.
#[derive(Debug)]
pub struct PartialFile {
    path: PathBuf,
    /// Temporary file; `None` for devices and pipes.
    partial: Option<PathBuf>,
    file: BufWriter<File>,
}

impl PartialFile {
    /// Creates a file for `path`. A path that exists and is no regular file (a pipe, `/dev/null`) is opened directly, because renaming
    /// would replace the device. For a link the file is created at its target: `/dev/stdout` is a link that may lead to a regular file.
    pub fn create(path: &Path) -> io::Result<Self> {
        if fs::metadata(path).is_ok_and(|m| !m.is_file()) {
            let file = BufWriter::new(File::options().write(true).open(path)?);
            return Ok(Self { path: path.into(), partial: None, file });
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
        target.parent().into_iter().for_each(remove_remains);
        Self::create_in_folder(&target)
    }

    /// Creates a file in a folder whose remains are removed elsewhere.
    pub fn create_in_folder(path: &Path) -> io::Result<Self> {
        let (Some(folder), Some(_)) = (path.parent(), path.file_name()) else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a file name"));
        };
        let mut unfinished = UnfinishedFiles::lock();
        let (partial, file) = make_file(folder)?;
        unfinished.add(Leftover::File(partial.clone()));
        Ok(Self { path: path.into(), partial: Some(partial), file: BufWriter::new(file) })
    }

    /// Writes a whole file and publishes it.
    pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = Self::create(path)?;
        file.write_all(bytes)?;
        file.publish()
    }

    /// Returns the final path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Renames the file to its final path.
    pub fn publish(mut self) -> io::Result<()> {
        self.file.flush()?;
        let Some(partial) = &self.partial else { return Ok(()) };
        self.file.get_ref().sync_all()?;
        let mut unfinished = UnfinishedFiles::lock();
        fs::rename(partial, &self.path)?;
        unfinished.forget(&[Leftover::File(partial.clone())]);
        self.partial = None;
        Ok(())
    }
}

impl Seek for PartialFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl Write for PartialFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        let Some(partial) = self.partial.take() else { return };
        let leftover = Leftover::File(partial);
        let mut unfinished = UnfinishedFiles::lock();
        leftover.remove();
        unfinished.forget(&[leftover]);
    }
}
