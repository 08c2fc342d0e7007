//! Nothing half-written: files are written beside their place and renamed when all is done.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The files of one run, in a folder. Until [`Outputs::publish`] they lie in a hidden folder inside it; dropped before
/// that, they are gone, and so is the folder if it was made for them.
#[derive(Debug)]
pub struct Outputs {
    folder: PathBuf,
    partial: PathBuf,
    created: bool,
    names: Vec<(String, String)>,
}

impl Outputs {
    /// Opens `folder`, creating it where absent.
    pub fn begin(folder: &Path) -> io::Result<Self> {
        let created = !folder.exists();
        fs::create_dir_all(folder)?;
        let partial = folder.join(format!(".partial-{}", std::process::id()));
        fs::create_dir_all(&partial)?;
        Ok(Self { folder: folder.into(), partial, created, names: Vec::new() })
    }

    /// Opens a file that shall be called `name`.
    pub fn create(&mut self, name: &str) -> io::Result<BufWriter<File>> {
        let file = File::create(self.partial.join(name))?;
        if !self.names.iter().any(|(from, _)| from == name) {
            self.names.push((name.into(), name.into()));
        }
        Ok(BufWriter::new(file))
    }

    /// Lets a file that was created as `name` be called `new_name` in the end.
    pub fn rename(&mut self, name: &str, new_name: &str) {
        if let Some(entry) = self.names.iter_mut().find(|(from, _)| from == name) {
            entry.1 = new_name.into();
        }
    }

    /// Puts all files in their place.
    pub fn publish(mut self) -> io::Result<()> {
        for (from, to) in std::mem::take(&mut self.names) {
            fs::rename(self.partial.join(from), self.folder.join(to))?;
        }
        self.created = false;
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        // Nothing to be done about a failure here: the files are hidden and of no use.
        let _ = fs::remove_dir_all(&self.partial);
        if self.created {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

/// One file, written beside its place. Dropped before [`PartialFile::publish`] it is gone.
#[derive(Debug)]
pub struct PartialFile {
    path: PathBuf,
    partial: PathBuf,
    file: Option<BufWriter<File>>,
}

impl PartialFile {
    /// Opens a file that shall be at `path`.
    pub fn create(path: &Path) -> io::Result<Self> {
        let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "not a file name"))?;
        let partial = path.with_file_name(format!(".{}.partial-{}", name.to_string_lossy(), std::process::id()));
        let file = Some(BufWriter::new(File::create(&partial)?));
        Ok(Self { path: path.into(), partial, file })
    }

    /// Puts the file in its place.
    pub fn publish(mut self) -> io::Result<()> {
        if let Some(mut file) = self.file.take() {
            file.flush()?;
        }
        fs::rename(&self.partial, &self.path)
    }
}

impl Write for PartialFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_mut().map_or(Ok(0), |f| f.write(bytes))
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        self.file = None;
        let _ = fs::remove_file(&self.partial);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_published_is_gone() {
        let base = tempfile::tempdir().unwrap();
        let folder = base.path().join("new/out");
        let mut outputs = Outputs::begin(&folder).unwrap();
        outputs.create("a.txt").unwrap().write_all(b"a").unwrap();
        drop(outputs);
        assert!(!folder.exists());
        let file = base.path().join("b.txt");
        PartialFile::create(&file).unwrap().write_all(b"b").unwrap();
        assert_eq!(fs::read_dir(base.path().join("new")).unwrap().count() + usize::from(file.exists()), 0);
    }

    #[test]
    fn what_is_published_replaces_what_was_there_and_leaves_other_files_alone() {
        let base = tempfile::tempdir().unwrap();
        fs::write(base.path().join("mine.txt"), "kept").unwrap();
        fs::write(base.path().join("a.txt"), "old").unwrap();
        let mut outputs = Outputs::begin(base.path()).unwrap();
        outputs.create("first").unwrap().write_all(b"new").unwrap();
        outputs.rename("first", "a.txt");
        outputs.publish().unwrap();
        let mut names: Vec<_> = fs::read_dir(base.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["a.txt", "mine.txt"]);
        assert_eq!(fs::read_to_string(base.path().join("a.txt")).unwrap(), "new");
    }
}
