//! Faults that pass, and faults that stay.

use super::super::client::MOST_AHEAD;
use super::*;
use std::time::Instant;

#[test]
fn tiles_come_as_they_are_whatever_the_requests_in_flight() {
    for in_flight in [1, 4, 100] {
        let (url, count) = faulty(u32::MAX, |_| Fault::None);
        assert_eq!(all(&mut tiles(&url, in_flight, None)).unwrap(), expected());
        assert_eq!(count.load(Ordering::SeqCst), page().tiles());
    }
}

#[test]
fn what_nobody_takes_is_not_fetched_without_end_and_what_is_asked_for_comes_all_the_same() {
    let (url, count) = faulty(u32::MAX, |_| Fault::None);
    let mut tiles = tiles(&url, 4, None);
    let page = Arc::new(Page::new(0, &texture(), Cut { tile: [4, 4], ..Cut::default() }, 0));
    let all: Vec<_> = (0..page.tiles()).map(|tile| (Arc::clone(&page), tile)).collect();
    tiles.announce(&all);
    let fetched = || count.load(Ordering::SeqCst) as usize;
    while fetched() < MOST_AHEAD {
        thread::sleep(Duration::from_millis(1));
    }
    // A little more than a request takes: those under way come to their end.
    thread::sleep(Duration::from_millis(100));
    assert!((MOST_AHEAD..MOST_AHEAD + 4).contains(&fetched()), "{} of {}", fetched(), all.len());
    tiles.tile(&page, page.tiles() - 1).unwrap();
    // The last is taken last; up to three before it may be under way.
    assert!((all.len() - 3..=all.len()).contains(&fetched()), "{} of {}", fetched(), all.len());
}

#[test]
fn a_fault_that_passes_is_tried_again_and_nothing_is_lost() {
    for fault in [
        Fault::Status(500),
        Fault::Status(404),
        Fault::Corrupt,
        Fault::Truncated,
        Fault::Cut,
        Fault::Silent,
        Fault::Stalled,
        Fault::Dripping,
        Fault::Undecodable,
        Fault::OtherSize,
    ] {
        let (url, count) = faulty(u32::MAX, move |n| if n == 2 { fault } else { Fault::None });
        assert_eq!(all(&mut tiles(&url, 2, None)).unwrap(), expected(), "{fault:?}");
        assert_eq!(count.load(Ordering::SeqCst), page().tiles() + 1, "{fault:?}");
    }
}

#[test]
fn a_fault_that_stays_is_an_error_that_names_texture_layer_and_tile() {
    for (fault, says) in [
        (Fault::Status(500), "status: 500"),
        (Fault::Status(404), "status: 404"),
        (Fault::Status(302), "status: 302"),
        (Fault::Endless, "too long"),
        (Fault::Corrupt, "hash"),
        (Fault::Truncated, "disconnected"),
        (Fault::Cut, "disconnected"),
        (Fault::Silent, "nothing has come for 0.3 s"),
        (Fault::Stalled, "nothing has come for 0.3 s"),
        (Fault::Dripping, "less than 1000 bytes/s"),
        (Fault::Undecodable, "corrupt: "),
        (Fault::OtherSize, "picture of 3 x 2, expected RGB of 50 x 23"),
    ] {
        let (url, _) = faulty(u32::MAX, move |_| fault);
        let (tile, error) = all(&mut tiles(&url, 1, None)).unwrap_err();
        assert_eq!(tile, 0);
        assert!(error.starts_with("texture 4 (plane), layer 0, tile 0: http://"), "{error}");
        assert!(error.contains(says), "{fault:?}: {error}");
        assert!(error.ends_with("(attempt 3; at most 3 are made, none 20 s after the first)"), "{error}");
    }
}

#[test]
fn a_server_that_has_other_textures_by_now_is_found_out() {
    let (url, _) = faulty(u32::MAX, |n| if n < 2 { Fault::None } else { Fault::OtherTextures });
    let mut fetcher = Fetcher::new(&url, PATIENCE);
    assert_eq!(fetcher.polygons(|_| ()).unwrap(), (b"list".to_vec(), hash_of(b"textures")));
    let mut tiles = RemoteTiles::new(fetcher, (TileEncoding::Png, 85), 1, None, TileProgress::new(true));
    let (tile, error) = all(&mut tiles).unwrap_err();
    assert_eq!(tile, 1);
    assert!(error.contains("other textures"), "{error}");
}

#[test]
fn attempts_end_when_their_time_is_over() {
    let (url, count) = faulty(u32::MAX, |_| Fault::Stalled);
    let began = Instant::now();
    let patience = Patience { attempts: 100, whole: 3 * PATIENCE.stall / 2, ..PATIENCE };
    let mut fetcher = Fetcher::new(&url, patience);
    let error = fetcher.polygons(|_| ()).unwrap_err();
    assert!(error.contains("attempt 2; at most 100 are made, none 0.45 s after the first"), "{error}");
    assert!(error.ends_with("is `basrelief serve` running there?"), "{error}");
    assert_eq!(count.load(Ordering::SeqCst), 2);
    assert!(began.elapsed() < Duration::from_secs(10), "{:?}", began.elapsed());
}

#[test]
fn who_gives_up_waits_for_nobody() {
    let (url, count) = faulty(u32::MAX, |_| Fault::Stalled);
    let patience = Patience { stall: Duration::from_secs(100), ..PATIENCE };
    let fetcher = Fetcher::new(&url, patience);
    let mut tiles = RemoteTiles::new(fetcher, (TileEncoding::Png, 85), 4, None, TileProgress::new(true));
    announce_all(&mut tiles);
    while count.load(Ordering::SeqCst) < 4 {
        thread::sleep(Duration::from_millis(1));
    }
    let began = Instant::now();
    drop(tiles);
    // The server lets go before that, but not before it has slept.
    assert!(began.elapsed() < 2 * PATIENCE.stall, "{:?}", began.elapsed());
}
