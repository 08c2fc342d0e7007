//! Connection to the server of the page. Received data is cached as long as the page is open.

use crate::host_page::HostPage;
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileEncoding, TileSource};
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_signals::Texture;
use basrelief_tile_server::protocol::{
    GroupHashes, MAX_LIST_BYTES, MAX_TILE_BYTES, TileCatalog, check_hash, check_scene_status, check_status, group_of,
    hash_from_etag, hash_of_received, hashes_path, max_tiles_per_request, scene_path, split, tiles_path,
};
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;
use std::sync::Arc;

/// Attempts per request. There is no pause between attempts, because a worker cannot sleep.
const ATTEMPTS: u32 = 3;
/// Approximate memory of a cached tile beyond its bytes and its address \[bytes\].
const ENTRY: u64 = 128;

/// Totals received so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TransferTotals {
    pub(crate) requests: u64,
    pub(crate) scene_bytes: u64,
    pub(crate) tiles: u64,
    pub(crate) tile_bytes: u64,
}

/// Connection with its cache and its totals.
#[derive(Debug)]
pub(crate) struct ServerConnection {
    page: Rc<dyn HostPage>,
    /// Address of the server, for messages.
    server: String,
    come: Cell<TransferTotals>,
    /// Received data except the scene, by address.
    kept: RefCell<BTreeMap<String, Arc<[u8]>>>,
    /// Memory reservation for `kept`.
    held: RefCell<MemoryReservation>,
}

impl ServerConnection {
    pub(crate) fn new(page: Rc<dyn HostPage>, server: &str, budget: &MemoryPool) -> Self {
        let held = RefCell::new(budget.empty_reservation());
        Self { page, server: server.into(), come: Cell::default(), kept: RefCell::default(), held }
    }

    /// Returns the address of the server, for messages.
    pub(crate) fn server(&self) -> &str {
        &self.server
    }

    pub(crate) fn totals(&self) -> TransferTotals {
        self.come.get()
    }

    fn count(&self, change: impl FnOnce(&mut TransferTotals)) {
        let mut come = self.come.get();
        change(&mut come);
        self.come.set(come);
    }

    /// Fetches the scene in wire format, with the hashes of tiles of this size and encoding.
    pub(crate) fn scene(&self, tile: [u32; 2], encoding: (TileEncoding, u8)) -> Result<Vec<u8>, String> {
        let scene = self.get_with(&scene_path(tile, encoding), check_scene_status, Ok)?;
        self.count(|come| come.scene_bytes += scene.len() as u64);
        Ok(scene)
    }

    /// Fetches an address and decodes the body with `made`. Repeats the request if a check or `made` fails.
    fn get<T>(&self, address: &str, made: impl Fn(Vec<u8>) -> Result<T, String>) -> Result<T, String> {
        self.get_with(address, check_status, made)
    }

    /// As `get`, with a check of the status.
    fn get_with<T>(
        &self,
        address: &str,
        check_status: fn(u16) -> Result<(), String>,
        made: impl Fn(Vec<u8>) -> Result<T, String>,
    ) -> Result<T, String> {
        let once = |attempt| -> Result<T, String> {
            self.count(|come| come.requests += 1);
            let got = self.page.get(address, attempt > 1)?;
            check_status(got.status)?;
            check_hash(&got.body, hash_from_etag(&got.tag)?)?;
            made(got.body)
        };
        let mut done = once(1);
        for attempt in 2..=ATTEMPTS {
            done = done.or_else(|_| once(attempt));
        }
        done.map_err(|e| format!("{}{address}: {e} (attempt {ATTEMPTS}, and no more are made)", self.server))
    }

    /// Fetches a number once and caches it.
    fn number(&self, address: &str) -> Result<u64, String> {
        if let Some(number) = self.cached(address).and_then(|body| number(&body).ok()) {
            return Ok(number);
        }
        let (number, body) = self.get(address, |body| Ok((number(&body)?, Arc::from(body))))?;
        self.cache(address.into(), &body);
        Ok(number)
    }

    /// Fetches a list of hashes of tiles once and caches it.
    fn hash_list(&self, address: &str, check: impl Fn(&[u8]) -> Result<(), String>) -> Result<Arc<[u8]>, String> {
        if let Some(list) = self.cached(address) {
            return Ok(list);
        }
        let checked = |body: Vec<u8>| match body.len() as u64 {
            0..=MAX_LIST_BYTES => check(&body).map(|()| body),
            _ => Err(format!("too long: more than {MAX_LIST_BYTES} bytes")),
        };
        let list = Arc::from(self.get(address, checked)?);
        self.cache(address.into(), &list);
        Ok(list)
    }

    /// Returns cached data.
    fn cached(&self, address: &str) -> Option<Arc<[u8]>> {
        self.kept.borrow().get(address).cloned()
    }

    /// Caches data if memory is left.
    fn cache(&self, address: String, body: &Arc<[u8]>) {
        let bytes = (address.len() + body.len()) as u64 + ENTRY;
        if self.held.borrow_mut().try_grow(bytes, "what has come").is_ok() {
            self.kept.borrow_mut().insert(address, Arc::clone(body));
        }
    }
}

fn number(body: &[u8]) -> Result<u64, String> {
    let text = std::str::from_utf8(body).map_err(|e| e.to_string())?;
    text.parse().map_err(|e| format!("no number: {e}"))
}

/// Tile source for one run. Missing tiles are fetched, several of a texture per request.
#[derive(Debug)]
pub(crate) struct PathTiles {
    path: Rc<ServerConnection>,
    /// Hashes of the tiles, as the scene states them.
    hashes: Rc<GroupHashes>,
    offered: TileCatalog,
    /// Announced tiles in order: texture and tile number.
    announced: VecDeque<(u32, u32)>,
    /// Tiles fetched together with others and not yet used, by address. The list stays short.
    ahead: Vec<(String, Arc<[u8]>)>,
}

impl PathTiles {
    pub(crate) fn new(path: Rc<ServerConnection>, hashes: Rc<GroupHashes>, encoding: (TileEncoding, u8)) -> Self {
        Self { path, hashes, offered: TileCatalog::new(encoding), announced: VecDeque::new(), ahead: Vec::new() }
    }

    fn address(&self, page: &TexturePage, tiles: &[u32]) -> String {
        tiles_path(&self.offered.picture(page.texture), page.cut, self.offered.encoding, tiles)
    }

    fn is_there(&self, address: &str) -> bool {
        self.ahead.iter().any(|(of, _)| of == address) || self.path.cached(address).is_some()
    }

    /// Returns this tile and the next missing tiles of its texture.
    fn next_missing(&self, page: &TexturePage, tile: u32) -> Vec<u32> {
        let next =
            self.announced.iter().filter(|(texture, next)| *texture == page.texture && *next != tile).map(|(_, next)| *next);
        let missing = next.filter(|next| !self.is_there(&self.address(page, &[*next])));
        std::iter::once(tile).chain(missing).take(max_tiles_per_request(page)).collect()
    }

    /// Returns the list of the hashes of the group of a tile.
    fn hashes_of(&self, page: &TexturePage, tile: u32) -> Result<Arc<[u8]>, String> {
        let (picture, group) = (self.offered.picture(page.texture), group_of(tile));
        let address = hashes_path(&picture, page.cut.tile, self.offered.encoding, group);
        self.path.hash_list(&address, |list| self.hashes.check_list(&picture, group, list))
    }

    /// Fetches a tile together with the next missing tiles of its texture.
    fn fetch(&mut self, page: &TexturePage, tile: u32) -> Result<(), String> {
        let wanted = self.next_missing(page, tile);
        let encoding = self.offered.encoding.0;
        let picture = self.offered.picture(page.texture);
        let checked = |body: Vec<u8>| -> Result<Vec<Arc<[u8]>>, String> {
            let tiles = if wanted.len() == 1 { vec![&body[..]] } else { split(&body, wanted.len())? };
            for (number, tile) in wanted.iter().zip(&tiles) {
                if tile.len() as u64 > MAX_TILE_BYTES {
                    return Err(format!("too long: more than {MAX_TILE_BYTES} bytes"));
                }
                let hash = hash_of_received(encoding, page, *number, tile)?;
                self.hashes.check_tile(&picture, (*number, hash), || self.hashes_of(page, *number))?;
            }
            Ok(tiles.into_iter().map(Arc::from).collect())
        };
        let come = self.path.get(&self.address(page, &wanted), checked)?;
        for (number, tile) in wanted.iter().zip(come) {
            self.path.count(|come| {
                come.tiles += 1;
                come.tile_bytes += tile.len() as u64;
            });
            let address = self.address(page, &[*number]);
            self.path.cache(address.clone(), &tile);
            self.ahead.push((address, tile));
        }
        Ok(())
    }
}

impl TileSource for PathTiles {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.offered.offer(texture);
    }

    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        self.announced.extend(tiles.iter().map(|(page, tile)| (page.texture, *tile)));
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        let address = self.address(page, &[tile]);
        if !self.is_there(&address) {
            self.fetch(page, tile).map_err(|e| format!("{}: {e}", place_of(page, tile)))?;
        }
        if let Some(at) = self.announced.iter().position(|next| *next == (page.texture, tile)) {
            self.announced.remove(at);
        }
        let ahead = self.ahead.iter().position(|(of, _)| *of == address);
        let come = ahead.map(|at| self.ahead.swap_remove(at).1).or_else(|| self.path.cached(&address));
        come.ok_or_else(|| format!("{}: has not come", place_of(page, tile)))
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.offered.finest_bytes(texture, cut, |address| self.path.number(address))
    }
}

#[cfg(test)]
mod tests;
