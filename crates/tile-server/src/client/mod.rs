//! The client: fetches the scene and the tiles of a server, repeats failed requests, and caches tiles.

mod cache;
mod fetch;
mod hash_lists;
mod metrics;
mod queue;
mod schedule;
mod tiles;
mod transport;

pub use cache::{TileCache, TileStore};
pub use fetch::{Fetcher, RetryPolicy};
pub use metrics::{Elapsed, TransferMetrics};
#[cfg(test)]
pub(crate) use queue::MAX_AHEAD;
pub use tiles::RemoteTiles;

use std::fmt::Debug;

/// Receives the progress of a download, for a progress bar.
pub trait FetchProgress: Debug + Send + Sync {
    /// Another acquisition needs this many tiles.
    fn add_acquisition(&self, tiles: u64);
    /// A tile of this many bytes has arrived; 0 bytes if it came from the cache.
    fn add_bytes(&self, bytes: u64);
    /// No more tiles follow.
    fn finish(&self);
}

/// Shows no progress.
#[derive(Clone, Copy, Debug)]
pub struct NoProgress;

impl FetchProgress for NoProgress {
    fn add_acquisition(&self, _tiles: u64) {}
    fn add_bytes(&self, _bytes: u64) {}
    fn finish(&self) {}
}
