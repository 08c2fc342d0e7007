//! `--tile-cache`: received tiles and lists of their hashes, kept even if the run fails.

use crate::protocol::{HASH_DIGITS, hash_of};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Writes a whole file to its final path, atomically.
pub type WriteFile = fn(&Path, &[u8]) -> io::Result<()>;

/// Number of hexadecimal digits of the hash of a server in a file name.
const ORIGIN_DIGITS: usize = 16;

/// A folder of tiles, named by their server and their addresses. Each file holds the hash of a tile and the tile.
#[derive(Clone, Debug)]
pub struct TileCache {
    folder: PathBuf,
    /// Hash of scheme, host and port of the server, as the start of file names.
    origin: String,
    write: WriteFile,
}

impl TileCache {
    /// Opens the cache in `folder` for the server at `url`. `write` writes its files. Two runs may share a cache, and a run may be
    /// interrupted: `write` must be atomic.
    pub fn open(folder: &Path, url: &str, write: WriteFile) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let origin = hash_of(origin_of(url).as_bytes())[..ORIGIN_DIGITS].into();
        Ok(Self { folder: folder.into(), origin, write })
    }

    /// Returns the file of a tile.
    fn path(&self, tile: &str) -> PathBuf {
        self.folder.join(format!("{}-{}", self.origin, tile.replace('/', "-")))
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

/// Returns scheme, host and port of a URL in lower case.
fn origin_of(url: &str) -> String {
    let (scheme, rest) = url.split_once("://").unwrap_or(("http", url));
    let host = rest.split(['/', '?', '#']).next().unwrap_or_default();
    let has_port = host.rsplit_once(':').is_some_and(|(_, port)| !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()));
    let port = match (has_port, scheme.eq_ignore_ascii_case("https")) {
        (true, _) => "",
        (false, true) => ":443",
        (false, false) => ":80",
    };
    format!("{scheme}://{}{port}", host.trim_end_matches(':')).to_ascii_lowercase()
}

/// The tile cache, and the reason if it cannot be written.
#[derive(Clone, Debug)]
pub struct TileStore {
    /// The cache.
    pub cache: TileCache,
    /// Set at the first write error; later tiles are not cached.
    pub failed: Arc<OnceLock<String>>,
}

impl TileStore {
    /// Stores a body. A write error does not affect the run; the command line reports it at the end.
    pub(super) fn put(&self, address: &str, body: &[u8]) {
        if self.failed.get().is_none() {
            let _ = self.cache.put(address, body).map_err(|e| self.failed.set(e.to_string()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origin_is_scheme_host_and_port() {
        for url in ["http://A.example/", "http://a.example:80", "HTTP://a.example:/x/y"] {
            assert_eq!(origin_of(url), "http://a.example:80", "{url}");
        }
        assert_eq!(origin_of("https://[::1]/"), "https://[::1]:443");
        assert_eq!(origin_of("http://[::1]:8080/"), "http://[::1]:8080");
    }
}
