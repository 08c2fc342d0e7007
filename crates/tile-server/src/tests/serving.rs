//! The server with slow, idle, wrong and many clients.

use super::*;
use crate::server::ServerLimits;
use basrelief_input::MemoryPool;
use std::io::Read;
use std::net::SocketAddr;
use std::time::Instant;

/// Starts a server with these limits.
fn serving(at: impl Into<SocketAddr>, limits: ServerLimits) -> SocketAddr {
    let (address, server) = served().listen(at.into(), limits).unwrap();
    // The server runs until the end of the tests.
    drop(server);
    address
}

const LITTLE: ServerLimits = ServerLimits { idle: Duration::from_secs(1), slowest: 100, connections: 4, bodies: 1 << 21 };
const LOOPBACK: ([u8; 4], u16) = ([127, 0, 0, 1], 0);

fn scene(address: SocketAddr) -> Vec<u8> {
    let patience = RetryPolicy { stall: Duration::from_secs(20), ..PATIENT };
    packed(&new_fetcher(&format!("http://{address}"), patience).scene("scene", |_| ()).unwrap().1)
}

/// Returns the compressed scene of a body, without the hashes behind it.
fn packed(body: &[u8]) -> Vec<u8> {
    GroupHashes::split(body, &MemoryPool::default()).unwrap().0.to_vec()
}

/// Sends a request and reads until the server closes.
fn exchange(address: SocketAddr, request: &[u8]) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    stream.write_all(request).unwrap();
    let mut answer = Vec::new();
    // A reset connection also counts as closed.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

/// Returns the status of a request for tiles.
fn status(served: &SceneService, asked: &str) -> u16 {
    served.tiles(asked.trim_start_matches("/tile/")).map(|_| 200).unwrap_or_else(|e| e.0)
}

#[test]
fn addresses_that_are_none_are_refused() {
    let (served, picture) = (served(), hex(&hash_of_picture(&texture())));
    assert_eq!(status(&served, &address(0)), 200);
    let other = hash_of(b"other");
    for missing in [format!("{other}/64x64/png/0"), address(99), "x/64x64/raw/0".to_owned(), address("0,99")] {
        assert_eq!(status(&served, &missing), 404, "{missing}");
    }
    for wrong in
        ["63x64/png/0", "64x64/bmp/0", "64x64/jpeg-0/0", "64x64/jpeg-085/0", "64x64/jpeg/0", "64x64/raw/-1", "64x64/raw/"]
    {
        assert_eq!(status(&served, &format!("{picture}/{wrong}")), 400, "{wrong}");
    }
    assert_eq!(status(&served, &address(vec!["0"; 65].join(","))), 400);
    let address = serving(LOOPBACK, LITTLE);
    for missing in ["/polygons", "/tiles", "/../etc/passwd"] {
        let answer = exchange(address, format!("GET {missing} HTTP/1.0\r\n\r\n").as_bytes());
        assert!(answer.starts_with("HTTP/1.1 404"), "{missing}: {answer}");
    }
}

#[test]
fn several_tiles_of_one_request_are_those_of_several() {
    let served = served();
    let one = |number: u32| served.tiles(address(number).trim_start_matches("/tile/")).unwrap().0;
    let (mut rest, _) = served.tiles(address("3,0,5").trim_start_matches("/tile/")).unwrap();
    for number in [3, 0, 5] {
        let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        assert_eq!(rest[4..4 + length], one(number), "{number}");
        rest.drain(..4 + length);
    }
    assert!(rest.is_empty());
}

#[test]
fn bytes_of_a_layer_are_those_of_its_tiles() {
    let served = served();
    let (url, picture) = (format!("http://{}", serving(LOOPBACK, LITTLE)), hex(&hash_of_picture(&texture())));
    let fetcher = new_fetcher(&url, PATIENT);
    let page = page();
    for (layer, found) in page.layers.iter().enumerate() {
        let tiles = found.base..found.base + found.pitch * found.rows;
        let sum: usize = tiles.map(|n| served.tiles(address(n).trim_start_matches("/tile/")).unwrap().0.len()).sum();
        assert_eq!(fetcher.number(&format!("bytes/{picture}/64x64/png/{layer}")), Ok(sum as u64), "{layer}");
    }
    assert!(fetcher.number(&format!("bytes/{picture}/64x64/png/9")).unwrap_err().contains("status: 404"));
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn tile_is_immutable_and_scene_is_revalidated() {
    let at = serving(LOOPBACK, LITTLE);
    let get = |path: &str, more: &str| exchange(at, format!("GET {path} HTTP/1.0\r\n{more}\r\n").as_bytes());
    let tile = get(&address(0), "");
    let says = |answer: &str, words: &[&str]| words.iter().for_each(|word| assert!(answer.contains(word), "{word}: {answer}"));
    says(&tile, &["content-type: image/png", "cache-control: public, max-age=31536000, immutable"]);
    let scene = get("/scene", "");
    says(&scene, &["HTTP/1.1 200", "content-type: application/octet-stream", "cache-control: no-cache"]);
    assert!(!scene.contains("access-control"), "{scene}");
    says(&get("/", ""), &["content-type: text/html", "<p>page"]);
    let whole = served().scene(None).unwrap();
    let tag = format!("\"{}\"", hash_of(&[&whole.body[..], &whole.tail].concat()));
    assert!(scene.contains(&format!("etag: {tag}\r\n")), "{scene}");
    for has in [&*tag, &format!("\"x\", W/{tag}"), "*"] {
        let unchanged = get("/scene", &format!("If-None-Match: {has}\r\n"));
        assert!(unchanged.starts_with("HTTP/1.1 304") && unchanged.ends_with("\r\n\r\n"), "{unchanged}");
    }
    assert!(get("/scene", "If-None-Match: \"x\"\r\n").starts_with("HTTP/1.1 200"));
}

#[test]
fn other_origin_reads_only_by_option_and_other_host_never() {
    let service = served().with_allowed_origin("http://a.example").with_host_names(vec!["b.example".into()]);
    let (at, _server) = service.listen(LOOPBACK.into(), LITTLE).unwrap();
    let get = |host: &str| exchange(at, format!("GET /scene HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").as_bytes());
    let own = get("127.0.0.1:1");
    assert!(own.contains("access-control-allow-origin: http://a.example\r\n") && own.contains("200 OK"), "{own}");
    assert!(get("B.example").contains("200 OK"));
    let other = get("evil.example");
    assert!(other.starts_with("HTTP/1.1 403 ") && other.contains("--allow-host"), "{other}");
}

#[test]
fn head_request_keeps_connection() {
    let at = serving(LOOPBACK, LITTLE);
    let answers = exchange(at, b"HEAD /none HTTP/1.1\r\nHost: localhost\r\n\r\nGET / HTTP/1.0\r\n\r\n");
    let (first, second) = answers.split_at(answers.rfind("HTTP/1.1 ").unwrap());
    assert!(first.contains("content-length: ") && first.ends_with("\r\n\r\n"), "{first}");
    assert!(second.ends_with("\r\n\r\n<p>page"), "{second}");
}

/// Returns a request for one tile.
fn a_tile() -> String {
    format!("GET {} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", address(0))
}

#[test]
fn busy_texture_does_not_block_another() {
    let other =
        Texture { id: 5, levels: vec![Image { width: 1, height: 1, texels: vec![[1; 4]] }], ..Texture::clone(&texture()) };
    let asked = format!("{}/64x64/png/0", hex(&hash_of_picture(&other)));
    let served = SceneService::new(vec![], String::new(), [texture(), Arc::new(other)]);
    let _under_work = served.pictures[&hex(&hash_of_picture(&texture()))].pyramid.lock().unwrap();
    assert!(served.tiles(&asked).is_ok());
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn silent_clients_are_evicted() {
    let address = serving(LOOPBACK, LITTLE);
    let began = Instant::now();
    // Ten times as many clients as the server has connections.
    let idle: Vec<TcpStream> = (0..40)
        .map(|n| {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(if n % 2 == 0 { b"" } else { b"GET /scene HTT" }).unwrap();
            stream
        })
        .collect();
    assert_eq!(scene(address), b"scene");
    assert!(began.elapsed() < Duration::from_secs(15), "{:?}", began.elapsed());
    drop(idle);
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn stalled_readers_are_evicted() {
    // The scene is larger than the buffers of the connection.
    let large = serving_scene(vec![0; 32 << 20]);
    let (address, _server) = large.listen(LOOPBACK.into(), ServerLimits { connections: 1, ..LITTLE }).unwrap();
    let mut stalled = TcpStream::connect(address).unwrap();
    stalled.write_all(b"GET /scene HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    assert!(exchange(address, a_tile().as_bytes()).starts_with("HTTP/1.1 200"));
    drop(stalled);
}

#[test]
fn evicted_connection_is_no_error_for_client() {
    let address = serving(LOOPBACK, LITTLE);
    let patience = RetryPolicy { attempts: 1, stall: Duration::from_secs(20), ..PATIENT };
    let fetcher = new_fetcher(&format!("http://{address}"), patience);
    for _ in 0..2 {
        assert_eq!(packed(&fetcher.scene("scene", |_| ()).unwrap().1), b"scene");
        thread::sleep(2 * LITTLE.idle);
    }
}

#[test]
fn request_with_body_is_refused_at_once() {
    let address = serving(LOOPBACK, ServerLimits { idle: Duration::from_secs(100), ..LITTLE });
    for announced in ["Content-Length: 99999999999999", "Transfer-Encoding: chunked"] {
        let request = format!("GET /scene HTTP/1.1\r\nHost: localhost\r\n{announced}\r\n\r\n");
        assert!(exchange(address, request.as_bytes()).starts_with("HTTP/1.1 400"), "{announced}");
    }
    assert_eq!(scene(address), b"scene");
}

#[test]
fn wrong_request_ends_only_its_connection() {
    let address = serving(LOOPBACK, LITTLE);
    let long = format!("GET /{} HTTP/1.1\r\nHost: localhost\r\n\r\n", "a".repeat(100_000));
    for wrong in [
        "POST /scene HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
        "GET /scene HTTP/9.9\r\n\r\n",
        "\0\x01\x02\r\n\r\n",
        "GET localhost HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "CONNECT x:80 HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "\x16\x03\x01\x02\0\x01\0\x01",
        &long,
    ] {
        assert!(exchange(address, wrong.as_bytes()).starts_with("HTTP/1.1 4"), "{:.40}", wrong);
    }
    assert_eq!(scene(address), b"scene");
}

#[test]
fn pipelined_requests_are_answered_in_order() {
    let address = serving(LOOPBACK, LITTLE);
    let [first, second] = ["/scene", "/none"].map(|path| format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    let answers = exchange(address, format!("{first}{second}GET / HTTP/1.0\r\n\r\n").as_bytes());
    let statuses: Vec<&str> = answers.split("HTTP/1.1 ").skip(1).map(|a| &a[..3]).collect();
    assert_eq!(statuses, ["200", "404", "200"], "{answers}");
}

/// Sends a head that never ends, one byte at a time, on all connections.
fn drip(mut clients: Vec<TcpStream>) {
    thread::spawn(move || {
        while !clients.is_empty() {
            clients.retain_mut(|client| client.write_all(b"a").is_ok());
            thread::sleep(Duration::from_millis(20));
        }
    });
}

/// Time limit of a request. Without other clients it takes milliseconds, and a blocked request waits for 10 s.
const SOON: Duration = Duration::from_secs(3);

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn idle_and_dripping_clients_block_no_request() {
    let address = serving(LOOPBACK, ServerLimits { connections: 32, ..ServerLimits::default() });
    let connect = |n: usize| -> Vec<TcpStream> { (0..n).map(|_| TcpStream::connect(address).unwrap()).collect() };
    // Both ends together stay below the 1,024 files that a process may open by default.
    let idle = connect(500);
    let mut dripping = connect(256);
    dripping.iter_mut().for_each(|client| client.write_all(b"GET /").unwrap_or_default());
    drip(dripping);
    // These clients request and never read. There are as many of them as the server has connections.
    let mut taking = connect(32);
    taking.iter_mut().for_each(|client| client.write_all(b"GET /scene HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap_or_default());
    for _ in 0..5 {
        let began = Instant::now();
        assert_eq!(scene(address), b"scene");
        assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
    }
    drop((idle, taking));
}

#[test]
fn stalled_readers_do_not_block_others() {
    let large = serving_scene(vec![0; 32 << 20]);
    let (address, _server) = large.listen(LOOPBACK.into(), ServerLimits { connections: 4, ..ServerLimits::default() }).unwrap();
    let stalled = [(); 4].map(|()| {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(b"GET /scene HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
        stream
    });
    let began = Instant::now();
    assert!(exchange(address, a_tile().as_bytes()).starts_with("HTTP/1.1 200"));
    assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
    drop(stalled);
}

#[test]
fn tls_handshake_is_refused_at_once() {
    let address = serving(LOOPBACK, ServerLimits::default());
    let began = Instant::now();
    let answer = exchange(address, b"\x16\x03\x01\x02\0\x01\0\x01\xfc\x03\x03");
    assert!(answer.starts_with("HTTP/1.1 400") && answer.contains("not https://"), "{answer}");
    assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
}

#[test]
fn ipv6_loopback_address_is_served() {
    if TcpListener::bind("[::1]:0").is_err() {
        println!("SKIPPED: there is no IPv6 here");
        return;
    }
    let address = serving(([0, 0, 0, 0, 0, 0, 0, 1], 0), LITTLE);
    assert_eq!(scene(address), b"scene");
}

#[test]
fn address_in_use_is_a_named_error() {
    let address = serving(LOOPBACK, LITTLE);
    let error = served().listen(address, LITTLE).map(|_| ()).unwrap_err();
    assert!(error.starts_with(&format!("{address}: cannot be listened at: ")), "{error}");
}
