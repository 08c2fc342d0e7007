//! Changes of view.

use super::*;
use crate::client::TransferMetrics;
use std::sync::mpsc::{Sender, channel};

/// Returns the tiles of the page, starting at tile `first`.
fn from(page: &Arc<TexturePage>, first: u32) -> impl Iterator<Item = (Arc<TexturePage>, u32)> {
    (first..page.tiles()).map(|tile| (Arc::clone(page), tile))
}

/// State of a client that has left a view.
struct LeftView {
    tiles: RemoteTiles,
    taken: Vec<Arc<[u8]>>,
    meter: TransferMetrics,
    count: Arc<AtomicU32>,
}

/// Time at which the client leaves the first view: late enough for two tiles, even on a busy computer.
const LEFT_AT_MS: f64 = 1500.0;

/// A server whose response number `late` waits until the sender is dropped, and then closes its connection.
fn delaying_server(late: u32) -> (String, Arc<AtomicU32>, Sender<()>) {
    let (listener, url, count) = listening();
    let (release, held) = channel();
    let counted = Arc::clone(&count);
    thread::spawn(move || {
        let (served, mut held) = (Arc::new(served()), Some(held));
        for stream in listener.incoming().flatten() {
            let number = counted.fetch_add(1, Ordering::SeqCst);
            let (served, held) = (Arc::clone(&served), held.take_if(|_| number == late));
            thread::spawn(move || match held {
                // `recv` fails once the sender is dropped.
                Some(held) => drop((held.recv(), stream)),
                None => respond(&served, stream, ResponseFault::None),
            });
        }
    });
    (url, count, release)
}

/// Fetches tiles until the client leaves the first view. Answer number `late` does not arrive before that.
fn left_at(late: u32, in_flight: u32) -> LeftView {
    let (url, count, release) = delaying_server(late);
    let fetcher = new_fetcher(&url, PATIENT);
    let meter = fetcher.metrics().clone();
    fetcher.scene("scene", |_| ()).unwrap();
    let fetch = TileFetch { left_at_ms: vec![LEFT_AT_MS], ..fetch(in_flight, 1) };
    let mut tiles = source_without_cache(fetcher, fetch);
    tiles.offer(&texture_without_texels());
    let (user, page) = (tiles.user().unwrap(), page());
    user.turn_to(0);
    let mut taken = Vec::new();
    while !user.leaves(&mut from(&page, taken.len() as u32)) {
        taken.push(tiles.tile(&page, taken.len() as u32).unwrap());
    }
    drop(release);
    LeftView { tiles, taken, meter, count }
}

// Claim: as slow_path_does_not_delay_view_changes.
#[test]
fn abandoned_view_leaves_tiles_to_next() {
    // The answers are the scene, two tiles, and a tile that is held back.
    let LeftView { mut tiles, mut taken, meter, count } = left_at(3, 1);
    let (user, page) = (tiles.user().unwrap(), page());
    assert_eq!(taken.len(), 2, "those that have come in time");
    assert!(meter.elapsed().milliseconds >= LEFT_AT_MS, "{:?}", meter.elapsed());
    assert_eq!(meter.read().abandoned, u64::from(page.tiles()) - 3, "all but those, and what is under way");
    user.turn_to(1);
    while (taken.len() as u32) < page.tiles() {
        assert!(!user.leaves(&mut from(&page, taken.len() as u32)), "the last view is not left");
        taken.push(tiles.tile(&page, taken.len() as u32).unwrap());
    }
    assert_eq!(taken, expected());
    assert_eq!(count.load(Ordering::SeqCst), 1 + page.tiles() + 1, "each once, and again what had not come");
}

#[test]
fn received_tiles_serve_the_next_view() {
    // One of the two requests in flight waits, and the other fetches all remaining tiles.
    let LeftView { mut tiles, mut taken, count, .. } = left_at(2, 2);
    let (user, page) = (tiles.user().unwrap(), page());
    user.turn_to(1);
    assert!((taken.len() as u32) < page.tiles() - 1, "{}", taken.len());
    while (taken.len() as u32) < page.tiles() {
        assert!(!user.leaves(&mut from(&page, taken.len() as u32)), "the last view is not left");
        taken.push(tiles.tile(&page, taken.len() as u32).unwrap());
    }
    assert_eq!(taken, expected());
    assert_eq!(count.load(Ordering::SeqCst), 1 + page.tiles() + 1, "the scene, each once, and again what had not come");
}

#[test]
fn next_view_skips_unrequested_tiles() {
    let LeftView { mut tiles, taken, count, .. } = left_at(3, 1);
    tiles.user().unwrap().turn_to(1);
    let (page, last) = (page(), page().tiles() - 1);
    assert_eq!(taken.len(), 2);
    assert!(!tiles.user().unwrap().leaves(&mut from(&page, last)), "the last view is not left");
    assert_eq!(tiles.tile(&page, last).unwrap(), expected()[last as usize]);
    assert_eq!(count.load(Ordering::SeqCst), 1 + 2 + 2 + 1, "the scene, two tiles, one that was under way, again, and the last");
}

#[test]
fn expired_view_requests_no_more_tiles() {
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::Late);
    let fetcher = new_fetcher(&url, PATIENT);
    fetcher.scene("scene", |_| ()).unwrap();
    let fetch = TileFetch { left_at_ms: vec![2.5 * LATE.as_secs_f64() * 1e3], ..fetch(1, 1) };
    let mut tiles = source_without_cache(fetcher, fetch);
    tiles.offer(&texture_without_texels());
    let (user, page) = (tiles.user().unwrap(), page());
    user.turn_to(0);
    user.leaves(&mut from(&page, 0));
    thread::sleep(6 * LATE);
    let asked = count.load(Ordering::SeqCst);
    assert!(asked <= 3, "the scene, a tile, and one under way: {asked}");
    assert!(user.leaves(&mut from(&page, 1)));
}

// Claim: as slow_path_does_not_delay_view_changes.
#[test]
fn view_starts_at_its_time() {
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::None);
    let fetcher = new_fetcher(&url, PATIENT);
    let meter = fetcher.metrics().clone();
    fetcher.scene("scene", |_| ()).unwrap();
    let mut tiles = source_without_cache(fetcher, TileFetch { left_at_ms: vec![120.0], ..fetch(4, 1) });
    announce_all(&mut tiles);
    let user = tiles.user().unwrap();
    user.turn_to(0);
    user.turn_to(1);
    assert!(meter.elapsed().milliseconds >= 120.0, "{:?}", meter.elapsed());
    assert_eq!(count.load(Ordering::SeqCst), 1, "who looks says what is asked for");
}
