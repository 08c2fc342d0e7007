//! Hidden files and folders that belong to one run and to no other, and what dead runs have left of them.
//!
//! Their names are drawn at random, made and never taken over. The number of the process would not do: in two containers it
//! is the same, and a number comes again. A run keeps a lock on what it has made, and the system opens that lock however the
//! run ends: what can be locked is of a dead run. Since no name comes again, who removes it cannot hit another run's.

use std::collections::hash_map::RandomState;
use std::fs::{self, File, TryLockError};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

const PREFIX: &str = ".partial-";
/// Hexadecimal digits behind the prefix.
const DIGITS: usize = 16;
/// File of a hidden folder that is locked: folders cannot be, everywhere.
pub(super) const LOCK: &str = "lock";
/// Names that are tried. A second one is needed only where another run has taken what was just made for a dead one's.
const NAMES: u32 = 16;

/// A hidden folder in `folder`, which is made where absent, and its lock.
pub(super) fn make_folder(folder: &Path) -> io::Result<(PathBuf, File)> {
    make(folder, |path| {
        fs::create_dir_all(folder)?;
        fs::create_dir(path)?;
        let lock = path.join(LOCK);
        File::create_new(&lock).and_then(|file| hold(file, &lock)).inspect_err(|_| {
            // Empty, or of no use.
            let _ = fs::remove_dir(path);
        })
    })
}

/// A hidden file in `folder`, locked.
pub(super) fn make_file(folder: &Path) -> io::Result<(PathBuf, File)> {
    make(folder, |path| File::create_new(path).and_then(|file| hold(file, path)))
}

fn make(folder: &Path, make: impl Fn(&Path) -> io::Result<File>) -> io::Result<(PathBuf, File)> {
    let once = || {
        // The one source of chance in the standard library.
        let chance = RandomState::new().build_hasher().finish();
        let path = folder.join(format!("{PREFIX}{chance:0DIGITS$x}"));
        make(&path).map(|file| (path, file))
    };
    let lost = |e: &io::Error| matches!(e.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound);
    let made = (1..NAMES).map(|_| once()).find(|made| !made.as_ref().is_err_and(lost));
    made.unwrap_or_else(once)
}

/// Locks what was just made, if nobody has taken it for a dead run's before.
fn hold(file: File, path: &Path) -> io::Result<File> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(ErrorKind::NotFound.into()),
        // Where the file system knows no locks, nobody can lock it: then it stays if its run dies.
        Ok(()) | Err(TryLockError::Error(_)) => fs::symlink_metadata(path).map(|_| file),
    }
}

/// Removes what dead runs have left in `folder`.
pub fn remove_remains(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_partial(&entry.file_name().to_string_lossy()) {
            // What cannot be removed is hidden and of no use.
            let _ = remove_if_dead(&entry.path());
        }
    }
}

fn is_partial(name: &str) -> bool {
    let random = name.strip_prefix(PREFIX);
    random.is_some_and(|digits| digits.len() == DIGITS && digits.bytes().all(|b| b.is_ascii_hexdigit()))
}

fn remove_if_dead(path: &Path) -> io::Result<()> {
    let is_folder = fs::symlink_metadata(path)?.is_dir();
    let lock = if is_folder { path.join(LOCK) } else { path.to_path_buf() };
    match fs::symlink_metadata(&lock) {
        // A pipe would hold us up; what is behind a link is not ours.
        Ok(found) if !found.is_file() => return Ok(()),
        // Its run died, or has yet to make the lock, and then makes another folder: goes only if it is empty.
        Err(e) if is_folder && e.kind() == ErrorKind::NotFound => return fs::remove_dir(path),
        _ => {}
    }
    // Some file systems lock only what is open for writing.
    let file = File::options().read(true).write(true).open(&lock)?;
    if file.try_lock().is_err() {
        return Ok(());
    }
    if is_folder { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}
