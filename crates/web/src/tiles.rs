//! Tiles of the server of the page.

use crate::connection::ServerConnection;
use crate::host_page::PageResponse;
use basrelief_deferred_renderer::server::place_of;
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileFormat, TileSource};
use basrelief_signals::Texture;
use basrelief_tile_server::protocol::{
    GroupHashes, MAX_LIST_BYTES, MAX_TILE_BYTES, TileCatalog, group_of, hash_of_received, hashes_path, max_tiles_per_request,
    split, tiles_path,
};
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

/// A tile with its address.
type AddressedTile = (String, Arc<[u8]>);

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
    ahead: Vec<AddressedTile>,
}

impl PathTiles {
    pub(crate) fn new(path: Rc<ServerConnection>, hashes: Rc<GroupHashes>, format: TileFormat) -> Self {
        Self { path, hashes, offered: TileCatalog::new(format), announced: VecDeque::new(), ahead: Vec::new() }
    }

    pub(crate) fn address(&self, page: &TexturePage, tiles: &[u32]) -> String {
        tiles_path(&self.offered.picture(page.texture), self.offered.format, tiles)
    }

    pub(crate) fn is_here(&self, address: &str) -> bool {
        self.ahead.iter().any(|(of, _)| of == address) || self.path.cached(address).is_some()
    }

    /// Encodes a tile of this size.
    pub(crate) fn encode(&self, texels: &[[u8; 4]], size: [u32; 2]) -> Result<Vec<u8>, String> {
        let TileFormat { encoding, quality, .. } = self.offered.format;
        encoding.encode(texels, size, quality)
    }

    /// Returns this tile and the next announced tiles of its texture that pass `is_missing`, given their addresses.
    pub(crate) fn batch(&self, page: &TexturePage, tile: u32, is_missing: impl Fn(&str) -> bool) -> Vec<u32> {
        let next =
            self.announced.iter().filter(|(texture, next)| *texture == page.texture && *next != tile).map(|(_, next)| *next);
        let missing = next.filter(|next| is_missing(&self.address(page, &[*next])));
        std::iter::once(tile).chain(missing).take(max_tiles_per_request(page)).collect()
    }

    /// Removes an announced tile.
    pub(crate) fn pass(&mut self, page: &TexturePage, tile: u32) {
        if let Some(at) = self.announced.iter().position(|next| *next == (page.texture, tile)) {
            self.announced.remove(at);
        }
    }

    /// Returns the address of the hashes that check a tile. `None` for the tile of the top layer, which the scene itself checks.
    pub(crate) fn list_address(&self, page: &TexturePage, tile: u32) -> Option<String> {
        let picture = self.offered.picture(page.texture);
        (tile > 0).then(|| hashes_path(&picture, self.offered.format, group_of(tile)))
    }

    /// Returns the list of the hashes of the group of a tile, and fetches it at its first use.
    fn hashes_of(&self, picture: &str, tile: u32) -> Result<Arc<[u8]>, String> {
        let group = group_of(tile);
        let address = hashes_path(picture, self.offered.format, group);
        if let Some(list) = self.path.cached(&address) {
            return Ok(list);
        }
        let list = Arc::from(self.path.get(&address, &|body| self.check_list(picture, group, body))?);
        self.path.cache(address, &list);
        Ok(list)
    }

    fn check_list(&self, picture: &str, group: u32, body: &[u8]) -> Result<(), String> {
        match body.len() as u64 {
            0..=MAX_LIST_BYTES => self.hashes.check_list(picture, group, body),
            _ => Err(format!("too long: more than {MAX_LIST_BYTES} bytes")),
        }
    }

    /// Checks a body that holds these tiles of a picture.
    fn check_tiles(&self, picture: &str, page: &TexturePage, wanted: &[u32], body: &[u8]) -> Result<(), String> {
        for (number, tile) in wanted.iter().zip(tiles_in(body, wanted)?) {
            if tile.len() as u64 > MAX_TILE_BYTES {
                return Err(format!("too long: more than {MAX_TILE_BYTES} bytes"));
            }
            let hash = hash_of_received(self.offered.format, page, *number, tile)?;
            self.hashes.check_tile(picture, *number, hash, || self.hashes_of(picture, *number))?;
        }
        Ok(())
    }

    /// Counts and caches the tiles in a checked body, with addresses in `cut`. Returns them with their addresses.
    fn keep(&self, cut: &str, wanted: &[u32], body: &[u8]) -> Result<Vec<AddressedTile>, String> {
        let mut kept = vec![];
        for (number, tile) in wanted.iter().zip(tiles_in(body, wanted)?) {
            self.path.count(|come| {
                come.tiles += 1;
                come.tile_bytes += tile.len() as u64;
            });
            let (address, tile) = (format!("{cut}/{number}"), Arc::from(tile));
            self.path.cache(address.clone(), &tile);
            kept.push((address, tile));
        }
        Ok(kept)
    }

    /// Fetches a tile together with the next missing tiles of its texture.
    fn fetch(&mut self, page: &TexturePage, tile: u32) -> Result<(), String> {
        let wanted = self.batch(page, tile, |address| !self.is_here(address));
        let picture = self.offered.picture(page.texture);
        let address = self.address(page, &wanted);
        let body = self.path.get(&address, &|body| self.check_tiles(&picture, page, &wanted, body))?;
        let cut = address.rsplit_once('/').map_or("", |(cut, _)| cut);
        let kept = self.keep(cut, &wanted, &body)?;
        self.ahead.extend(kept);
        Ok(())
    }

    /// Caches a response that the page has fetched by itself. `page` describes the texture of tiles.
    ///
    /// # Errors
    /// The response is wrong.
    pub(crate) fn receive(&self, address: &str, page: Option<&TexturePage>, got: PageResponse) -> Result<(), String> {
        let wrong = || format!("{address}: is no address of tiles");
        let (cut, numbers) = address.rsplit_once('/').ok_or_else(wrong)?;
        let numbers: Vec<u32> = numbers.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
        let (kind, picture) = cut.split_once('/').ok_or_else(wrong)?;
        let picture = picture.split('/').next().unwrap_or_default();
        let body = match (kind, page) {
            ("tile", Some(page)) => {
                let body = self.path.receive(got, &|body| self.check_tiles(picture, page, &numbers, body))?;
                return self.keep(cut, &numbers, &body).map(|_| ());
            }
            ("hashes", _) => self.path.receive(got, &|body| self.check_list(picture, numbers[0], body)),
            ("bytes", _) => self.path.receive(got, &|body| number(body).map(|_| ())),
            _ => Err(wrong()),
        };
        self.path.cache(address.into(), &body?.into());
        Ok(())
    }

    /// Fetches a number at its first use.
    fn number(&self, address: &str) -> Result<u64, String> {
        if let Some(number) = self.path.cached(address).and_then(|body| number(&body).ok()) {
            return Ok(number);
        }
        let body = Arc::from(self.path.get(address, &|body| number(body).map(|_| ()))?);
        self.path.cache(address.into(), &body);
        number(&body)
    }

    /// Returns the size of the finest layer of a texture \[bytes\]. `missing` receives the address of an unknown size.
    pub(crate) fn known_bytes(&self, texture: &Texture, cut: PyramidCut, missing: impl FnOnce(&str)) -> Option<u64> {
        self.offered.finest_bytes(texture, cut, |address| {
            let known = self.path.cached(address).ok_or("unknown").map_err(String::from).and_then(|body| number(&body));
            known.inspect_err(|_| missing(address))
        })
    }
}

/// Splits a body into these tiles.
fn tiles_in<'a>(body: &'a [u8], wanted: &[u32]) -> Result<Vec<&'a [u8]>, String> {
    if wanted.len() == 1 { Ok(vec![body]) } else { split(body, wanted.len()) }
}

fn number(body: &[u8]) -> Result<u64, String> {
    let text = std::str::from_utf8(body).map_err(|e| e.to_string())?;
    text.parse().map_err(|e| format!("no number: {e}"))
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
        if !self.is_here(&address) {
            self.fetch(page, tile).map_err(|e| format!("{}: {e}", place_of(page, tile)))?;
        }
        self.pass(page, tile);
        let ahead = self.ahead.iter().position(|(of, _)| *of == address);
        let come = ahead.map(|at| self.ahead.swap_remove(at).1).or_else(|| self.path.cached(&address));
        come.ok_or_else(|| format!("{}: has not come", place_of(page, tile)))
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.offered.finest_bytes(texture, cut, |address| self.number(address))
    }
}

#[cfg(test)]
pub(crate) mod tests;
