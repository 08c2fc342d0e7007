//! Lists of the hashes of tiles, fetched once per group of tiles and checked against the scene.

use super::Fetcher;
use super::fetch::EarlierAttempts;
use super::metrics::BodyKind;
use crate::protocol::{GroupHashes, MAX_LIST_BYTES, TileHash, group_of, hashes_path};
use basrelief_deferred_renderer::TileFormat;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Picture and group.
type GroupKey = (Arc<str>, u32);
/// A list or its final error.
type FetchedList = Result<Arc<[u8]>, String>;
/// A list, as soon as it is there. Threads that need the same list wait for one request.
type ListSlot = Arc<Mutex<Option<FetchedList>>>;

/// The lists of one run.
#[derive(Debug)]
pub(super) struct HashLists {
    hashes: GroupHashes,
    lists: Mutex<BTreeMap<GroupKey, ListSlot>>,
}

/// A tile of a picture, and its format.
#[derive(Clone, Copy, Debug)]
pub(super) struct HashedTile<'a> {
    pub(super) picture: &'a Arc<str>,
    pub(super) tile: u32,
    pub(super) format: TileFormat,
}

/// Waits, and returns false if the tile is no longer needed.
type PauseFn<'a> = &'a dyn Fn(Duration) -> bool;

impl HashLists {
    pub(super) fn new(hashes: GroupHashes) -> Self {
        Self { hashes, lists: Mutex::default() }
    }

    fn slot(&self, tile: HashedTile<'_>) -> ListSlot {
        let key = (Arc::clone(tile.picture), group_of(tile.tile));
        Arc::clone(self.lists.lock().unwrap_or_else(PoisonError::into_inner).entry(key).or_default())
    }

    /// Fetches the list of a tile, unless it is there or another thread fetches it.
    pub(super) fn prefetch(&self, tile: HashedTile<'_>, fetcher: &Fetcher, pause: PauseFn<'_>) {
        if tile.tile == 0 {
            return;
        }
        if let Ok(list) = self.slot(tile).try_lock() {
            // The check of the tile reports an error.
            let _ = self.filled(list, tile, fetcher, pause);
        }
    }

    /// Checks the hash of a tile. Fetches the list of its group if it is not there.
    ///
    /// # Errors
    /// The tile has another hash, the server does not send the list that the scene states, or the memory limit is reached.
    pub(super) fn check(
        &self,
        tile: HashedTile<'_>,
        hash: TileHash,
        fetcher: &Fetcher,
        pause: PauseFn<'_>,
    ) -> Result<(), String> {
        self.hashes.check_tile(tile.picture, tile.tile, hash, || self.list(tile, fetcher, pause))
    }

    /// Returns true if a tile can be checked. Fetches the list of its group if it is not there.
    pub(super) fn can_check(&self, tile: HashedTile<'_>, fetcher: &Fetcher, pause: PauseFn<'_>) -> bool {
        tile.tile == 0 || self.list(tile, fetcher, pause).is_ok()
    }

    fn list(&self, tile: HashedTile<'_>, fetcher: &Fetcher, pause: PauseFn<'_>) -> FetchedList {
        let slot = self.slot(tile);
        let list = slot.lock().unwrap_or_else(PoisonError::into_inner);
        self.filled(list, tile, fetcher, pause)
    }

    /// Fetches a list into its slot.
    fn filled(
        &self,
        mut slot: MutexGuard<'_, Option<FetchedList>>,
        tile: HashedTile<'_>,
        fetcher: &Fetcher,
        pause: PauseFn<'_>,
    ) -> FetchedList {
        let fetch = || {
            let group = group_of(tile.tile);
            let address = hashes_path(tile.picture, tile.format, group);
            let check = |body: &[u8]| self.hashes.check_list(tile.picture, group, body);
            let body = fetcher.body(&address, MAX_LIST_BYTES, BodyKind::Other, check, EarlierAttempts::default(), pause)?;
            fetcher.budget().try_reserve(body.len() as u64, "hashes of tiles").map_err(|e| e.to_string())?.keep_forever();
            Ok(Arc::from(body))
        };
        slot.get_or_insert_with(fetch).clone()
    }

    /// Stores a list, so that tests count the requests for tiles alone.
    #[cfg(test)]
    pub(super) fn insert(&self, picture: &str, group: u32, list: Vec<u8>) {
        let slot = Arc::new(Mutex::new(Some(Ok(list.into()))));
        self.lists.lock().unwrap().insert((picture.into(), group), slot);
    }
}
