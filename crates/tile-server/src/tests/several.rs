//! Several tiles per request.

use super::*;

fn several(url: &str, requests: u32, tiles_per_request: u32) -> RemoteTiles {
    source_without_cache(new_fetcher(url, PATIENT), fetch(requests, tiles_per_request))
}

// Claim: defer, real path: Several tiles per request are the same tiles in fewer requests. A failed batch is repeated as single
// tiles.
#[test]
fn batched_requests_keep_all_threads_busy() {
    assert_eq!(page().tiles(), 11);
    // Each request takes a share of the tiles, so no thread waits for another. 128 KiB of raw texels are ten tiles.
    for (requests, most, count) in [(1, 64, 2), (1, 5, 3), (4, 64, 4), (4, 2, 6), (100, 64, page().tiles())] {
        let (url, counted) = faulty(u32::MAX, |_| ResponseFault::Late);
        let mut tiles = several(&url, requests, most);
        // A thread that starts late leaves more tiles to the running threads, so the test waits for all threads.
        thread::sleep(5 * LATE);
        assert_eq!(all(&mut tiles).unwrap(), expected());
        // A thread that is idle again also takes a share.
        let asked = counted.load(Ordering::SeqCst);
        let most_asked = if requests == 1 { count } else { page().tiles() };
        assert!((count..=most_asked).contains(&asked), "{requests} at a time, of {most}: {asked}");
    }
}

// Claim: as batched_requests_keep_all_threads_busy.
#[test]
fn failed_batch_is_retried_tile_by_tile() {
    for fault in PASSING.into_iter().chain([ResponseFault::Endless]) {
        let (url, count) = faulty(u32::MAX, move |n| if n == 0 { fault } else { ResponseFault::None });
        assert_eq!(
            all(&mut source_without_cache(new_fetcher(&url, retry_policy(fault)), fetch(1, 64))).unwrap(),
            expected(),
            "{fault:?}"
        );
        assert_eq!(count.load(Ordering::SeqCst), 1 + page().tiles(), "{fault:?}");
    }
    // A failed batch counts as one attempt for each of its tiles.
    let (url, _) = faulty(u32::MAX, |n| if n < PATIENT.attempts { ResponseFault::Corrupt } else { ResponseFault::None });
    let (tile, error) = all(&mut several(&url, 1, 64)).unwrap_err();
    assert!(tile == 0 && error.ends_with("(attempt 3; at most 3 are made, none 20 s after the first)"), "{error}");
}
