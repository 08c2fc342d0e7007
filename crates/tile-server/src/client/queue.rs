//! What threads that fetch tiles, and who takes them, share.

use super::FetchProgress;
use super::metrics::TransferMetrics;
use crate::protocol::TileCatalog;
use basrelief_deferred_renderer::TexturePage;
use basrelief_input::Held;
use basrelief_signals::Texture;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::mem;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Tiles that are fetched ahead and that nobody has taken yet, at most: what is fast must not fill the memory.
pub(crate) const MAX_AHEAD: usize = 256;

/// A tile: number of its texture, and its own.
pub(super) type TileKey = (u32, u32);

/// What a tile is encoded as, and what is counted for it.
pub(super) type CountedTile = (Arc<[u8]>, Held);

/// A tile to fetch.
#[derive(Clone, Debug)]
pub(super) struct TileRequest {
    pub(super) page: Arc<TexturePage>,
    pub(super) tile: u32,
    /// The hash of its picture.
    pub(super) picture: Arc<str>,
}

impl TileRequest {
    pub(super) fn key(&self) -> TileKey {
        (self.page.texture, self.tile)
    }
}

/// What is shared.
#[derive(Debug, Default)]
struct QueueState {
    /// What is known of the textures.
    offered: TileCatalog,
    /// Tiles announced that nobody has taken yet.
    announced: BTreeSet<TileKey>,
    /// Of these, those to fetch, in order.
    queue: VecDeque<TileRequest>,
    /// Tiles that threads are fetching.
    under_way: BTreeSet<TileKey>,
    /// Those that are there, with what they take, or have failed for good; and since when.
    done: BTreeMap<TileKey, (Result<CountedTile, String>, Instant)>,
    /// Those that had come for a view when it was left, and were not taken: the next may want them.
    spare: BTreeMap<TileKey, CountedTile>,
    /// Nothing is asked for any more from then on: the view is left.
    until: Option<Instant>,
    /// Threads that have nothing to do.
    idle: usize,
    /// Somebody waits for a tile that is not there.
    missed: bool,
    closed: bool,
}

impl QueueState {
    /// A tile that will be taken: from what has come, or it is to be fetched.
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
        // What has failed for a view that was left may come for this one.
        self.done.remove(&key);
        let picture = self.offered.picture(page.texture);
        self.queue.push_back(TileRequest { page, tile, picture });
        true
    }

    /// Whether there is something to ask for.
    fn is_ready(&self) -> bool {
        let is_looked_at = self.until.is_none_or(|until| Instant::now() < until);
        is_looked_at && (self.missed || self.done.len() < MAX_AHEAD) && !self.queue.is_empty()
    }

    /// The next tiles to fetch by one request: of one picture, at most so many, and no more than leaves something to each other thread
    /// that has nothing to do.
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

/// What is shared, and the news that it has changed.
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

    pub(super) fn meter(&self) -> &TransferMetrics {
        &self.meter
    }

    fn lock(&self) -> MutexGuard<'_, QueueState> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes what is shared, and tells all.
    fn change(&self, change: impl FnOnce(&mut QueueState)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// A texture of the scene.
    pub(super) fn offer(&self, texture: &Texture) {
        self.lock().offered.offer(texture);
    }

    /// What is known of the textures.
    pub(super) fn offered(&self) -> TileCatalog {
        self.lock().offered.clone()
    }

    /// Tiles that will be taken, in order.
    pub(super) fn announce(&self, tiles: impl IntoIterator<Item = (Arc<TexturePage>, u32)>) {
        let mut new = 0;
        self.change(|shared| new = tiles.into_iter().filter(|(page, tile)| shared.announce(Arc::clone(page), *tile)).count());
        if new > 0 {
            self.progress.listed(new as u64);
        }
    }

    /// The next tiles to fetch; none when all is over.
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

    /// A tile is there, or has failed for good.
    pub(super) fn done(&self, tile: TileKey, done: Result<CountedTile, String>) {
        self.change(|shared| {
            shared.under_way.remove(&tile);
            shared.done.insert(tile, (done, Instant::now()));
        });
    }

    /// Waits until a tile that was announced is there.
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

    /// Nothing is asked for any more from then on.
    pub(super) fn ask_until(&self, until: Option<Instant>) {
        self.change(|shared| shared.until = until);
    }

    /// Waits until the first of these tiles is there, if it has come before nothing is asked for any more. They are announced, if it was
    /// not.
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

    /// Nobody will take what is announced: what was not asked for yet is not asked for any more. What has come is kept for the next view,
    /// as what is under way is when it comes: the network has it.
    pub(super) fn abandon(&self) {
        let mut abandoned = 0;
        self.change(|shared| {
            abandoned = shared.queue.len() as u64;
            shared.queue.clear();
            shared.announced.clear();
            shared.spare =
                mem::take(&mut shared.done).into_iter().filter_map(|(key, (done, _))| Some((key, done.ok()?))).collect();
        });
        self.meter.abandoned(abandoned);
    }

    /// Waits so long; less, and false, when all is over.
    pub(super) fn pause(&self, pause: Duration) -> bool {
        let open = |shared: &mut QueueState| !shared.closed;
        let waited = self.changed.wait_timeout_while(self.lock(), pause, open);
        !waited.unwrap_or_else(PoisonError::into_inner).0.closed
    }

    /// All is over.
    pub(super) fn close(&self) {
        self.change(|shared| shared.closed = true);
    }
}
