//! Nothing half-written: files are written beside their place and renamed when all is done.
//!
//! What is not finished is listed in one place, so that Ctrl-C can remove it from its own thread; every change of the
//! file system here is made under the lock of that list.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Of the next partial file.
static NUMBER: AtomicU64 = AtomicU64::new(0);
static UNFINISHED: Mutex<Vec<Leftover>> = Mutex::new(Vec::new());

/// What must not stay behind.
#[derive(Clone, Debug, PartialEq)]
enum Leftover {
    File(PathBuf),
    /// A hidden folder, with all that is in it.
    Partial(PathBuf),
    /// A folder made for the outputs: goes only if it holds nothing else.
    Made(PathBuf),
}

impl Leftover {
    fn remove(&self) {
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
    fn lock() -> Self {
        Self(UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Takes these off the list.
    fn settle(&mut self, leftovers: &[Leftover]) {
        self.0.retain(|l| !leftovers.contains(l));
    }
}

/// Removes all that is unfinished. Until the returned lock is dropped nothing more is created.
pub fn abandon() -> Unfinished {
    let mut unfinished = Unfinished::lock();
    unfinished.0.drain(..).rev().for_each(|l| l.remove());
    unfinished
}

/// The files of one run, in a folder. Until [`Outputs::publish`] they lie in a hidden folder inside it; dropped before
/// that, they are gone, and so are the folders that were made for them.
#[derive(Debug)]
pub struct Outputs {
    folder: PathBuf,
    partial: PathBuf,
    leftovers: Vec<Leftover>,
}

impl Outputs {
    /// Opens `folder`, creating it and those above it where absent.
    pub fn begin(folder: &Path) -> io::Result<Self> {
        let mut unfinished = Unfinished::lock();
        let absent: Vec<&Path> = folder.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).collect();
        let partial = folder.join(format!(".partial-{}", std::process::id()));
        let mut leftovers: Vec<Leftover> = absent.into_iter().rev().map(|p| Leftover::Made(p.into())).collect();
        leftovers.push(Leftover::Partial(partial.clone()));
        unfinished.0.extend_from_slice(&leftovers);
        let made = fs::create_dir_all(&partial);
        drop(unfinished);
        let outputs = Self { folder: folder.into(), partial, leftovers };
        made.map(|()| outputs)
    }

    /// Opens a file that shall be called `name`.
    pub fn create(&self, name: &str) -> io::Result<BufWriter<File>> {
        let _lock = Unfinished::lock();
        File::create(self.partial.join(name)).map(BufWriter::new)
    }

    /// Gives a file another name.
    pub fn rename(&self, name: &str, new_name: &str) -> io::Result<()> {
        let _lock = Unfinished::lock();
        fs::rename(self.partial.join(name), self.partial.join(new_name))
    }

    /// Gives a file a second name.
    pub fn copy(&self, name: &str, second: &str) -> io::Result<()> {
        let _lock = Unfinished::lock();
        fs::copy(self.partial.join(name), self.partial.join(second)).map(|_| ())
    }

    /// Puts all files in their place, `last` behind all others: who finds it there finds the others too.
    pub fn publish(mut self, last: &str) -> io::Result<()> {
        let mut unfinished = Unfinished::lock();
        let mut others = Vec::new();
        for entry in fs::read_dir(&self.partial)? {
            let name = entry?.file_name();
            if self.folder.join(&name).is_dir() {
                return Err(io::Error::other(format!("{} is a folder", name.to_string_lossy())));
            }
            if name != last {
                others.push(name);
            }
        }
        for name in others.iter().map(AsRef::as_ref).chain([Path::new(last)]) {
            fs::rename(self.partial.join(name), self.folder.join(name))?;
        }
        fs::remove_dir(&self.partial)?;
        unfinished.settle(&self.leftovers);
        self.leftovers.clear();
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        let mut unfinished = Unfinished::lock();
        unfinished.settle(&self.leftovers);
        self.leftovers.iter().rev().for_each(Leftover::remove);
    }
}

/// One file, written beside its place. Dropped before [`PartialFile::publish`] it is gone. What is there and no regular
/// file (a pipe, `/dev/null`) is written to as it is: renaming would replace the device.
#[derive(Debug)]
pub struct PartialFile {
    path: PathBuf,
    /// Hidden file to be renamed.
    partial: Option<PathBuf>,
    file: BufWriter<File>,
}

impl PartialFile {
    /// Opens a file that shall be at `path`.
    pub fn create(path: &Path) -> io::Result<Self> {
        let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "not a file name"))?;
        if fs::metadata(path).is_ok_and(|m| !m.is_file()) {
            let file = BufWriter::new(File::options().write(true).open(path)?);
            return Ok(Self { path: path.into(), partial: None, file });
        }
        // Threads may write the same file, as runs that share a cache do.
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let partial = path.with_file_name(format!(".{}.partial-{}-{number}", name.to_string_lossy(), std::process::id()));
        let mut unfinished = Unfinished::lock();
        let file = BufWriter::new(File::create(&partial)?);
        unfinished.0.push(Leftover::File(partial.clone()));
        Ok(Self { path: path.into(), partial: Some(partial), file })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_is_not_published_is_gone_and_so_are_the_folders_made_for_it() {
        let base = tempfile::tempdir().unwrap();
        let outputs = Outputs::begin(&base.path().join("new/out")).unwrap();
        outputs.create("a.txt").unwrap().write_all(b"a").unwrap();
        drop(outputs);
        PartialFile::create(&base.path().join("b.txt")).unwrap().write_all(b"b").unwrap();
        assert!(names(base.path()).is_empty());
    }

    #[test]
    fn what_is_published_replaces_what_was_there_and_leaves_other_files_alone() {
        let base = tempfile::tempdir().unwrap();
        fs::write(base.path().join("mine.txt"), "kept").unwrap();
        fs::write(base.path().join("a.txt"), "old").unwrap();
        let outputs = Outputs::begin(base.path()).unwrap();
        outputs.create("first").unwrap().write_all(b"new").unwrap();
        outputs.create("report").unwrap();
        outputs.rename("first", "a.txt").unwrap();
        outputs.publish("report").unwrap();
        assert_eq!(names(base.path()), ["a.txt", "mine.txt", "report"]);
        assert_eq!(fs::read_to_string(base.path().join("a.txt")).unwrap(), "new");
    }

    #[test]
    fn where_one_file_cannot_be_placed_none_is() {
        let base = tempfile::tempdir().unwrap();
        fs::create_dir(base.path().join("report")).unwrap();
        let outputs = Outputs::begin(base.path()).unwrap();
        outputs.create("a").unwrap();
        outputs.create("report").unwrap();
        assert!(outputs.publish("report").unwrap_err().to_string().contains("report is a folder"));
        assert_eq!(names(base.path()), ["report"]);
    }

    #[test]
    fn a_device_is_written_to_and_stays_a_device() {
        let device = Path::new("/dev/null");
        if !device.exists() {
            return;
        }
        let mut file = PartialFile::create(device).unwrap();
        file.write_all(b"x").unwrap();
        file.publish().unwrap();
        assert!(!fs::metadata(device).unwrap().is_file());
    }
}
