//! `--tile-cache`: tiles that have come stay, whatever becomes of the run.

use crate::outputs::{PartialFile, remove_remains};
use basrelief_served::{DIGITS, hash_of};
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// A folder of tiles, by their addresses, which say what picture they are of: each file holds the hash of a tile and the tile.
#[derive(Clone, Debug)]
pub struct TileCache {
    folder: PathBuf,
}

impl TileCache {
    /// Opens the cache in `folder`.
    pub fn open(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        remove_remains(folder);
        Ok(Self { folder: folder.into() })
    }

    /// Names a tile of the server's as a file.
    fn path(&self, tile: &str) -> PathBuf {
        self.folder.join(tile.replace('/', "-"))
    }

    /// A tile of at most `largest` bytes that passes the check; none where there is no such file. One that is damaged is of no
    /// use to anybody: it is removed.
    pub fn get(&self, tile: &str, largest: u64, check: impl Fn(&[u8]) -> Result<(), String>) -> Option<Vec<u8>> {
        let path = self.path(tile);
        if !fs::metadata(&path).ok()?.is_file() {
            return None;
        }
        let mut bytes = Vec::new();
        File::open(&path).ok()?.take(DIGITS as u64 + largest).read_to_end(&mut bytes).ok()?;
        let body = bytes.split_at_checked(DIGITS).filter(|(hash, body)| hash_of(body).as_bytes() == *hash);
        let Some((_, body)) = body.filter(|(_, body)| check(body).is_ok()) else {
            // Where it cannot be removed, it is overwritten or found bad again.
            let _ = fs::remove_file(&path);
            return None;
        };
        Some(body.to_vec())
    }

    /// Keeps a tile. Written beside its place and renamed: two runs may share a cache, and a run may be interrupted. What is
    /// there and no regular file, such as a pipe, is not ours to write to or to replace.
    pub fn put(&self, tile: &str, body: &[u8]) -> io::Result<()> {
        let path = self.path(tile);
        if fs::symlink_metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Err(io::Error::other(format!("{} is there and no regular file; remove it", path.display())));
        }
        let mut file = PartialFile::beside(&path)?;
        file.write_all(hash_of(body).as_bytes())?;
        file.write_all(body)?;
        file.publish()
    }
}
