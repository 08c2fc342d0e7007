//! `--tile-cache`: tiles that have come stay, whatever becomes of the run.

use super::hash_of;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Hexadecimal digits of a hash.
const DIGITS: usize = 64;

/// A folder of tiles, of one list of polygons: each file holds the hash of a tile and the tile.
#[derive(Clone, Debug)]
pub struct TileCache {
    folder: PathBuf,
}

impl TileCache {
    /// Opens the cache in `folder` for the scene whose polygons have this hash.
    pub fn open(folder: &Path, scene: &str) -> io::Result<Self> {
        let folder = folder.join(scene.get(..16).unwrap_or(scene));
        fs::create_dir_all(&folder)?;
        Ok(Self { folder })
    }

    /// Names a tile of the server's as a file.
    fn path(&self, tile: &str) -> PathBuf {
        self.folder.join(tile.replace('/', "-"))
    }

    /// A tile; none where it is not there, or damaged.
    pub fn get(&self, tile: &str) -> Option<Vec<u8>> {
        let mut bytes = fs::read(self.path(tile)).ok()?;
        let own = bytes.get(..DIGITS)?.to_vec();
        let body = bytes.split_off(DIGITS);
        (hash_of(&body).as_bytes() == own).then_some(body)
    }

    /// Keeps a tile. Written beside its place and renamed: two runs may share a cache.
    pub fn put(&self, tile: &str, body: &[u8]) -> io::Result<()> {
        let path = self.path(tile);
        let partial = path.with_extension(format!("partial-{}", std::process::id()));
        fs::write(&partial, [hash_of(body).as_bytes(), body].concat())?;
        fs::rename(&partial, &path)
    }
}
