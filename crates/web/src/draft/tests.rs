//! Tests of drafts: their lists of missing data, and responses for them.

use super::*;
use crate::connection::{ServerConnection, TransferTotals};
use crate::host_page::HostPage as _;
use crate::tiles::tests::{RAW, Server, expected, hash_list, hashes, page, path, texture_without_texels};
use basrelief_input::MemoryPool;

fn tiles(path: &Rc<ServerConnection>) -> PathTiles {
    PathTiles::new(Rc::clone(path), hashes(&hash_list()), RAW)
}

/// Draws with these tiles in one list. Returns them and the record.
fn draft(path: &Rc<ServerConnection>, pending: &[&str], wanted: &[u32]) -> (Vec<Arc<[u8]>>, Rc<RefCell<DraftRecord>>) {
    let record = DraftRecord::new(pending.iter().map(|address| (*address).into()).collect());
    let mut source = DraftTiles::new(tiles(path), Rc::clone(&record));
    source.offer(&texture_without_texels());
    source.announce(&wanted.iter().map(|tile| (page(), *tile)).collect::<Vec<_>>());
    (wanted.iter().map(|tile| source.tile(&page(), *tile).unwrap()).collect(), record)
}

/// Fetches an address from the server as the page does, and passes the response on.
fn deliver(server: &Rc<Server>, path: &Rc<ServerConnection>, address: &str) -> Result<(), String> {
    tiles(path).receive(address, Some(&page()), server.get(address, false).unwrap())
}

fn grey(tile: u32) -> Vec<u8> {
    vec![GREY[0]; 3 * page().texels_in(tile) as usize]
}

#[test]
fn draft_lists_missing_tiles_without_requests() {
    let server = Server::new(|_, _| ());
    let path = path(&server, &MemoryPool::default());
    let (drawn, record) = draft(&path, &[], &[3, 0, 5]);
    assert_eq!(drawn.iter().map(|tile| tile.to_vec()).collect::<Vec<_>>(), [3, 0, 5].map(grey));
    let record = record.borrow();
    let [list, batch] = &record.missing[..] else { panic!("{record:?}") };
    assert!(list.starts_with("hashes/") && list.ends_with("/1") && batch.ends_with("/3,0,5"), "{record:?}");
    assert!(!record.is_complete() && server.requests() == 0);
    assert_eq!(record.pages.len(), 1);
}

#[test]
fn delivered_tiles_complete_a_draft() {
    let server = Server::new(|_, _| ());
    let path = path(&server, &MemoryPool::default());
    let (_, record) = draft(&path, &[], &[3, 0, 5]);
    record.borrow().missing.iter().for_each(|address| deliver(&server, &path, address).unwrap());
    let requests = server.requests();
    let (drawn, record) = draft(&path, &[], &[3, 0, 5]);
    assert_eq!(drawn, expected(&[3, 0, 5]));
    assert!(record.borrow().is_complete() && server.requests() == requests);
    let bytes = drawn.iter().map(|tile| tile.len() as u64).sum();
    assert_eq!(path.totals(), TransferTotals { requests: 2, scene_bytes: 0, tiles: 3, tile_bytes: bytes });
}

#[test]
fn requested_tiles_are_not_listed_again() {
    let server = Server::new(|_, _| ());
    let path = path(&server, &MemoryPool::default());
    let (_, record) = draft(&path, &[], &[3, 0]);
    let [list, batch] = <[String; 2]>::try_from(record.borrow().missing.clone()).unwrap();
    let (_, record) = draft(&path, &[&list, &batch, "tile/other/64x64/raw/3"], &[3, 5]);
    let record = record.borrow();
    assert_eq!(record.needed, [list, batch]);
    assert!(matches!(&record.missing[..], [more] if more.ends_with("/5")), "{record:?}");
}

#[test]
fn hashes_of_requested_tiles_are_needed() {
    let server = Server::new(|_, _| ());
    let path = path(&server, &MemoryPool::default());
    let (_, record) = draft(&path, &[], &[3]);
    let listed = record.borrow().missing.clone();
    let (_, record) = draft(&path, &[&listed[1], &listed[0]], &[3]);
    assert_eq!((&record.borrow().needed, &record.borrow().missing), (&listed, &vec![]));
}

#[test]
fn wrong_response_leaves_a_tile_missing() {
    let server = Server::new(|_, got| got.body[9] ^= 1);
    let path = path(&server, &MemoryPool::default());
    let (_, record) = draft(&path, &[], &[3]);
    let missing = record.borrow().missing.clone();
    assert_eq!(deliver(&server, &path, &missing[0]), Ok(()));
    assert!(deliver(&server, &path, &missing[1]).unwrap_err().contains("corrupt"));
    for address in ["tile/x", "scene/64x64/raw", "tile/a/64x64/raw/b"] {
        assert!(tiles(&path).receive(address, None, Default::default()).is_err(), "{address}");
    }
    let (_, record) = draft(&path, &[], &[3]);
    assert_eq!(record.borrow().missing, missing[1..]);
}

#[test]
fn draft_shows_the_last_complete_picture() {
    let picture = |n: usize| RgbPicture::drawn([1, 1], vec![[n as u8; 3]], vec![true]);
    let shown = |complete: Option<usize>, rounds: usize, last: u32| {
        let record = DraftRecord::new(vec![]);
        record.borrow_mut().complete = complete;
        let mut draft = DraftPicture::new(record);
        (0..rounds).for_each(|n| draft.round(0, &picture(n)));
        draft.of_frame(last)
    };
    assert_eq!(shown(Some(2), 4, 0), Some(picture(1)));
    assert_eq!(shown(None, 4, 0), Some(picture(3)));
    assert_eq!((shown(Some(0), 4, 0), shown(Some(2), 4, 1)), (None, None));
}
