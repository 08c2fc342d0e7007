//! The client: fetches tiles ahead, several at a time.

use super::fetch::MOST_IN_FLIGHT;
use super::{Fetcher, TileCache};
use crate::progress::TileProgress;
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{Cut, Page, TileEncoding, TileSource};
use basrelief_input::Held;
use basrelief_served::{LARGEST_TILE, Offered, check_tile, tiles_address};
use basrelief_signals::Texture;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Tiles that are fetched ahead and that nobody has taken yet, at most: what is fast must not fill the memory.
pub(super) const MOST_AHEAD: usize = 256;

/// A tile: number of its texture, and its own.
type Key = (u32, u32);

/// What a tile is encoded as, and what is counted for it.
type HeldTile = (Arc<[u8]>, Held);

/// A tile to fetch: its page, its number, and the hash of its picture.
type Wanted = (Arc<Page>, u32, Arc<str>);

/// What the threads share.
#[derive(Debug, Default)]
struct Shared {
    /// Tiles to fetch, in order.
    queue: VecDeque<Wanted>,
    /// Those that are there, with what they take, or have failed for good.
    done: BTreeMap<Key, Result<HeldTile, String>>,
    /// Somebody waits for a tile that is not there.
    missed: bool,
    closed: bool,
}

#[derive(Debug, Default)]
struct Exchange {
    shared: Mutex<Shared>,
    changed: Condvar,
}

impl Exchange {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes what is shared, and tells all.
    fn change(&self, change: impl FnOnce(&mut Shared)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// The next tile to fetch; none when all is over.
    fn take(&self) -> Option<Wanted> {
        let mut shared = self.lock();
        loop {
            if shared.closed {
                return None;
            }
            if (shared.missed || shared.done.len() < MOST_AHEAD)
                && let Some(tile) = shared.queue.pop_front()
            {
                return Some(tile);
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits until a tile that was asked for is there.
    fn wait(&self, tile: Key) -> Result<Arc<[u8]>, String> {
        let mut shared = self.lock();
        loop {
            let done = shared.done.remove(&tile);
            shared.missed = done.is_none();
            self.changed.notify_all();
            if let Some(done) = done {
                return done.map(|(tile, _)| tile);
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits so long; less, and false, when all is over.
    fn pause(&self, pause: Duration) -> bool {
        let open = |shared: &mut Shared| !shared.closed;
        let waited = self.changed.wait_timeout_while(self.lock(), pause, open);
        !waited.unwrap_or_else(PoisonError::into_inner).0.closed
    }
}

/// Where tiles that have come are kept, and why they are not.
#[derive(Clone, Debug)]
pub struct TileStore {
    /// Where.
    pub cache: TileCache,
    /// Set when a tile could not be written: from then on none is.
    pub failed: Arc<OnceLock<String>>,
}

/// What a thread needs to fetch tiles.
#[derive(Clone, Debug)]
struct Worker {
    exchange: Arc<Exchange>,
    fetcher: Fetcher,
    /// With its quality.
    encoding: (TileEncoding, u8),
    kept: Option<TileStore>,
    progress: TileProgress,
}

impl Worker {
    /// Fetches tiles until all is over.
    fn work(&self) {
        while let Some((page, number, picture)) = self.exchange.take() {
            let tile = self.obtain(&page, number, &picture).and_then(|tile| self.counted(tile));
            self.exchange.change(|shared| {
                shared.done.insert((page.texture, number), tile);
            });
        }
    }

    /// A tile that waits to be taken.
    fn counted(&self, tile: Vec<u8>) -> Result<HeldTile, String> {
        let held = self.fetcher.budget().take(tile.len() as u64, "tiles that nobody has taken yet");
        held.map(|held| (Arc::from(tile), held)).map_err(|e| e.to_string())
    }

    /// A tile that can be decoded, from the cache or from the server.
    fn obtain(&self, page: &Page, tile: u32, picture: &str) -> Result<Vec<u8>, String> {
        let address = tiles_address(picture, page.cut, self.encoding, &[tile]);
        let check = |body: &[u8]| check_tile(self.encoding.0, page, tile, body);
        if let Some(body) = self.kept.as_ref().and_then(|kept| kept.cache.get(&address, LARGEST_TILE, check)) {
            self.progress.came(0);
            return Ok(body);
        }
        let body = self.fetcher.tile(&address, LARGEST_TILE, check, |pause| self.exchange.pause(pause))?;
        if let Some(kept) = self.kept.as_ref().filter(|kept| kept.failed.get().is_none()) {
            // The picture does not suffer: who has asked for the cache is told in the end.
            let _ = kept.cache.put(&address, &body).map_err(|e| kept.failed.set(e.to_string()));
        }
        self.progress.came(body.len() as u64);
        Ok(body)
    }
}

/// Tiles of a server, fetched as they are announced, several at a time.
#[derive(Debug)]
pub struct RemoteTiles {
    /// Tiles announced that nobody has taken yet.
    announced: BTreeSet<Key>,
    offered: Offered,
    worker: Worker,
    threads: Vec<JoinHandle<()>>,
}

impl RemoteTiles {
    /// Fetches at most `in_flight` tiles at a time, and no more than [`MOST_IN_FLIGHT`]. A tile that comes is kept at once.
    pub fn new(
        fetcher: Fetcher,
        encoding: (TileEncoding, u8),
        in_flight: u32,
        kept: Option<TileStore>,
        progress: TileProgress,
    ) -> Self {
        let worker = Worker { exchange: Arc::new(Exchange::default()), fetcher, encoding, kept, progress };
        let start = |_| {
            let worker = worker.clone();
            thread::spawn(move || worker.work())
        };
        let threads = (0..in_flight.clamp(1, MOST_IN_FLIGHT)).map(start).collect();
        Self { announced: BTreeSet::new(), offered: Offered::new(encoding), worker, threads }
    }
}

impl TileSource for RemoteTiles {
    /// The server has them all; what they are called there is told with them.
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.offered.offer(texture);
    }

    fn announce(&mut self, tiles: &[(Arc<Page>, u32)]) {
        self.announced.extend(tiles.iter().map(|(page, tile)| (page.texture, *tile)));
        self.worker.progress.listed(tiles.len() as u64);
        let wanted = tiles.iter().map(|(page, tile)| (Arc::clone(page), *tile, self.offered.picture(page.texture)));
        self.worker.exchange.change(|shared| shared.queue.extend(wanted));
    }

    fn tile(&mut self, page: &Arc<Page>, tile: u32) -> Result<Arc<[u8]>, String> {
        let key = (page.texture, tile);
        if !self.announced.remove(&key) {
            self.announce(&[(Arc::clone(page), tile)]);
            self.announced.remove(&key);
        }
        self.worker.exchange.wait(key).map_err(|e| format!("{}: {e}", place_of(page, tile)))
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: Cut) -> Option<u64> {
        self.offered.finest_bytes(texture, cut, |address| self.worker.fetcher.number(address))
    }
}

impl Drop for RemoteTiles {
    fn drop(&mut self) {
        self.worker.exchange.change(|shared| shared.closed = true);
        // What is still under way, nobody waits for.
        self.worker.fetcher.shut_down();
        for thread in self.threads.drain(..) {
            // A thread that has panicked has nothing to say any more.
            let _ = thread.join();
        }
        self.worker.progress.finish();
    }
}
