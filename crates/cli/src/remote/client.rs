//! The client: fetches tiles ahead, several at a time.

use super::fetch::MOST_IN_FLIGHT;
use super::{Fetcher, TileCache};
use crate::progress::TileProgress;
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{Cut, Page, TileEncoding, TileSource};
use basrelief_signals::Texture;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Largest tile that is believed: more than 512 x 512 texels take in any encoding \[bytes\].
const LARGEST_TILE: u64 = 1 << 21;

/// A tile to be fetched.
#[derive(Debug)]
struct Wanted {
    /// Its address below the server's.
    address: String,
    /// Width and height \[texels\].
    size: [u32; 2],
}

/// What the threads share.
#[derive(Debug, Default)]
struct Shared {
    /// Tiles to fetch, in order.
    queue: VecDeque<Wanted>,
    /// Those that are there, or have failed for good.
    done: BTreeMap<String, Result<Arc<[u8]>, String>>,
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
            if let Some(tile) = shared.queue.pop_front() {
                return Some(tile);
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits until a tile that was asked for is there.
    fn wait(&self, tile: &str) -> Result<Arc<[u8]>, String> {
        let mut shared = self.lock();
        loop {
            if let Some(done) = shared.done.remove(tile) {
                return done;
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
pub struct Kept {
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
    encoding: TileEncoding,
    kept: Option<Kept>,
    progress: TileProgress,
}

impl Worker {
    /// Fetches tiles until all is over.
    fn work(&self) {
        while let Some(wanted) = self.exchange.take() {
            let tile = self.obtain(&wanted).map(Arc::from);
            self.exchange.change(|shared| {
                shared.done.insert(wanted.address, tile);
            });
        }
    }

    /// A tile that can be decoded, from the cache or from the server.
    fn obtain(&self, Wanted { address, size }: &Wanted) -> Result<Vec<u8>, String> {
        let check = |body: &[u8]| self.encoding.decode(body, *size).map(drop).map_err(|e| format!("corrupt: {e}"));
        if let Some(body) = self.kept.as_ref().and_then(|kept| kept.cache.get(address, LARGEST_TILE, check)) {
            self.progress.came(0);
            return Ok(body);
        }
        let body = self.fetcher.tile(address, LARGEST_TILE, check, |pause| self.exchange.pause(pause))?;
        if let Some(kept) = self.kept.as_ref().filter(|kept| kept.failed.get().is_none()) {
            // The picture does not suffer: who has asked for the cache is told in the end.
            let _ = kept.cache.put(address, &body).map_err(|e| kept.failed.set(e.to_string()));
        }
        self.progress.came(body.len() as u64);
        Ok(body)
    }
}

/// Tiles of a server, fetched as they are announced, several at a time.
#[derive(Debug)]
pub struct RemoteTiles {
    encoding: TileEncoding,
    quality: u8,
    textures: BTreeMap<u32, [u32; 2]>,
    /// Tiles announced that nobody has taken yet.
    announced: BTreeSet<String>,
    worker: Worker,
    threads: Vec<JoinHandle<()>>,
}

impl RemoteTiles {
    /// Fetches at most `in_flight` tiles at a time, and no more than [`MOST_IN_FLIGHT`]. A tile that comes is kept at once.
    pub fn new(
        fetcher: Fetcher,
        (encoding, quality): (TileEncoding, u8),
        in_flight: u32,
        kept: Option<Kept>,
        progress: TileProgress,
    ) -> Self {
        let worker = Worker { exchange: Arc::new(Exchange::default()), fetcher, encoding, kept, progress };
        let start = |_| {
            let worker = worker.clone();
            thread::spawn(move || worker.work())
        };
        let threads = (0..in_flight.clamp(1, MOST_IN_FLIGHT)).map(start).collect();
        Self { encoding, quality, textures: BTreeMap::new(), announced: BTreeSet::new(), worker, threads }
    }

    fn wanted(&self, page: &Page, tile: u32) -> Wanted {
        let encoding = match self.encoding {
            TileEncoding::Raw => "raw",
            TileEncoding::Png => "png",
            TileEncoding::Jpeg => "jpeg",
        };
        let ([width, height], (first, end)) = (page.cut.tile, page.texels_of(tile));
        Wanted {
            address: format!("tile/{}/{width}x{height}/{encoding}/{}/{tile}", page.texture, self.quality),
            size: [end[0] - first[0], end[1] - first[1]],
        }
    }
}

impl TileSource for RemoteTiles {
    fn offer(&mut self, texture: &Arc<Texture>) {
        let size = texture.levels.first().map_or([1; 2], |image| [image.width, image.height]);
        self.textures.insert(texture.id, size);
    }

    fn announce(&mut self, tiles: &[(Arc<Page>, u32)]) {
        let wanted: Vec<Wanted> = tiles.iter().map(|(page, tile)| self.wanted(page, *tile)).collect();
        self.announced.extend(wanted.iter().map(|w| w.address.clone()));
        self.worker.progress.listed(wanted.len() as u64);
        self.worker.exchange.change(|shared| shared.queue.extend(wanted));
    }

    fn tile(&mut self, page: &Arc<Page>, tile: u32) -> Result<Arc<[u8]>, String> {
        let address = self.wanted(page, tile).address;
        if !self.announced.contains(&address) {
            self.announce(&[(Arc::clone(page), tile)]);
        }
        self.announced.remove(&address);
        self.worker.exchange.wait(&address).map_err(|e| format!("{}: {e}", place_of(page, tile)))
    }

    /// As raw tiles: what they take otherwise, only the server knows.
    fn conventional_bytes(&self, cut: Cut) -> u64 {
        let finest = self.textures.values().map(|size| cut.finest(*size));
        finest.map(|[width, height]| 3 * u64::from(width) * u64::from(height)).sum()
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
