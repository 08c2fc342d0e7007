//! Hidden files and folders of one run, and removal of those that killed runs left.
//!
//! Names are random and never reused. Process numbers would not do: they repeat, and are equal in two containers. A run locks its files,
//! and the system releases the lock however the run ends. So a file that can be locked belongs to a dead run. Since names never repeat, its
//! removal cannot hit another run.

use std::collections::hash_map::RandomState;
use std::fs::{self, File, TryLockError};
use std::hash::{BuildHasher, Hasher};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

const PREFIX: &str = ".partial-";
/// Hexadecimal digits after the prefix.
const DIGITS: usize = 16;
/// Lock file in a hidden folder, because not every system can lock folders.
pub(super) const LOCK: &str = "lock";
/// Attempts to find a name. A second attempt is needed only if another run removed the new file before it was locked.
const NAMES: u32 = 16;

/// Creates a hidden folder in `folder`, which is created if absent. Returns its path and lock.
pub(super) fn make_folder(folder: &Path) -> io::Result<(PathBuf, File)> {
    create_locked(folder, |path| {
        fs::create_dir_all(folder)?;
        fs::create_dir(path)?;
        let lock = path.join(LOCK);
        File::create_new(&lock).and_then(|file| lock_file(file, &lock)).inspect_err(|_| {
            // Removed if empty.
            let _ = fs::remove_dir(path);
        })
    })
}

/// Creates and locks a hidden file in `folder`.
pub(super) fn make_file(folder: &Path) -> io::Result<(PathBuf, File)> {
    create_locked(folder, |path| File::create_new(path).and_then(|file| lock_file(file, path)))
}

fn create_locked(folder: &Path, make: impl Fn(&Path) -> io::Result<File>) -> io::Result<(PathBuf, File)> {
    let once = || {
        // The only source of randomness in the standard library.
        let chance = RandomState::new().build_hasher().finish();
        let path = folder.join(format!("{PREFIX}{chance:0DIGITS$x}"));
        make(&path).map(|file| (path, file))
    };
    let lost = |e: &io::Error| matches!(e.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound);
    let made = (1..NAMES).map(|_| once()).find(|made| !made.as_ref().is_err_and(lost));
    made.unwrap_or_else(once)
}

/// Locks a new file. Fails if another run has removed it meanwhile.
fn lock_file(file: File, path: &Path) -> io::Result<File> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(ErrorKind::NotFound.into()),
        // Without locks in the file system, the files of a killed run stay.
        Ok(()) | Err(TryLockError::Error(_)) => fs::symlink_metadata(path).map(|_| file),
    }
}

/// Removes the remains of dead runs in `folder`.
pub fn remove_remains(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_partial(&entry.file_name().to_string_lossy()) {
            // A file that cannot be removed is hidden.
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
        // A pipe would block, and a link may lead elsewhere.
        Ok(found) if !found.is_file() => return Ok(()),
        // Its run is dead, or has not created the lock yet and will create another folder. Removed only if empty.
        Err(e) if is_folder && e.kind() == ErrorKind::NotFound => return fs::remove_dir(path),
        _ => {}
    }
    // Some file systems require write access to lock.
    let file = File::options().read(true).write(true).open(&lock)?;
    if file.try_lock().is_err() {
        return Ok(());
    }
    if is_folder { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}
