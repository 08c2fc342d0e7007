//! State shared by the fetching threads and the device.

use super::FetchProgress;
use super::metrics::TransferMetrics;
use crate::protocol::TileCatalog;
use basrelief_deferred_renderer::TexturePage;
use basrelief_input::MemoryReservation;
use basrelief_signals::Texture;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::mem;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Maximum number of tiles fetched ahead, which bounds the memory.
pub(crate) const MAX_AHEAD: usize = 256;

/// Texture and tile number.
pub(super) type TileKey = (u32, u32);

/// Encoded tile and its memory.
pub(super) type CountedTile = (Arc<[u8]>, MemoryReservation);

/// A tile to fetch.
#[derive(Clone, Debug)]
pub(super) struct TileRequest {
    pub(super) page: Arc<TexturePage>,
    pub(super) tile: u32,
    /// Hash of its picture.
    pub(super) picture: Arc<str>,
}

impl TileRequest {
    pub(super) fn key(&self) -> TileKey {
        (self.page.texture, self.tile)
    }
}

/// The state.
#[derive(Debug, Default)]
struct QueueState {
    /// Known textures.
    offered: TileCatalog,
    /// Announced tiles that the device has not taken yet.
    announced: BTreeSet<TileKey>,
    /// Tiles to fetch, in order.
    queue: VecDeque<TileRequest>,
    /// Tiles that are being fetched.
    under_way: BTreeSet<TileKey>,
    /// Received or failed tiles, with the time.
    done: BTreeMap<TileKey, (Result<CountedTile, String>, Instant)>,
    /// Tiles received for an abandoned view, which the next view may need.
    spare: BTreeMap<TileKey, CountedTile>,
    /// Requests stop at this time, when the user leaves the view.
    until: Option<Instant>,
    /// Idle threads.
    idle: usize,
    /// The device waits for a missing tile.
    missed: bool,
    closed: bool,
}

impl QueueState {
    /// Announces a tile. Returns false if it was announced before.
    fn announce(&mut self, page: Arc<TexturePage>, tile: u32) -> bool {
        let key = (page.texture, tile);
        if !self.announced.insert(key) {
            return false;
        }
        if let Some(spare) = self.spare.remove(&key) {
            self.done.insert(key, (Ok(spare), Instant::now()));
        }
        if self.under_way.contains(&key) || matches!(self.done.get(&key), Some((Ok(_), _))) {
            return true;
        }
        // A tile that failed for an earlier view may succeed for this one.
        self.done.remove(&key);
        let picture = self.offered.picture(page.texture);
        self.queue.push_back(TileRequest { page, tile, picture });
        true
    }

    /// Returns true if a thread may fetch now.
    fn is_ready(&self) -> bool {
        let is_looked_at = self.until.is_none_or(|until| Instant::now() < until);
        is_looked_at && (self.missed || self.done.len() < MAX_AHEAD) && !self.queue.is_empty()
    }

    /// Returns the next tiles for one request: of one picture, at most `most`, and no more than leaves work for the other idle threads.
    fn next(&mut self, most: impl Fn(&TexturePage) -> usize) -> Vec<TileRequest> {
        let share = self.queue.len().div_ceil(self.idle.max(1));
        let Some(first) = self.queue.front() else { return vec![] };
        let (texture, most) = (first.page.texture, most(&first.page).min(share));
        let same = self.queue.iter().take(most).take_while(|wanted| wanted.page.texture == texture).count();
        let next: Vec<TileRequest> = self.queue.drain(..same).collect();
        self.under_way.extend(next.iter().map(TileRequest::key));
        next
    }
}

/// Queue of tiles to fetch.
#[derive(Debug)]
pub(super) struct TileFetchQueue {
    shared: Mutex<QueueState>,
    changed: Condvar,
    meter: TransferMetrics,
    progress: Arc<dyn FetchProgress>,
}

impl TileFetchQueue {
    pub(super) fn new(offered: TileCatalog, meter: TransferMetrics, progress: Arc<dyn FetchProgress>) -> Self {
        Self { shared: QueueState { offered, ..QueueState::default() }.into(), changed: Condvar::new(), meter, progress }
    }

    pub(super) fn metrics(&self) -> &TransferMetrics {
        &self.meter
    }

    fn lock(&self) -> MutexGuard<'_, QueueState> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state and wakes all threads.
    fn update(&self, change: impl FnOnce(&mut QueueState)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// Adds a texture of the scene.
    pub(super) fn offer(&self, texture: &Texture) {
        self.lock().offered.offer(texture);
    }

    /// Known textures.
    pub(super) fn catalog(&self) -> TileCatalog {
        self.lock().offered.clone()
    }

    /// Announces tiles in the order of their use.
    pub(super) fn announce(&self, tiles: impl IntoIterator<Item = (Arc<TexturePage>, u32)>) {
        let mut new = 0;
        self.update(|shared| new = tiles.into_iter().filter(|(page, tile)| shared.announce(Arc::clone(page), *tile)).count());
        if new > 0 {
            self.progress.add_acquisition(new as u64);
        }
    }

    /// Waits for tiles to fetch; `None` after the end.
    pub(super) fn take(&self, most: impl Fn(&TexturePage) -> usize) -> Option<Vec<TileRequest>> {
        let mut shared = self.lock();
        shared.idle += 1;
        let next = loop {
            if shared.closed {
                break None;
            }
            if shared.is_ready() {
                break Some(shared.next(&most));
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        };
        shared.idle -= 1;
        next
    }

    /// Stores a received tile or its final error.
    pub(super) fn store_result(&self, tile: TileKey, done: Result<CountedTile, String>) {
        self.update(|shared| {
            shared.under_way.remove(&tile);
            shared.done.insert(tile, (done, Instant::now()));
        });
    }

    /// Waits for an announced tile.
    pub(super) fn wait(&self, tile: TileKey) -> Result<Arc<[u8]>, String> {
        let mut shared = self.lock();
        loop {
            let done = shared.done.remove(&tile);
            shared.missed = done.is_none();
            self.changed.notify_all();
            if let Some((done, _)) = done {
                shared.announced.remove(&tile);
                return done.map(|(tile, _)| tile);
            }
            shared = self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Sets the time after which no tile is requested.
    pub(super) fn ask_until(&self, until: Option<Instant>) {
        self.update(|shared| shared.until = until);
    }

    /// Waits for the first of these tiles. Returns true if it arrives before the view is left. Announces the tiles if they are new.
    pub(super) fn is_there_in_time(&self, tiles: &mut dyn Iterator<Item = (Arc<TexturePage>, u32)>) -> bool {
        let Some((page, tile)) = tiles.next() else { return true };
        let key = (page.texture, tile);
        if !self.lock().announced.contains(&key) {
            self.announce([(page, tile)].into_iter().chain(tiles));
        }
        let mut shared = self.lock();
        loop {
            let came = shared.done.get(&key).map(|(_, came)| *came);
            if let Some(came) = came {
                return shared.until.is_none_or(|until| came <= until);
            }
            let left = shared.until.map(|until| until.saturating_duration_since(Instant::now()));
            shared.missed = left != Some(Duration::ZERO);
            if !shared.missed {
                return false;
            }
            self.changed.notify_all();
            shared = match left {
                Some(left) => self.changed.wait_timeout(shared, left).unwrap_or_else(PoisonError::into_inner).0,
                None => self.changed.wait(shared).unwrap_or_else(PoisonError::into_inner),
            };
        }
    }

    /// Abandons the announced tiles. Requests in flight still complete; the next view can use their tiles and those received before.
    pub(super) fn abandon(&self) {
        let mut abandoned = 0;
        self.update(|shared| {
            abandoned = shared.queue.len() as u64;
            shared.queue.clear();
            shared.announced.clear();
            shared.spare =
                mem::take(&mut shared.done).into_iter().filter_map(|(key, (done, _))| Some((key, done.ok()?))).collect();
        });
        self.meter.count_abandoned(abandoned);
    }

    /// Waits; returns false if the queue is closed meanwhile.
    pub(super) fn pause(&self, pause: Duration) -> bool {
        let open = |shared: &mut QueueState| !shared.closed;
        let waited = self.changed.wait_timeout_while(self.lock(), pause, open);
        !waited.unwrap_or_else(PoisonError::into_inner).0.closed
    }

    /// Ends all threads.
    pub(super) fn close(&self) {
        self.update(|shared| shared.closed = true);
    }
}
