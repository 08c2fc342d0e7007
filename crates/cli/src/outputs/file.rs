//! One file, written beside its place.

use super::partial::{make_file, remove_remains};
use super::unfinished::{Leftover, Unfinished};
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// One file, written beside its place. Dropped before [`PartialFile::publish`] it is gone.
#[derive(Debug)]
pub struct PartialFile {
    path: PathBuf,
    /// Hidden file to be renamed.
    partial: Option<PathBuf>,
    file: BufWriter<File>,
}

impl PartialFile {
    /// Opens a file that shall be at `path`. What is there and no regular file (a pipe, `/dev/null`) is written to as it is:
    /// renaming would replace the device. Of a link it is the file that is put in its place: `/dev/stdout` is one, and may lead to a
    /// regular file.
    pub fn create(path: &Path) -> io::Result<Self> {
        if fs::metadata(path).is_ok_and(|m| !m.is_file()) {
            let file = BufWriter::new(File::options().write(true).open(path)?);
            return Ok(Self { path: path.into(), partial: None, file });
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
        target.parent().into_iter().for_each(remove_remains);
        Self::beside(&target)
    }

    /// The same for a file of a folder that is ours, whose remains are removed elsewhere.
    pub fn beside(path: &Path) -> io::Result<Self> {
        let (Some(folder), Some(_)) = (path.parent(), path.file_name()) else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a file name"));
        };
        let mut unfinished = Unfinished::lock();
        let (partial, file) = make_file(folder)?;
        unfinished.add(Leftover::File(partial.clone()));
        Ok(Self { path: path.into(), partial: Some(partial), file: BufWriter::new(file) })
    }

    /// Writes a file whose bytes are all there, and puts it in its place.
    pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = Self::create(path)?;
        file.write_all(bytes)?;
        file.publish()
    }

    /// Puts the file in its place.
    pub fn publish(mut self) -> io::Result<()> {
        self.file.flush()?;
        let Some(partial) = &self.partial else { return Ok(()) };
        let mut unfinished = Unfinished::lock();
        fs::rename(partial, &self.path)?;
        unfinished.settle(&[Leftover::File(partial.clone())]);
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
        let mut unfinished = Unfinished::lock();
        leftover.remove();
        unfinished.settle(&[leftover]);
    }
}
