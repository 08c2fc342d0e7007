//! Transient and permanent faults.

use super::*;
use crate::client::MAX_AHEAD;
use crate::server::ServerLimits;
use std::time::Instant;

#[test]
fn tiles_are_equal_for_any_requests_in_flight() {
    for in_flight in [1, 4, 100] {
        let (url, count) = faulty(u32::MAX, |_| ResponseFault::None);
        assert_eq!(all(&mut tiles(&url, in_flight, None)).unwrap(), expected());
        assert_eq!(count.load(Ordering::SeqCst), page().tiles());
    }
}

#[test]
fn prefetch_is_bounded() {
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::None);
    let mut tiles =
        source_without_cache(new_fetcher(&url, PATIENT), TileFetch { format: TileFormat { size: [4, 4], ..PNG }, ..fetch(4, 1) });
    let page = Arc::new(TexturePage::new(0, &texture(), PyramidCut { tile: [4, 4], ..PyramidCut::default() }, 0));
    let all: Vec<_> = (0..page.tiles()).map(|tile| (Arc::clone(&page), tile)).collect();
    tiles.offer(&texture_without_texels());
    tiles.announce(&all);
    let fetched = || count.load(Ordering::SeqCst) as usize;
    while fetched() < MAX_AHEAD {
        thread::sleep(Duration::from_millis(1));
    }
    // The pause exceeds the time of a request, so requests in flight end.
    thread::sleep(Duration::from_millis(100));
    assert!((MAX_AHEAD..MAX_AHEAD + 4).contains(&fetched()), "{} of {}", fetched(), all.len());
    tiles.tile(&page, page.tiles() - 1).unwrap();
    // The last tile is requested last. Up to three requests before it may still be in flight.
    assert!((all.len() - 3..=all.len()).contains(&fetched()), "{} of {}", fetched(), all.len());
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn passing_fault_is_retried_without_loss() {
    for fault in PASSING.into_iter().chain([ResponseFault::Status(404)]) {
        let (url, count) = faulty(u32::MAX, move |n| if n == 2 { fault } else { ResponseFault::None });
        assert_eq!(
            all(&mut source_without_cache(new_fetcher(&url, retry_policy(fault)), fetch(2, 1))).unwrap(),
            expected(),
            "{fault:?}"
        );
        assert_eq!(count.load(Ordering::SeqCst), page().tiles() + 1, "{fault:?}");
    }
}

/// The path sends one answer at a time, as a modem does. The eighth answer begins after the seven before it have arrived.
#[test]
fn slow_path_is_no_timeout() {
    let path = Arc::new(std::sync::Mutex::new(()));
    let (listener, url, count) = listening();
    let counted = Arc::clone(&count);
    thread::spawn(move || {
        let served = Arc::new(served());
        for stream in listener.incoming().flatten() {
            counted.fetch_add(1, Ordering::SeqCst);
            let (served, path) = (Arc::clone(&served), Arc::clone(&path));
            thread::spawn(move || {
                let _turn = path.lock();
                thread::sleep(HASTY.stall / 4);
                respond(&served, stream, ResponseFault::None);
            });
        }
    });
    let mut tiles = source_without_cache(new_fetcher(&url, HASTY), fetch(8, 1));
    assert_eq!(all(&mut tiles).unwrap(), expected());
    assert_eq!(count.load(Ordering::SeqCst), page().tiles(), "none is asked for again");
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn lasting_fault_names_texture_layer_and_tile() {
    for (fault, says) in [
        (ResponseFault::Status(500), "status: 500"),
        (ResponseFault::Status(404), "status: 404"),
        (ResponseFault::Status(302), "status: 302"),
        (ResponseFault::Endless, "too long"),
        (ResponseFault::Corrupt, "hash"),
        (ResponseFault::Truncated, "disconnected"),
        (ResponseFault::Cut, "disconnected"),
        (ResponseFault::Silent, "nothing has come for 1 s"),
        (ResponseFault::Stalled, "nothing has come for 1 s"),
        (ResponseFault::Dripping, "less than 1000 bytes/s"),
        (ResponseFault::DrippingHead, "too slow: the head of the answer takes more than 1 s"),
        (ResponseFault::Undecodable, "corrupt: "),
        (ResponseFault::OtherSize, "image of 3 x 2, expected RGB of 50 x 23"),
    ] {
        let (url, _) = faulty(u32::MAX, move |_| fault);
        let (tile, error) = all(&mut source_without_cache(new_fetcher(&url, retry_policy(fault)), fetch(1, 1))).unwrap_err();
        assert_eq!(tile, 0);
        assert!(error.starts_with("texture 4 (plane), layer 0, tile 0: http://"), "{error}");
        assert!(error.contains(says), "{fault:?}: {error}");
        assert!(error.ends_with("(attempt 3; at most 3 are made, none 20 s after the first)"), "{error}");
    }
}

#[test]
fn server_with_other_scene_is_detected() {
    let other =
        Arc::new(Texture { levels: vec![Image { width: 1, height: 1, texels: vec![[1; 4]] }], ..Texture::clone(&texture()) });
    let (address, _server) =
        SceneService::new(vec![], String::new(), [other]).listen(([127, 0, 0, 1], 0).into(), ServerLimits::default()).unwrap();
    let (tile, error) = all(&mut tiles(&format!("http://{address}"), 1, None)).unwrap_err();
    assert_eq!(tile, 0);
    assert!(error.contains("http status: 404; the server may have another scene by now"), "{error}");
}

/// Returns a policy that waits this long for a server to start.
fn waiting(starting: Duration) -> RetryPolicy {
    RetryPolicy { starting, ..PATIENT }
}

#[test]
fn late_server_is_awaited_within_limit() {
    let address = listener_of_its_own().local_addr().unwrap();
    let url = format!("http://{address}");
    let error = new_fetcher(&url, waiting(Duration::ZERO)).scene("scene", |_| ()).unwrap_err();
    assert!(error.starts_with(&format!("{url}/scene: ")) && error.contains("refused"), "{error}");
    assert!(error.ends_with(", for 0 s; is `basrelief serve` running there?"), "{error}");
    let began = Instant::now();
    let late = Duration::from_millis(500);
    thread::spawn(move || {
        thread::sleep(late);
        served().listen(address, ServerLimits::default()).unwrap().1.join()
    });
    assert_eq!(new_fetcher(&url, waiting(Duration::from_secs(20))).scene("scene", |_| ()).unwrap().1[..5], *b"scene");
    assert!(began.elapsed() >= late);
}

// Claim: as crowded_clients_get_every_tile.
#[test]
fn restarting_server_is_awaited_within_limit() {
    for (starting, comes_back) in [(Duration::from_secs(20), true), (Duration::ZERO, false)] {
        let (url, count) = faulty(5, |_| ResponseFault::None);
        let address = url.trim_start_matches("http://").trim_end_matches('/').parse::<std::net::SocketAddr>().unwrap();
        let fetcher = new_fetcher(&url, waiting(starting));
        let mut tiles = source_without_cache(fetcher, fetch(2, 1));
        if comes_back {
            thread::spawn(move || {
                while count.load(Ordering::SeqCst) < 5 {
                    thread::sleep(Duration::from_millis(1));
                }
                // The pause is longer than the retries last.
                thread::sleep(Duration::from_millis(500));
                served().listen(address, ServerLimits::default()).unwrap().1.join()
            });
            assert_eq!(all(&mut tiles).unwrap(), expected());
        } else {
            let (tile, error) = all(&mut tiles).unwrap_err();
            assert!(tile >= 3 && error.contains("refused") && error.ends_with(", for 0 s"), "{tile}: {error}");
        }
    }
}

/// The responses are those of a proxy while the server behind it restarts.
#[test]
fn server_behind_proxy_is_awaited() {
    for status in [502, 503, 504] {
        // The proxy answers with an error more often than the client has attempts.
        let (url, count) = faulty(u32::MAX, move |n| if n < 8 { ResponseFault::Status(status) } else { ResponseFault::None });
        let mut tiles = source_without_cache(new_fetcher(&url, waiting(Duration::from_secs(20))), fetch(1, 1));
        assert_eq!(all(&mut tiles).unwrap(), expected(), "{status}");
        assert_eq!(count.load(Ordering::SeqCst), page().tiles() + 8, "{status}");
    }
    let (url, _count) = faulty(u32::MAX, |_| ResponseFault::Status(502));
    let error = new_fetcher(&url, waiting(Duration::ZERO)).scene("scene", |_| ()).unwrap_err();
    assert!(error.ends_with("scene: http status: 502, for 0 s; is `basrelief serve` running there?"), "{error}");
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn retries_end_at_their_time_limit() {
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::Stalled);
    let began = Instant::now();
    let patience = RetryPolicy { attempts: 100, whole: 19 * HASTY.stall / 10, ..HASTY };
    let error = new_fetcher(&url, patience).scene("scene", |_| ()).unwrap_err();
    assert!(error.contains("attempt 2; at most 100 are made, none 1.9 s after the first"), "{error}");
    assert!(error.ends_with("is `basrelief serve` running there?"), "{error}");
    assert_eq!(count.load(Ordering::SeqCst), 2);
    assert!(began.elapsed() < Duration::from_secs(10), "{:?}", began.elapsed());
}

#[test]
fn dropped_client_does_not_wait() {
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::Stalled);
    let patience = RetryPolicy { stall: Duration::from_secs(100), ..PATIENT };
    let fetcher = new_fetcher(&url, patience);
    let mut tiles = source_without_cache(fetcher, fetch(4, 1));
    announce_all(&mut tiles);
    while count.load(Ordering::SeqCst) < 4 {
        thread::sleep(Duration::from_millis(1));
    }
    let began = Instant::now();
    drop(tiles);
    // The server closes the connections before this time, but only after its sleep.
    assert!(began.elapsed() < 2 * HASTY.stall, "{:?}", began.elapsed());
}

#[test]
fn dripping_head_ends_at_its_deadline() {
    for fault in [ResponseFault::DrippingHead, ResponseFault::Informing] {
        let (url, _count) = faulty(u32::MAX, move |_| fault);
        let began = Instant::now();
        let error = new_fetcher(&url, RetryPolicy { attempts: 1, ..HASTY }).scene("scene", |_| ()).unwrap_err();
        // The server needs more than ten times as long.
        assert!(began.elapsed() < 4 * HASTY.stall, "{fault:?}: {:?}: {error}", began.elapsed());
    }
}
