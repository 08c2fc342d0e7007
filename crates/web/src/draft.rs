//! Drafts: pictures drawn at once with the tiles that are here. Missing tiles are grey, and the page fetches them meanwhile.

use crate::tiles::PathTiles;
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileSource};
use basrelief_reference::RgbPicture;
use basrelief_signals::Texture;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

/// Colour of a missing tile.
const GREY: [u8; 4] = [176, 176, 176, 255];

/// Textures of missing tiles, by the start of the addresses of their tiles.
pub(crate) type DraftPages = Vec<(String, Arc<TexturePage>)>;

/// Data that a draft lacks. Sorted lists make less code than maps, and are fast enough for thousands of tiles.
#[derive(Debug, Default)]
pub(crate) struct DraftRecord {
    /// Requests of the page, under way or queued: the address of each of their tiles or of their other data, and of the request.
    /// Sorted.
    coming: Vec<(String, String)>,
    /// Requests of the page that the draft needs, in the order of their use.
    pub(crate) needed: Vec<String>,
    /// Addresses to be requested, in the order of their use.
    pub(crate) missing: Vec<String>,
    /// Address of each missing tile and of other missing data. Sorted.
    listed: Vec<String>,
    pub(crate) pages: DraftPages,
    /// Lists of tiles announced so far.
    announced: usize,
    /// Lists of tiles announced before that of the first missing tile.
    complete: Option<usize>,
}

impl DraftRecord {
    /// Makes the record of a draft. The page has begun or queued these requests.
    pub(crate) fn new(pending: Vec<String>) -> Rc<RefCell<Self>> {
        let mut coming = vec![];
        for address in pending {
            let Some((cut, numbers)) = address.rsplit_once('/') else { continue };
            coming.extend(numbers.split(',').map(|number| (format!("{cut}/{number}"), address.clone())));
        }
        coming.sort_unstable();
        Rc::new(RefCell::new(Self { coming, ..Self::default() }))
    }

    /// Returns true if nothing is missing.
    pub(crate) fn is_complete(&self) -> bool {
        self.needed.is_empty() && self.missing.is_empty()
    }

    /// Returns the request of the page for data.
    fn request_of(&self, address: &str) -> Option<&String> {
        let found = self.coming.binary_search_by(|(of, _)| of.as_str().cmp(address)).ok()?;
        Some(&self.coming[found].1)
    }

    /// Returns the place for an address in the sorted list; `None` if it is there.
    fn place_for(&self, address: &str) -> Option<usize> {
        self.listed.binary_search_by(|of| of.as_str().cmp(address)).err()
    }

    /// Returns true if data is neither listed nor requested.
    fn is_new(&self, address: &str) -> bool {
        self.request_of(address).is_none() && self.place_for(address).is_some()
    }

    /// Notes that the draft needs data. Returns true if it must be requested.
    fn need(&mut self, address: &str) -> bool {
        if let Some(request) = self.request_of(address) {
            if !self.needed.contains(request) {
                self.needed.push(request.clone());
            }
            return false;
        }
        let place = self.place_for(address);
        place.into_iter().for_each(|place| self.listed.insert(place, address.into()));
        place.is_some()
    }

    /// Notes that the draft needs data with its own address.
    fn need_alone(&mut self, address: &str) {
        if self.need(address) {
            self.missing.push(address.into());
        }
    }
}

/// Tile source of a draft.
#[derive(Debug)]
pub(crate) struct DraftTiles {
    tiles: PathTiles,
    record: Rc<RefCell<DraftRecord>>,
    /// Grey tiles by their size.
    grey: Vec<([u32; 2], Arc<[u8]>)>,
}

impl DraftTiles {
    pub(crate) fn new(tiles: PathTiles, record: Rc<RefCell<DraftRecord>>) -> Self {
        Self { tiles, record, grey: vec![] }
    }

    /// Lists a missing tile with the next missing tiles of its texture, after the hashes that check them.
    fn list(&self, page: &Arc<TexturePage>, tile: u32) {
        let record = &mut *self.record.borrow_mut();
        let before = record.announced.saturating_sub(1);
        record.complete.get_or_insert(before);
        let address = self.tiles.address(page, &[tile]);
        if record.request_of(&address).is_some() {
            return self.need(record, page, &[tile]);
        }
        if !record.is_new(&address) {
            return;
        }
        let batch = self.tiles.batch(page, tile, |address| !self.tiles.is_here(address) && record.is_new(address));
        self.need(record, page, &batch);
        let request = self.tiles.address(page, &batch);
        if let Some((cut, _)) = request.rsplit_once('/')
            && record.pages.iter().all(|(of, _)| of != cut)
        {
            record.pages.push((cut.into(), Arc::clone(page)));
        }
        record.missing.push(request);
    }

    /// Notes that the draft needs tiles, after the hashes that check them.
    fn need(&self, record: &mut DraftRecord, page: &TexturePage, tiles: &[u32]) {
        let lists = tiles.iter().filter_map(|tile| self.tiles.list_address(page, *tile));
        lists.filter(|list| !self.tiles.is_here(list)).for_each(|list| record.need_alone(&list));
        tiles.iter().for_each(|tile| _ = record.need(&self.tiles.address(page, &[*tile])));
    }
}

impl TileSource for DraftTiles {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.tiles.offer(texture);
    }

    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        self.record.borrow_mut().announced += 1;
        self.tiles.announce(tiles);
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        if self.tiles.is_here(&self.tiles.address(page, &[tile])) {
            return self.tiles.tile(page, tile);
        }
        self.list(page, tile);
        self.tiles.pass(page, tile);
        let size = page.texels_of(tile).size();
        if let Some((_, grey)) = self.grey.iter().find(|(of, _)| *of == size) {
            return Ok(Arc::clone(grey));
        }
        let grey: Arc<[u8]> = self.tiles.encode(&vec![GREY; page.texels_in(tile) as usize], size)?.into();
        self.grey.push((size, Arc::clone(&grey)));
        Ok(grey)
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.tiles.known_bytes(texture, cut, |address| self.record.borrow_mut().need_alone(address))
    }
}

/// Picture of a draft: the last progressive picture of the last frame without grey tiles, if there is one.
#[derive(Debug)]
pub(crate) struct DraftPicture {
    record: Rc<RefCell<DraftRecord>>,
    /// Progressive pictures so far.
    shown: usize,
    /// The last complete picture, and its frame.
    complete: Option<(u32, RgbPicture)>,
}

impl DraftPicture {
    pub(crate) fn new(record: Rc<RefCell<DraftRecord>>) -> Self {
        Self { record, shown: 0, complete: None }
    }

    /// Receives the next progressive picture. Each has one list of tiles or none, and the lists before it.
    pub(crate) fn round(&mut self, frame: u32, picture: &RgbPicture) {
        if self.record.borrow().complete.is_none_or(|complete| self.shown < complete) {
            self.complete = Some((frame, picture.clone()));
        }
        self.shown += 1;
    }

    /// Returns the picture, for a run with this last frame.
    pub(crate) fn of_frame(self, last: u32) -> Option<RgbPicture> {
        self.complete.filter(|(frame, _)| *frame == last).map(|(_, picture)| picture)
    }
}

#[cfg(test)]
mod tests;
