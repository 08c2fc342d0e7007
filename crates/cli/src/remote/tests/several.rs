//! Several tiles by one request.

use super::*;

fn several(url: &str, requests: u32, tiles_per_request: u32) -> RemoteTiles {
    RemoteTiles::new(Fetcher::new(url, PATIENCE), fetch(requests, tiles_per_request), None, TileProgress::new(true))
}

#[test]
fn several_tiles_by_a_request_are_the_same_in_fewer_requests_and_nobody_stands_idle() {
    assert_eq!(page().tiles(), 11);
    // Each request takes its share, so that no thread waits for another's; 128 KiB of raw texels are ten tiles.
    for (requests, most, count) in [(1, 64, 2), (1, 5, 3), (4, 64, 4), (4, 2, 6), (100, 64, page().tiles())] {
        let (url, counted) = faulty(u32::MAX, |_| Fault::None);
        assert_eq!(all(&mut several(&url, requests, most)).unwrap(), expected());
        let asked = counted.load(Ordering::SeqCst);
        // Threads that are not there yet, or not idle yet, leave more to those that are.
        assert!(asked <= count && (asked == count || requests > 1), "{requests} at a time, of {most}: {asked}");
    }
}

#[test]
fn what_fails_together_is_asked_for_one_by_one_and_nothing_is_lost() {
    for fault in PASSING.into_iter().chain([Fault::Endless]) {
        let (url, count) = faulty(u32::MAX, move |n| if n == 0 { fault } else { Fault::None });
        assert_eq!(all(&mut several(&url, 1, 64)).unwrap(), expected(), "{fault:?}");
        assert_eq!(count.load(Ordering::SeqCst), 1 + page().tiles(), "{fault:?}");
    }
    let (url, count) = faulty(u32::MAX, |_| Fault::Corrupt);
    let (tile, error) = all(&mut several(&url, 1, 64)).unwrap_err();
    assert!(tile == 0 && error.ends_with("(attempt 3; at most 3 are made, none 20 s after the first)"), "{error}");
    drop(count);
}
