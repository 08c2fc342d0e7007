//! The output files of one run, in a folder.

use super::partial::{LOCK, make_folder, remove_remains};
use super::unfinished::{Leftover, UnfinishedFiles};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

/// Attempts to lock the folder while another run publishes: 10 s in total; publishing takes milliseconds.
const TRIES: u32 = 1000;
const PAUSE: Duration = Duration::from_millis(10);

/// Temporary name of an unnamed file.
const SCRATCH: &str = "scratch";

/// The output files of one run. Until [`OutputFolder::publish`] they are in a hidden folder. If dropped earlier, they are removed, with the
/// folders created for them.
#[derive(Debug)]
pub struct OutputFolder {
    folder: PathBuf,
    partial: PathBuf,
    /// Locked while the run lives.
    _lock: File,
    leftovers: Vec<Leftover>,
}

impl OutputFolder {
    /// Opens `folder`, and creates it if absent.
    pub fn begin(folder: &Path) -> io::Result<Self> {
        remove_remains(folder);
        let mut unfinished = UnfinishedFiles::lock();
        let absent: Vec<&Path> = folder.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).collect();
        let mut leftovers: Vec<Leftover> = absent.into_iter().rev().map(|p| Leftover::Made(p.into())).collect();
        let (partial, lock) = make_folder(folder).inspect_err(|_| leftovers.iter().rev().for_each(Leftover::remove))?;
        leftovers.push(Leftover::Partial(partial.clone()));
        leftovers.iter().for_each(|l| unfinished.add(l.clone()));
        Ok(Self { folder: folder.into(), partial, _lock: lock, leftovers })
    }

    /// Creates a file with this final name.
    pub fn create(&self, name: &str) -> io::Result<BufWriter<File>> {
        let _lock = UnfinishedFiles::lock();
        File::create(self.partial.join(name)).map(BufWriter::new)
    }

    /// Creates an unnamed file to write and read; it disappears when closed.
    pub fn scratch(&self) -> io::Result<File> {
        let _lock = UnfinishedFiles::lock();
        let path = self.partial.join(SCRATCH);
        let file = File::options().read(true).write(true).create_new(true).open(&path)?;
        fs::remove_file(&path).map(|()| file)
    }

    /// Returns the final path of a file.
    pub fn place(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Renames a file.
    pub fn rename(&self, name: &str, new_name: &str) -> io::Result<()> {
        let _lock = UnfinishedFiles::lock();
        fs::rename(self.partial.join(name), self.partial.join(new_name))
    }

    /// Copies a file.
    pub fn copy(&self, name: &str, second: &str) -> io::Result<()> {
        let _lock = UnfinishedFiles::lock();
        // The file may be published already.
        let unfinished = self.partial.join(name);
        let from = if unfinished.exists() { unfinished } else { self.folder.join(name) };
        fs::copy(from, self.partial.join(second)).map(|_| ())
    }

    /// Publishes one file before the others; it stays even if the run fails. Removes the files that `earlier_files` lists in the folder,
    /// which are of an older run. Waits for its turn, as [`OutputFolder::publish`] does.
    pub fn show(&self, name: &str, earlier_files: impl FnOnce(&Path) -> Vec<String>) -> io::Result<()> {
        let _turn = turn(&self.folder)?;
        let _lock = UnfinishedFiles::lock();
        let file = self.partial.join(name);
        sync(&file)?;
        self.remove_all(earlier_files(&self.folder))?;
        fs::rename(file, self.folder.join(name))
    }

    /// Publishes all files, `last` after the others: a reader that finds it finds the others too. Two runs publish into a folder one after
    /// the other. An older `last` and the files that `earlier_files` lists in the folder are removed first, so that a run killed here never
    /// leaves them beside new files. The list is read in the turn of this run, because another run can change the folder before.
    pub fn publish(mut self, last: &str, earlier_files: impl FnOnce(&Path) -> Vec<String>) -> io::Result<()> {
        let _turn = turn(&self.folder)?;
        let mut unfinished = UnfinishedFiles::lock();
        let others = self.others(last)?;
        let names: Vec<&Path> = others.iter().map(AsRef::as_ref).chain([Path::new(last)]).collect();
        // A file that is renamed before its content is on disk can be empty after a power cut.
        names.iter().try_for_each(|name| sync(&self.partial.join(name)))?;
        let mut earlier = earlier_files(&self.folder);
        earlier.push(last.into());
        self.remove_all(earlier)?;
        names.iter().try_for_each(|name| fs::rename(self.partial.join(name), self.folder.join(name)))?;
        fs::remove_dir_all(&self.partial)?;
        unfinished.forget(&self.leftovers);
        self.leftovers.clear();
        Ok(())
    }

    /// Removes those of these files that exist.
    fn remove_all(&self, names: Vec<String>) -> io::Result<()> {
        names.iter().try_for_each(|name| remove_if_there(&self.folder.join(name)))
    }

    /// Returns the names of all files but `last`.
    fn others(&self, last: &str) -> io::Result<Vec<OsString>> {
        let mut others = Vec::new();
        for entry in fs::read_dir(&self.partial)? {
            let name = entry?.file_name();
            if self.folder.join(&name).is_dir() {
                return Err(io::Error::other(format!(
                    "{} is a folder, expected a file or nothing; choose another folder",
                    name.to_string_lossy()
                )));
            }
            if name != last && name != LOCK {
                others.push(name);
            }
        }
        Ok(others)
    }
}

/// Waits until the content of a file is on disk.
fn sync(path: &Path) -> io::Result<()> {
    // Windows demands write access.
    File::options().write(true).open(path)?.sync_all()
}

fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

/// Waits until no other run publishes. Returns `None` where folders cannot be locked (Windows, some network file systems); there, two runs
/// that end at the same moment can mix their files.
fn turn(folder: &Path) -> io::Result<Option<File>> {
    let Ok(open) = File::open(folder) else { return Ok(None) };
    for _ in 0..TRIES {
        match open.try_lock() {
            Ok(()) => return Ok(Some(open)),
            Err(fs::TryLockError::Error(_)) => return Ok(None),
            Err(fs::TryLockError::WouldBlock) => thread::sleep(PAUSE),
        }
    }
    Err(io::Error::other("another program keeps the folder locked"))
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        let mut unfinished = UnfinishedFiles::lock();
        unfinished.forget(&self.leftovers);
        self.leftovers.iter().rev().for_each(Leftover::remove);
    }
}
