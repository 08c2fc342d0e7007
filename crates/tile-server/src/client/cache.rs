//! `--tile-cache`: received tiles, kept even if the run fails.

use crate::protocol::{HASH_DIGITS, hash_of};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Writes a whole file to its final path, atomically.
pub type WriteFile = fn(&Path, &[u8]) -> io::Result<()>;

/// A folder of tiles, named by their addresses. Each file holds the hash of a tile and the tile.
#[derive(Clone, Debug)]
pub struct TileCache {
    folder: PathBuf,
    write: WriteFile,
}

impl TileCache {
    /// Opens the cache in `folder`, whose files `write` writes. Two runs may share a cache, and a run may be interrupted: `write` must
    /// be atomic.
    pub fn open(folder: &Path, write: WriteFile) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        Ok(Self { folder: folder.into(), write })
    }

    /// Returns the file of a tile.
    fn path(&self, tile: &str) -> PathBuf {
        self.folder.join(tile.replace('/', "-"))
    }

    /// Returns a cached tile of at most `largest` bytes that passes the check. A damaged file is removed.
    pub fn get(&self, tile: &str, largest: u64, check: impl Fn(&[u8]) -> Result<(), String>) -> Option<Vec<u8>> {
        let path = self.path(tile);
        if !fs::metadata(&path).ok()?.is_file() {
            return None;
        }
        let mut bytes = Vec::new();
        File::open(&path).ok()?.take(HASH_DIGITS as u64 + largest).read_to_end(&mut bytes).ok()?;
        let body = bytes.split_at_checked(HASH_DIGITS).filter(|(hash, body)| hash_of(body).as_bytes() == *hash);
        let Some((_, body)) = body.filter(|(_, body)| check(body).is_ok()) else {
            // A file that cannot be removed is overwritten or rejected again.
            let _ = fs::remove_file(&path);
            return None;
        };
        Some(body.to_vec())
    }

    /// Stores a tile. A path that exists and is no regular file, such as a pipe, is an error.
    pub fn put(&self, tile: &str, body: &[u8]) -> io::Result<()> {
        let path = self.path(tile);
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Err(io::Error::other(format!("{} is there and no regular file; remove it", path.display())));
        }
        (self.write)(&path, &[hash_of(body).as_bytes(), body].concat())
    }
}
