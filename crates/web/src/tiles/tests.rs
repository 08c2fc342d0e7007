//! Tests of requests over the connection, and of requests avoided by its cache.

use super::*;
use crate::connection::TransferTotals;
use crate::host_page::{HostPage, PageResponse};
use basrelief_deferred_renderer::{TextureMemory, TileEncoding};
use basrelief_input::MemoryPool;
use basrelief_signals::{Image, Sampler};
use basrelief_tile_server::protocol::{etag_of, hash_of_list, hash_of_picture, hash_of_received, hex, join};
use std::cell::RefCell;

/// Format of the tiles.
pub(crate) const RAW: TileFormat = TileFormat { size: [64, 64], encoding: TileEncoding::Raw, quality: 100 };

fn texture() -> Arc<Texture> {
    let texels = (0..200 * 90).map(|i: u32| [i as u8, (i / 7) as u8, (i / 200) as u8, 255]).collect();
    let levels = vec![Image { width: 200, height: 90, texels }];
    Arc::new(Texture { id: 4, name: "plane".into(), sampler: Sampler::default(), levels, offset: 0, elsewhere: None })
}

/// The same texture as a client sees it: without texels, but with the hash of its picture.
pub(crate) fn texture_without_texels() -> Arc<Texture> {
    let levels = vec![Image { width: 200, height: 90, texels: vec![] }];
    Arc::new(Texture { levels, elsewhere: Some(hash_of_picture(&texture())), ..Texture::clone(&texture()) })
}

/// Returns the list of the hashes of all tiles.
pub(crate) fn hash_list() -> Vec<u8> {
    let tiles: Vec<u32> = (1..page().tiles()).collect();
    let hash = |(body, tile): (&Arc<[u8]>, &u32)| hash_of_received(RAW, &page(), *tile, body).unwrap();
    expected(&tiles).iter().zip(&tiles).flat_map(hash).collect()
}

/// Returns the hashes in the scene.
pub(crate) fn hashes(list: &[u8]) -> Rc<GroupHashes> {
    let mut hashes = GroupHashes::default();
    let top = hash_of_received(RAW, &page(), 0, &expected(&[0])[0]).unwrap();
    hashes.insert(hash_of_picture(&texture()), vec![hash_of_list(&top), hash_of_list(list)]);
    Rc::new(hashes)
}

pub(crate) fn page() -> Arc<TexturePage> {
    Arc::new(TexturePage::new(0, &texture(), PyramidCut::default(), 0))
}

/// A server of that texture. `spoil` damages some responses.
#[derive(Debug)]
pub(crate) struct Server {
    asked: RefCell<Vec<String>>,
    spoil: fn(usize, &mut PageResponse),
}

impl Server {
    pub(crate) fn new(spoil: fn(usize, &mut PageResponse)) -> Rc<Self> {
        Rc::new(Self { asked: RefCell::default(), spoil })
    }

    pub(crate) fn requests(&self) -> usize {
        self.asked.borrow().len()
    }
}

impl HostPage for Server {
    fn get(&self, address: &str, _: bool) -> Result<PageResponse, String> {
        // Lists of hashes are answered without faults, and not counted.
        if address.starts_with("hashes/") {
            let body = hash_list();
            return Ok(PageResponse { status: 200, tag: etag_of(&body), body });
        }
        self.asked.borrow_mut().push(address.into());
        let numbers = address.strip_prefix(&format!("tile/{}/64x64/raw/", hex(&hash_of_picture(&texture()))));
        let mut memory = TextureMemory::new(TileEncoding::Raw, 100);
        memory.offer(&texture());
        let tiles = numbers.expect("an address of tiles").split(',').map(|n| memory.tile(&page(), n.parse().unwrap()).unwrap());
        let tiles: Vec<_> = tiles.collect();
        let mut several = vec![];
        tiles.iter().for_each(|tile| join(tile, &mut several));
        let body = if let [one] = &tiles[..] { one.to_vec() } else { several };
        let mut got = PageResponse { status: 200, tag: etag_of(&body), body };
        (self.spoil)(self.requests(), &mut got);
        Ok(got)
    }

    fn show(&self, _: Vec<u8>) {}
}

pub(crate) fn path(server: &Rc<Server>, budget: &MemoryPool) -> Rc<ServerConnection> {
    Rc::new(ServerConnection::new(Rc::<Server>::clone(server), "http://a/", budget))
}

/// Announces tiles and takes them in order.
fn take(path: &Rc<ServerConnection>, tiles: &[u32]) -> Result<Vec<Arc<[u8]>>, String> {
    take_with(path, hashes(&hash_list()), tiles)
}

fn take_with(path: &Rc<ServerConnection>, hashes: Rc<GroupHashes>, tiles: &[u32]) -> Result<Vec<Arc<[u8]>>, String> {
    let mut source = PathTiles::new(Rc::clone(path), hashes, RAW);
    source.offer(&texture_without_texels());
    source.announce(&tiles.iter().map(|tile| (page(), *tile)).collect::<Vec<_>>());
    tiles.iter().map(|tile| source.tile(&page(), *tile)).collect()
}

pub(crate) fn expected(tiles: &[u32]) -> Vec<Arc<[u8]>> {
    let mut memory = TextureMemory::new(TileEncoding::Raw, 100);
    memory.offer(&texture());
    tiles.iter().map(|tile| memory.tile(&page(), *tile).unwrap()).collect()
}

// Claim: defer, viewer: A browser draws the same image from a server as the program, to the bit. It fetches no tile twice and
// rejects wrong tiles.
#[test]
fn page_batches_missing_tiles() {
    let server = Server::new(|_, _| ());
    let path = path(&server, &MemoryPool::default());
    assert_eq!(take(&path, &[3, 0, 5]).unwrap(), expected(&[3, 0, 5]));
    assert_eq!(server.requests(), 1, "{server:?}");
    assert!(server.asked.borrow()[0].ends_with("/3,0,5"));
    assert_eq!(take(&path, &[0, 1, 3, 2]).unwrap(), expected(&[0, 1, 3, 2]));
    assert!(server.requests() == 2 && server.asked.borrow()[1].ends_with("/1,2"), "{server:?}");
    assert_eq!(take(&path, &[5, 2]).unwrap(), expected(&[5, 2]));
    let bytes: usize = expected(&[0, 1, 2, 3, 5]).iter().map(|tile| tile.len()).sum();
    // Two requests of tiles, and one of their hashes.
    assert_eq!(path.totals(), TransferTotals { requests: 3, scene_bytes: 0, tiles: 5, tile_bytes: bytes as u64 });
}

// Claim: as page_batches_missing_tiles.
#[test]
fn full_memory_refetches_tiles() {
    let server = Server::new(|_, _| ());
    let path = path(&server, &MemoryPool::new(0));
    for _ in 0..2 {
        assert_eq!(take(&path, &[3, 0, 5]).unwrap(), expected(&[3, 0, 5]));
    }
    assert_eq!(server.requests(), 2, "{server:?}");
}

// Claim: as page_batches_missing_tiles.
#[test]
fn wrong_response_is_retried_and_not_cached() {
    let spoils: [fn(usize, &mut PageResponse); 6] = [
        |_, got| got.status = 500,
        |_, got| got.tag.clear(),
        |_, got| got.body[9] ^= 1,
        |_, got| got.body.truncate(7),
        // Not tiles, but with a matching hash.
        |_, got| (got.tag, got.body) = (etag_of(b"other"), b"other".to_vec()),
        // Other tiles, with a matching hash.
        |_, got| {
            got.body = vec![];
            expected(&[0, 1]).iter().for_each(|tile| join(tile, &mut got.body));
            got.tag = etag_of(&got.body);
        },
    ];
    for (n, spoil) in spoils.into_iter().enumerate() {
        let server = Server::new(spoil);
        let error = take(&path(&server, &MemoryPool::default()), &[3, 0, 5]).unwrap_err();
        assert_eq!(server.requests(), 3, "{n}: {error}");
        assert!(error.starts_with("texture 4 (plane), layer 2, tile 3: http://a/tile/"), "{n}: {error}");
        assert!(error.ends_with("(attempt 3, and no more are made)"), "{n}: {error}");
    }
    let server = Server::new(|request, got| {
        if request < 3 {
            got.body[0] ^= 1
        }
    });
    assert_eq!(take(&path(&server, &MemoryPool::default()), &[3, 0, 5]).unwrap(), expected(&[3, 0, 5]));
}

#[test]
fn lying_tile_is_an_error_that_names_it() {
    // A tile of the right size, with a matching hash of the response.
    let server = Server::new(|_, got| {
        got.body[9] ^= 1;
        got.tag = etag_of(&got.body);
    });
    let error = take(&path(&server, &MemoryPool::default()), &[3]).unwrap_err();
    assert!(error.starts_with("texture 4 (plane), layer 2, tile 3: http://a/tile/"), "{error}");
    assert!(error.contains("not the tile that the scene states"), "{error}");
    let server = Server::new(|_, _| ());
    let error = take_with(&path(&server, &MemoryPool::default()), hashes(b"other"), &[3]).unwrap_err();
    assert!(error.contains("/hashes/") && error.contains("not the list that the scene states"), "{error}");
}
