//! Faults of the path: slow, cut, truncated, corrupt, refused, gone; and that nothing is lost.

use super::{HASH, Patience, RemoteTiles, Served, TileCache, fetch_polygons, hash_of, listen};
use basrelief_deferred_renderer::{Cut, Page, TextureMemory, TileEncoding, TileSource};
use basrelief_signals::{Image, Sampler, Texture, Wrap};
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

/// What goes wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    Status(u16),
    Corrupt,
    Truncated,
    /// The connection is closed in place of an answer.
    Cut,
    Slow,
    /// Much more than a tile, with its hash.
    Endless,
}

const PATIENCE: Patience = Patience { request: Duration::from_millis(400), attempts: 3, pause: Duration::from_millis(5) };

fn texture() -> Arc<Texture> {
    let texels = (0..200 * 90).map(|i: u32| [i as u8, (i / 7) as u8, (i / 200) as u8, 255]).collect();
    let levels = vec![Image { width: 200, height: 90, texels }];
    Arc::new(Texture { id: 4, name: "plane".into(), sampler: Sampler::default(), levels, offset: 0 })
}

fn page() -> Arc<Page> {
    Arc::new(Page::new(0, &texture(), [Wrap::Repeat; 2], Cut::default(), 0))
}

/// Answers a request, with a fault.
fn respond(served: &Served, mut stream: TcpStream, fault: Fault) {
    let mut lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
    let Some(first) = lines.next() else { return };
    while lines.next().is_some_and(|line| !line.is_empty()) {}
    let mut body = served.answer(first.split(' ').nth(1).unwrap_or("/")).unwrap_or_default();
    if fault == Fault::Endless {
        body.resize(8 << 20, 0);
    }
    let (hash, length) = (hash_of(&body), body.len());
    let status = if let Fault::Status(status) = fault { status } else { 200 };
    match fault {
        Fault::Cut => return,
        Fault::Slow => thread::sleep(Duration::from_millis(900)),
        Fault::Corrupt => body[0] ^= 1,
        Fault::Truncated => body.truncate(length / 2),
        Fault::None | Fault::Status(_) | Fault::Endless => {}
    }
    let head = format!("HTTP/1.1 {status} x\r\nContent-Length: {length}\r\n{HASH}: {hash}\r\nConnection: close\r\n\r\n");
    // Who has given up waiting does not read it.
    let _ = stream.write_all(&[head.as_bytes(), &body].concat());
}

/// A server whose answer number n has this fault; its address, and how many requests came. It stops listening behind the last
/// of `answers`.
fn faulty(answers: u32, fault: impl Fn(u32) -> Fault + Send + 'static) -> (String, Arc<AtomicU32>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}/", listener.local_addr().unwrap());
    let count = Arc::new(AtomicU32::new(0));
    let counted = Arc::clone(&count);
    thread::spawn(move || {
        let served = Arc::new(Served::new(vec![], [texture()]));
        for stream in listener.incoming().take(answers as usize).flatten() {
            let fault = fault(counted.fetch_add(1, Ordering::SeqCst));
            let served = Arc::clone(&served);
            thread::spawn(move || respond(&served, stream, fault));
        }
    });
    (url, count)
}

fn tiles(url: &str, in_flight: u32, cache: Option<TileCache>) -> RemoteTiles {
    RemoteTiles::new(url, (TileEncoding::Png, 85), in_flight, PATIENCE, cache)
}

/// All tiles of the texture, announced and taken in order; the number of the first that does not come, and why.
fn all(source: &mut dyn TileSource) -> Result<Vec<Arc<[u8]>>, (u32, String)> {
    let page = page();
    source.offer(&texture());
    source.announce(&(0..page.tiles()).map(|tile| (Arc::clone(&page), tile)).collect::<Vec<_>>());
    (0..page.tiles()).map(|tile| source.tile(&page, tile).map_err(|e| (tile, e))).collect()
}

fn expected() -> Vec<Arc<[u8]>> {
    all(&mut TextureMemory::new(TileEncoding::Png, 85)).unwrap()
}

#[test]
fn tiles_come_as_they_are_whatever_the_requests_in_flight() {
    for in_flight in [1, 4, 100] {
        let (url, count) = faulty(u32::MAX, |_| Fault::None);
        assert_eq!(all(&mut tiles(&url, in_flight, None)).unwrap(), expected());
        assert_eq!(count.load(Ordering::SeqCst), page().tiles());
    }
}

#[test]
fn a_fault_that_passes_is_tried_again_and_nothing_is_lost() {
    for fault in [Fault::Status(500), Fault::Status(404), Fault::Corrupt, Fault::Truncated, Fault::Cut, Fault::Slow] {
        let (url, count) = faulty(u32::MAX, move |n| if n == 2 { fault } else { Fault::None });
        assert_eq!(all(&mut tiles(&url, 2, None)).unwrap(), expected(), "{fault:?}");
        assert_eq!(count.load(Ordering::SeqCst), page().tiles() + 1, "{fault:?}");
    }
}

#[test]
fn a_fault_that_stays_is_an_error_that_names_texture_layer_and_tile() {
    for (fault, says) in [
        (Fault::Status(500), "500"),
        (Fault::Status(404), "404"),
        (Fault::Status(302), "302"),
        (Fault::Endless, "too long"),
        (Fault::Corrupt, "hash"),
        (Fault::Truncated, ""),
        (Fault::Cut, ""),
        (Fault::Slow, "timeout"),
    ] {
        let (url, _) = faulty(u32::MAX, move |_| fault);
        let (tile, error) = all(&mut tiles(&url, 1, None)).unwrap_err();
        assert_eq!(tile, 0);
        assert!(error.starts_with("texture 4 (plane), layer 0, tile 0: http://"), "{error}");
        assert!(error.contains(says) && error.ends_with("(after 3 attempts)"), "{fault:?}: {error}");
    }
}

#[test]
fn what_has_come_from_a_server_that_is_gone_for_good_is_kept_and_the_rest_is_fetched_later() {
    let folder = tempfile::tempdir().unwrap();
    let cache = || Some(TileCache::open(folder.path(), "0123456789abcdef0123").unwrap());
    let (url, _) = faulty(3, |_| Fault::None);
    let (tile, error) = all(&mut tiles(&url, 1, cache())).unwrap_err();
    assert_eq!(tile, 3);
    assert!(error.contains("tile 3"), "{error}");
    let (url, count) = faulty(u32::MAX, |_| Fault::None);
    assert_eq!(all(&mut tiles(&url, 2, cache())).unwrap(), expected());
    assert_eq!(count.load(Ordering::SeqCst), page().tiles() - 3, "only the rest");
    let (url, count) = faulty(u32::MAX, |_| Fault::None);
    assert_eq!(all(&mut tiles(&url, 2, cache())).unwrap(), expected());
    assert_eq!(count.load(Ordering::SeqCst), 0, "all there");
}

#[test]
fn a_damaged_file_of_the_cache_is_fetched_anew() {
    let folder = tempfile::tempdir().unwrap();
    let cache = TileCache::open(folder.path(), "scene").unwrap();
    cache.put("tile/1", b"texels").unwrap();
    assert_eq!(cache.get("tile/1").as_deref(), Some(&b"texels"[..]));
    let file = std::fs::read_dir(folder.path().join("scene")).unwrap().next().unwrap().unwrap().path();
    let mut bytes = std::fs::read(&file).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&file, bytes).unwrap();
    assert_eq!(cache.get("tile/1"), None);
    assert_eq!(cache.get("tile/2"), None);
}

#[test]
fn a_request_that_announces_a_body_without_end_takes_no_memory_and_others_are_answered() {
    let server = Arc::new(listen(([127, 0, 0, 1], 0).into()).unwrap());
    let address = server.server_addr().to_ip().unwrap();
    let (served, serving) = (Served::new(b"list".to_vec(), [texture()]), Arc::clone(&server));
    let thread = thread::spawn(move || served.run(&serving));
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(b"GET /polygons HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999999\r\n\r\n").unwrap();
    let mut line = String::new();
    // Nothing comes, or the end.
    stream.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
    let _ = BufReader::new(stream).read_line(&mut line);
    assert_eq!(line, "");
    assert_eq!(fetch_polygons(&format!("http://{address}"), PATIENCE).unwrap(), b"list");
    server.unblock();
    thread.join().unwrap();
}

#[test]
fn addresses_that_are_none_are_refused() {
    let served = Served::new(b"list".to_vec(), [texture()]);
    assert_eq!(served.answer("/polygons").unwrap(), b"list");
    let status = |address: &str| served.answer(address).map(|_| 200).unwrap_or_else(|e| e.0);
    assert_eq!(status("/tile/4/64x64/png/85/0"), 200);
    for missing in ["/", "/tiles", "/tile/5/64x64/raw/85/0", "/tile/4/64x64/raw/85/99", "/../etc/passwd"] {
        assert_eq!(status(missing), 404, "{missing}");
    }
    for wrong in
        ["/tile/", "/tile/4/63x64/raw/85/0", "/tile/4/64x64/bmp/85/0", "/tile/4/64x64/raw/0/0", "/tile/4/64x64/raw/85/-1"]
    {
        assert_eq!(status(wrong), 400, "{wrong}");
    }
}
