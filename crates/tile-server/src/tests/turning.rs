//! A user who turns to the next view.

use super::*;
use crate::client::TransferMetrics;
use std::sync::mpsc::{Sender, channel};

/// The tiles of the page, from this one on.
fn from(page: &Arc<TexturePage>, first: u32) -> impl Iterator<Item = (Arc<TexturePage>, u32)> {
    (first..page.tiles()).map(|tile| (Arc::clone(page), tile))
}

/// Who has looked at a view that is left by now.
struct Left {
    tiles: RemoteTiles,
    taken: Vec<Arc<[u8]>>,
    meter: TransferMetrics,
    count: Arc<AtomicU32>,
}

/// When the first view is left: late enough for two tiles to have come, however busy the computer.
const LEFT_AT_MS: f64 = 1500.0;

/// A server whose answer number `late` does not come before the other end of this is gone, and then its connection is cut.
fn holding(late: u32) -> (String, Arc<AtomicU32>, Sender<()>) {
    let (listener, url, count) = listening();
    let (release, held) = channel();
    let counted = Arc::clone(&count);
    thread::spawn(move || {
        let (served, mut held) = (Arc::new(served()), Some(held));
        for stream in listener.incoming().flatten() {
            let number = counted.fetch_add(1, Ordering::SeqCst);
            let (served, held) = (Arc::clone(&served), held.take_if(|_| number == late));
            thread::spawn(move || match held {
                // Until that is an error.
                Some(held) => drop((held.recv(), stream)),
                None => respond(&served, stream, Fault::None),
            });
        }
    });
    (url, count, release)
}

/// Looks, until the first view is left in place of a tile that does not come before that: the answer number `late`.
fn left_at(late: u32, in_flight: u32) -> Left {
    let (url, count, release) = holding(late);
    let fetcher = Fetcher::new(&url, PATIENT);
    let meter = fetcher.meter().clone();
    fetcher.scene(|_| ()).unwrap();
    let fetch = TileFetch { left_at_ms: vec![LEFT_AT_MS], ..fetch(in_flight, 1) };
    let mut tiles = unkept(fetcher, fetch);
    tiles.offer(&elsewhere());
    let (user, page) = (tiles.user().unwrap(), page());
    user.turn_to(0);
    let mut taken = Vec::new();
    while !user.leaves(&mut from(&page, taken.len() as u32)) {
        taken.push(tiles.tile(&page, taken.len() as u32).unwrap());
    }
    drop(release);
    Left { tiles, taken, meter, count }
}

#[test]
fn a_view_that_is_left_asks_for_no_more_and_the_next_takes_what_has_come() {
    // The scene, two tiles, and one that does not come for long.
    let Left { mut tiles, mut taken, meter, count } = left_at(3, 1);
    let (user, page) = (tiles.user().unwrap(), page());
    assert_eq!(taken.len(), 2, "those that have come in time");
    assert!(meter.now().milliseconds >= LEFT_AT_MS, "{:?}", meter.now());
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
fn what_had_come_for_a_view_and_was_not_taken_is_not_asked_for_again() {
    // Of two requests in flight one waits, and the other brings all the rest.
    let Left { mut tiles, mut taken, count, .. } = left_at(2, 2);
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
fn the_next_view_waits_for_nothing_that_the_one_before_had_listed_and_not_asked_for() {
    let Left { mut tiles, taken, count, .. } = left_at(3, 1);
    tiles.user().unwrap().turn_to(1);
    let (page, last) = (page(), page().tiles() - 1);
    assert_eq!(taken.len(), 2);
    assert!(!tiles.user().unwrap().leaves(&mut from(&page, last)), "the last view is not left");
    assert_eq!(tiles.tile(&page, last).unwrap(), expected()[last as usize]);
    assert_eq!(count.load(Ordering::SeqCst), 1 + 2 + 2 + 1, "the scene, two tiles, one that was under way, again, and the last");
}

#[test]
fn behind_its_time_a_view_asks_for_no_more_though_the_device_is_at_work_and_has_not_left_it() {
    let (url, count) = faulty(u32::MAX, |_| Fault::Late);
    let fetcher = Fetcher::new(&url, PATIENT);
    fetcher.scene(|_| ()).unwrap();
    let fetch = TileFetch { left_at_ms: vec![2.5 * LATE.as_secs_f64() * 1e3], ..fetch(1, 1) };
    let mut tiles = unkept(fetcher, fetch);
    tiles.offer(&elsewhere());
    let (user, page) = (tiles.user().unwrap(), page());
    user.turn_to(0);
    user.leaves(&mut from(&page, 0));
    thread::sleep(6 * LATE);
    let asked = count.load(Ordering::SeqCst);
    assert!(asked <= 3, "the scene, a tile, and one under way: {asked}");
    assert!(user.leaves(&mut from(&page, 1)));
}

#[test]
fn a_view_does_not_begin_before_its_time_and_what_was_announced_for_another_is_no_matter() {
    let (url, count) = faulty(u32::MAX, |_| Fault::None);
    let fetcher = Fetcher::new(&url, PATIENT);
    let meter = fetcher.meter().clone();
    fetcher.scene(|_| ()).unwrap();
    let mut tiles = unkept(fetcher, TileFetch { left_at_ms: vec![120.0], ..fetch(4, 1) });
    announce_all(&mut tiles);
    let user = tiles.user().unwrap();
    user.turn_to(0);
    user.turn_to(1);
    assert!(meter.now().milliseconds >= 120.0, "{:?}", meter.now());
    assert_eq!(count.load(Ordering::SeqCst), 1, "who looks says what is asked for");
}
