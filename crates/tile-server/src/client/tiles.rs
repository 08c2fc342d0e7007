//! The tile source of the device: fetches tiles ahead with several concurrent requests.

use super::fetch::{Attempts, MAX_IN_FLIGHT};
use super::queue::{TileFetchQueue, TileRequest};
use super::schedule::ViewSchedule;
use super::{FetchProgress, Fetcher, TileCache};
use crate::protocol::{MAX_TILE_BYTES, TileCatalog, check_tile, max_tiles_per_request, tiles_path};
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileEncoding, TileSource, ViewUser};
use basrelief_signals::Texture;
use basrelief_sim::TileFetch;
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

/// The tile cache, and the reason if it cannot be written.
#[derive(Clone, Debug)]
pub struct TileStore {
    /// The cache.
    pub cache: TileCache,
    /// Set at the first write error; later tiles are not cached.
    pub failed: Arc<OnceLock<String>>,
}

/// Everything that a fetching thread needs.
#[derive(Clone, Debug)]
struct FetchWorker {
    queue: Arc<TileFetchQueue>,
    fetcher: Fetcher,
    /// Encoding and quality.
    encoding: (TileEncoding, u8),
    tiles_per_request: usize,
    kept: Option<TileStore>,
    progress: Arc<dyn FetchProgress>,
}

impl FetchWorker {
    /// Fetches tiles until the queue is closed.
    fn work(&self) {
        while let Some(wanted) = self.queue.take(|page| self.most(page)) {
            let mut rest = Vec::new();
            for wanted in wanted {
                match self.kept(&wanted) {
                    Some(tile) => {
                        self.progress.arrived(0);
                        self.done(&wanted, Ok(tile));
                    }
                    None => rest.push(wanted),
                }
            }
            self.fetch(&rest);
        }
    }

    /// Returns the maximum number of tiles of a page per request.
    fn most(&self, page: &TexturePage) -> usize {
        max_tiles_per_request(page).min(self.tiles_per_request)
    }

    /// Fetches tiles of one picture with one request; if that fails, with one request each.
    fn fetch(&self, wanted: &[TileRequest]) {
        let mut attempts = Attempts::default();
        if wanted.len() > 1 {
            match self.fetch_together(wanted) {
                Some(tiles) => return wanted.iter().zip(tiles).for_each(|(wanted, tile)| self.came(wanted, Ok(tile))),
                None => attempts.made += 1,
            }
        }
        for wanted in wanted {
            let (address, check) = (self.address(&[wanted]), |body: &[u8]| self.check(wanted, body));
            let pause = |pause| self.queue.pause(pause);
            self.came(wanted, self.fetcher.tile(&address, MAX_TILE_BYTES, check, (attempts, &pause)));
        }
    }

    fn fetch_together(&self, wanted: &[TileRequest]) -> Option<Vec<Vec<u8>>> {
        let wanted: Vec<&TileRequest> = wanted.iter().collect();
        self.fetcher.tiles(&self.address(&wanted), wanted.len(), |i, body| self.check(wanted[i], body))
    }

    /// Returns a tile of the cache.
    fn kept(&self, wanted: &TileRequest) -> Option<Vec<u8>> {
        self.kept.as_ref()?.cache.get(&self.address(&[wanted]), MAX_TILE_BYTES, |body| self.check(wanted, body))
    }

    /// Checks a tile.
    fn check(&self, wanted: &TileRequest, body: &[u8]) -> Result<(), String> {
        check_tile(self.encoding.0, &wanted.page, wanted.tile, body)
    }

    /// Handles a received tile or its final error.
    fn came(&self, wanted: &TileRequest, tile: Result<Vec<u8>, String>) {
        if let Ok(tile) = &tile {
            if let Some(kept) = self.kept.as_ref().filter(|kept| kept.failed.get().is_none()) {
                // A write error does not affect the run; the command line reports it at the end.
                let _ = kept.cache.put(&self.address(&[wanted]), tile).map_err(|e| kept.failed.set(e.to_string()));
            }
            self.progress.arrived(tile.len() as u64);
        }
        self.done(wanted, tile);
    }

    /// Hands a tile to the device.
    fn done(&self, wanted: &TileRequest, tile: Result<Vec<u8>, String>) {
        let counted = |tile: Vec<u8>| {
            let held = self.fetcher.budget().take(tile.len() as u64, "tiles that nobody has taken yet");
            held.map(|held| (Arc::from(tile), held)).map_err(|e| e.to_string())
        };
        self.queue.done(wanted.key(), tile.and_then(counted));
    }

    /// Returns the address of tiles of one picture.
    fn address(&self, wanted: &[&TileRequest]) -> String {
        let numbers: Vec<u32> = wanted.iter().map(|wanted| wanted.tile).collect();
        wanted.first().map_or_else(String::new, |first| tiles_path(&first.picture, first.page.cut, self.encoding, &numbers))
    }
}

/// Tiles of a server, fetched concurrently as they are announced.
#[derive(Debug)]
pub struct RemoteTiles {
    worker: FetchWorker,
    /// The view schedule, if views have times.
    user: Option<Arc<ViewSchedule>>,
    threads: Vec<JoinHandle<()>>,
}

impl RemoteTiles {
    /// Starts the threads, at most `MAX_IN_FLIGHT`. Each received tile is cached at once.
    pub fn new(fetcher: Fetcher, fetch: TileFetch, kept: Option<TileStore>, progress: Arc<dyn FetchProgress>) -> Self {
        let TileFetch { encoding, jpeg_quality, requests, tiles_per_request, left_at_ms } = fetch;
        let encoding = (encoding, jpeg_quality);
        let queue = Arc::new(TileFetchQueue::new(TileCatalog::new(encoding), fetcher.meter().clone(), progress.clone()));
        let user = (!left_at_ms.is_empty()).then(|| Arc::new(ViewSchedule::new(Arc::clone(&queue), left_at_ms)));
        let worker = FetchWorker { queue, fetcher, encoding, tiles_per_request: tiles_per_request as usize, kept, progress };
        let start = |_| {
            let worker = worker.clone();
            thread::spawn(move || worker.work())
        };
        let threads = (0..requests.clamp(1, MAX_IN_FLIGHT)).map(start).collect();
        Self { worker, user, threads }
    }
}

impl TileSource for RemoteTiles {
    /// Textures carry the hash of their picture on the server.
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.worker.queue.offer(texture);
    }

    /// With a view schedule the schedule announces the tiles, because those of an abandoned view must not be requested.
    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        if self.user.is_none() {
            self.worker.queue.announce(tiles.iter().cloned());
        }
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        self.worker.queue.announce([(Arc::clone(page), tile)]);
        self.worker.queue.wait((page.texture, tile)).map_err(|e| format!("{}: {e}", place_of(page, tile)))
    }

    fn user(&self) -> Option<Arc<dyn ViewUser>> {
        self.user.clone().map(|user| user as Arc<dyn ViewUser>)
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.worker.queue.offered().finest_bytes(texture, cut, |address| self.worker.fetcher.number(address))
    }
}

impl Drop for RemoteTiles {
    fn drop(&mut self) {
        self.worker.queue.close();
        // Requests in flight are aborted.
        self.worker.fetcher.shut_down();
        for thread in self.threads.drain(..) {
            // A thread that panicked has nothing to return.
            let _ = thread.join();
        }
        self.worker.progress.finish();
    }
}
