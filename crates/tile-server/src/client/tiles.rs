//! The tile source of the device: fetches tiles ahead with several concurrent requests.

use super::fetch::{EarlierAttempts, MAX_IN_FLIGHT};
use super::hash_lists::{HashLists, HashedTile};
use super::metrics::BodyKind;
use super::queue::{TileFetchQueue, TileRequest};
use super::schedule::ViewSchedule;
use super::{FetchProgress, Fetcher, TileStore};
use crate::protocol::{GroupHashes, MAX_TILE_BYTES, TileCatalog, hash_of_received, max_tiles_per_request, tiles_path};
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileFormat, TileSource, ViewUser};
use basrelief_signals::Texture;
use basrelief_sim::TileFetch;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Everything that a fetching thread needs.
#[derive(Clone, Debug)]
struct FetchWorker {
    queue: Arc<TileFetchQueue>,
    fetcher: Fetcher,
    hashes: Arc<HashLists>,
    format: TileFormat,
    tiles_per_request: usize,
    kept: Option<TileStore>,
    progress: Arc<dyn FetchProgress>,
}

impl FetchWorker {
    /// Fetches tiles until the queue is closed.
    fn fetch_until_closed(&self) {
        while let Some(wanted) = self.queue.take(|page| self.max_tiles(page)) {
            let rest: Vec<TileRequest> = wanted.into_iter().filter_map(|wanted| self.take_kept(wanted)).collect();
            rest.iter().for_each(|wanted| self.hashes.prefetch(self.with_format(wanted), &self.fetcher, &self.pause()));
            self.fetch(&rest);
        }
    }

    /// Takes a tile from the cache. Returns the request if the tile must be fetched.
    fn take_kept(&self, wanted: TileRequest) -> Option<TileRequest> {
        let address = self.address(&[&wanted]);
        // The cache removes a tile that fails its check, so the list must be there first.
        let can_check = || self.hashes.can_check(self.with_format(&wanted), &self.fetcher, &self.pause());
        let kept = self.kept.as_ref().filter(|_| can_check());
        let cached = kept.and_then(|kept| kept.cache.get(&address, MAX_TILE_BYTES, |body| self.check(&wanted, body)));
        let Some(tile) = cached else { return Some(wanted) };
        self.progress.add_bytes(0);
        self.deliver_tile(&wanted, Ok(tile));
        None
    }

    /// Returns a tile with its format.
    fn with_format<'a>(&self, wanted: &'a TileRequest) -> HashedTile<'a> {
        HashedTile { picture: &wanted.picture, tile: wanted.tile, format: self.format }
    }

    /// Returns a function that waits, and returns false once the queue is closed.
    fn pause(&self) -> impl Fn(Duration) -> bool {
        |pause| self.queue.pause(pause)
    }

    /// Returns the maximum number of tiles of a page per request.
    fn max_tiles(&self, page: &TexturePage) -> usize {
        max_tiles_per_request(page).min(self.tiles_per_request)
    }

    /// Fetches tiles of one picture with one request; if that fails, with one request each.
    fn fetch(&self, requests: &[TileRequest]) {
        let mut attempts = EarlierAttempts::default();
        if requests.len() > 1 {
            match self.fetch_together(requests) {
                Some(tiles) => return requests.iter().zip(tiles).for_each(|(request, tile)| self.handle_tile(request, Ok(tile))),
                None => attempts.failed += 1,
            }
        }
        for request in requests {
            let (address, check) = (self.address(&[request]), |body: &[u8]| self.check(request, body));
            let body = self.fetcher.body(&address, MAX_TILE_BYTES, BodyKind::Tile, check, attempts, &self.pause());
            self.handle_tile(request, body);
        }
    }

    fn fetch_together(&self, requests: &[TileRequest]) -> Option<Vec<Vec<u8>>> {
        let requests: Vec<&TileRequest> = requests.iter().collect();
        self.fetcher.tiles(&self.address(&requests), requests.len(), |i, body| self.check(requests[i], body))
    }

    /// Checks a tile.
    fn check(&self, wanted: &TileRequest, body: &[u8]) -> Result<(), String> {
        let hash = hash_of_received(self.format, &wanted.page, wanted.tile, body)?;
        self.hashes.check(self.with_format(wanted), hash, &self.fetcher, &self.pause())
    }

    /// Handles a received tile or its final error.
    fn handle_tile(&self, request: &TileRequest, tile: Result<Vec<u8>, String>) {
        if let Ok(tile) = &tile {
            self.kept.iter().for_each(|kept| kept.put(&self.address(&[request]), tile));
            self.progress.add_bytes(tile.len() as u64);
        }
        self.deliver_tile(request, tile);
    }

    /// Hands a tile to the device.
    fn deliver_tile(&self, wanted: &TileRequest, tile: Result<Vec<u8>, String>) {
        let counted = |tile: Vec<u8>| {
            let held = self.fetcher.budget().try_reserve(tile.len() as u64, "tiles that are not used yet");
            held.map(|held| (Arc::from(tile), held)).map_err(|e| e.to_string())
        };
        self.queue.store_result(wanted.key(), tile.and_then(counted));
    }

    /// Returns the address of tiles of one picture.
    fn address(&self, requests: &[&TileRequest]) -> String {
        let numbers: Vec<u32> = requests.iter().map(|request| request.tile).collect();
        let first = requests.first();
        first.map_or_else(String::new, |first| tiles_path(&first.picture, self.format, &numbers))
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
    /// Starts the threads, at most `MAX_IN_FLIGHT`. Each received tile is checked against the hashes of the scene, and cached at once.
    pub fn new(
        fetcher: Fetcher,
        fetch: TileFetch,
        hashes: GroupHashes,
        kept: Option<TileStore>,
        progress: Arc<dyn FetchProgress>,
    ) -> Self {
        let TileFetch { format, requests, tiles_per_request, left_at_ms } = fetch;
        let queue = Arc::new(TileFetchQueue::new(TileCatalog::new(format), fetcher.metrics().clone(), progress.clone()));
        let user = (!left_at_ms.is_empty()).then(|| Arc::new(ViewSchedule::new(Arc::clone(&queue), left_at_ms)));
        let (hashes, tiles_per_request) = (Arc::new(HashLists::new(hashes)), tiles_per_request as usize);
        let worker = FetchWorker { queue, fetcher, hashes, format, tiles_per_request, kept, progress };
        let start = |_| {
            let worker = worker.clone();
            thread::spawn(move || worker.fetch_until_closed())
        };
        let threads = (0..requests.clamp(1, MAX_IN_FLIGHT)).map(start).collect();
        Self { worker, user, threads }
    }

    /// Stores a list of hashes, so that tests count the requests for tiles alone.
    #[cfg(test)]
    pub(crate) fn insert_list(&self, picture: &str, group: u32, list: Vec<u8>) {
        self.worker.hashes.insert(picture, group, list);
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
        self.worker.queue.catalog().finest_bytes(texture, cut, |address| self.worker.fetcher.number(address))
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
