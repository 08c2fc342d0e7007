//! The server, and clients that are slow, idle, wrong or many.

use super::super::Limits;
use super::*;
use std::io::Read;
use std::net::SocketAddr;
use std::time::Instant;

/// A server that grants little; its address.
fn serving(at: impl Into<SocketAddr>, limits: Limits) -> SocketAddr {
    let (address, server) = served().listen(at.into(), limits).unwrap();
    // It goes on to the end of the tests.
    drop(server);
    address
}

const LITTLE: Limits = Limits { idle: Duration::from_millis(200), slowest: 100, connections: 4 };
const LOOPBACK: ([u8; 4], u16) = ([127, 0, 0, 1], 0);

fn polygons(address: SocketAddr) -> Vec<u8> {
    let patience = Patience { stall: Duration::from_secs(20), ..PATIENCE };
    Fetcher::new(&format!("http://{address}"), patience).polygons(|_| ()).unwrap().0
}

/// Sends this; all that comes until the server closes the connection.
fn exchange(address: SocketAddr, request: &[u8]) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    stream.write_all(request).unwrap();
    let mut answer = Vec::new();
    // A connection that is reset is closed too.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn addresses_that_are_none_are_refused() {
    let served = served();
    let status = |address: &str| served.tile(address).map(|_| 200).unwrap_or_else(|e| e.0);
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

#[test]
fn a_texture_under_work_holds_up_no_other() {
    let other = Arc::new(Texture { id: 5, ..Texture::clone(&texture()) });
    let served = TileService::new(list(vec![]), [texture(), other], "");
    let _under_work = served.textures[&4].pyramid.lock().unwrap();
    assert!(served.tile("/tile/5/64x64/png/85/0").is_ok());
}

#[test]
fn who_sends_nothing_or_half_a_request_is_let_go_and_others_are_answered() {
    let address = serving(LOOPBACK, LITTLE);
    let began = Instant::now();
    // Ten times as many as are served at a time.
    let idle: Vec<TcpStream> = (0..40)
        .map(|n| {
            let mut stream = TcpStream::connect(address).unwrap();
            stream.write_all(if n % 2 == 0 { b"" } else { b"GET /polygons HTT" }).unwrap();
            stream
        })
        .collect();
    assert_eq!(polygons(address), b"list");
    assert!(began.elapsed() < Duration::from_secs(15), "{:?}", began.elapsed());
    drop(idle);
}

#[test]
fn who_takes_nothing_is_let_go_and_others_are_answered() {
    // More than lies on the way.
    let large = TileService::new(list(vec![0; 32 << 20]), [texture()], &hash_of(b"textures"));
    let (address, _server) = large.listen(LOOPBACK.into(), Limits { connections: 1, ..LITTLE }).unwrap();
    let mut stalled = TcpStream::connect(address).unwrap();
    stalled.write_all(b"GET /polygons HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
    let request = "GET /tile/4/64x64/png/85/0 HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n";
    assert!(exchange(address, request.as_bytes()).starts_with("HTTP/1.1 200"));
    drop(stalled);
}

#[test]
fn a_connection_that_the_server_has_let_go_is_no_fault_to_the_client() {
    let address = serving(LOOPBACK, LITTLE);
    let patience = Patience { attempts: 1, stall: Duration::from_secs(20), ..PATIENCE };
    let mut fetcher = Fetcher::new(&format!("http://{address}"), patience);
    for _ in 0..2 {
        assert_eq!(fetcher.polygons(|_| ()).unwrap().0, b"list");
        thread::sleep(2 * LITTLE.idle);
    }
}

#[test]
fn who_announces_a_body_gets_an_answer_at_once_and_takes_no_memory() {
    let address = serving(LOOPBACK, Limits { idle: Duration::from_secs(100), ..LITTLE });
    for announced in ["Content-Length: 99999999999999", "Transfer-Encoding: chunked"] {
        let request = format!("GET /polygons HTTP/1.1\r\nHost: x\r\n{announced}\r\n\r\n");
        assert!(exchange(address, request.as_bytes()).starts_with("HTTP/1.1 400"), "{announced}");
    }
    assert_eq!(polygons(address), b"list");
}

#[test]
fn a_wrong_request_ends_its_connection_and_nothing_else() {
    let address = serving(LOOPBACK, LITTLE);
    let long = format!("GET /{} HTTP/1.1\r\nHost: x\r\n\r\n", "a".repeat(100_000));
    for wrong in [
        "POST /polygons HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n",
        "GET /polygons HTTP/9.9\r\n\r\n",
        "\0\x01\x02\r\n\r\n",
        "GET localhost HTTP/1.1\r\nHost: x\r\n\r\n",
        "CONNECT x:80 HTTP/1.1\r\nHost: x\r\n\r\n",
        "\x16\x03\x01\x02\0\x01\0\x01",
        &long,
    ] {
        assert!(exchange(address, wrong.as_bytes()).starts_with("HTTP/1.1 4"), "{:.40}", wrong);
    }
    assert_eq!(polygons(address), b"list");
}

#[test]
fn several_requests_on_one_connection_are_answered_in_order() {
    let address = serving(LOOPBACK, LITTLE);
    let [first, second] = ["/polygons", "/none"].map(|path| format!("GET {path} HTTP/1.1\r\nHost: x\r\n\r\n"));
    let answers = exchange(address, format!("{first}{second}GET / HTTP/1.0\r\n\r\n").as_bytes());
    let statuses: Vec<&str> = answers.split("HTTP/1.1 ").skip(1).map(|a| &a[..3]).collect();
    assert_eq!(statuses, ["200", "404", "404"], "{answers}");
}

/// Sends one byte of a head that never ends, again and again, on all of these.
fn drip(mut clients: Vec<TcpStream>) {
    thread::spawn(move || {
        while !clients.is_empty() {
            clients.retain_mut(|client| client.write_all(b"a").is_ok());
            thread::sleep(Duration::from_millis(20));
        }
    });
}

/// Longest that a request may wait here; without anybody else it takes milliseconds, and who waits for others waits for 10 s.
const SOON: Duration = Duration::from_secs(3);

#[test]
fn idle_and_dripping_clients_many_times_as_many_as_are_served_hold_up_nobody() {
    let address = serving(LOOPBACK, Limits { connections: 32, ..Limits::default() });
    let connect = |n: usize| -> Vec<TcpStream> { (0..n).map(|_| TcpStream::connect(address).unwrap()).collect() };
    // With their other ends fewer than the 1024 files that a process may open by default.
    let idle = connect(500);
    let mut dripping = connect(256);
    dripping.iter_mut().for_each(|client| client.write_all(b"GET /").unwrap_or_default());
    drip(dripping);
    // Who asks and does not look at the answer, as many as there may be.
    let mut taking = connect(32);
    taking.iter_mut().for_each(|client| client.write_all(b"GET /polygons HTTP/1.1\r\nHost: x\r\n\r\n").unwrap_or_default());
    for _ in 0..5 {
        let began = Instant::now();
        assert_eq!(polygons(address), b"list");
        assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
    }
    drop((idle, taking));
}

#[test]
fn as_many_as_there_may_be_that_take_nothing_hold_up_no_other_for_long() {
    let large = TileService::new(list(vec![0; 32 << 20]), [texture()], &hash_of(b"textures"));
    let (address, _server) = large.listen(LOOPBACK.into(), Limits { connections: 4, ..Limits::default() }).unwrap();
    let stalled = [(); 4].map(|()| {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(b"GET /polygons HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
        stream
    });
    let began = Instant::now();
    let request = b"GET /tile/4/64x64/png/85/0 HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n";
    assert!(exchange(address, request).starts_with("HTTP/1.1 200"));
    assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
    drop(stalled);
}

#[test]
fn while_the_list_is_made_tiles_are_served_and_who_asks_for_the_list_waits_for_it() {
    let making = PolygonList::default();
    let served = TileService::new(making.clone(), [texture()], &hash_of(b"textures"));
    let (address, _server) = served.listen(LOOPBACK.into(), LITTLE).unwrap();
    let request = |path: &str| format!("GET {path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
    let answer = exchange(address, request("/polygons").as_bytes());
    assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("retry-after: "), "{answer}");
    assert!(exchange(address, request("/tile/4/64x64/png/85/0").as_bytes()).starts_with("HTTP/1.1 200"));
    // More pauses than there are attempts.
    let pause = 10 * PATIENCE.attempts * PATIENCE.pause;
    thread::spawn(move || {
        thread::sleep(pause);
        making.offer(b"list".to_vec());
    });
    let began = Instant::now();
    assert_eq!(polygons(address), b"list");
    assert!(began.elapsed() < pause + SOON, "{:?}", began.elapsed());
}

#[test]
fn a_server_that_never_has_its_list_is_left() {
    let served = TileService::new(PolygonList::default(), [texture()], &hash_of(b"textures"));
    let (address, _server) = served.listen(LOOPBACK.into(), LITTLE).unwrap();
    let patience = Patience { making: Duration::from_millis(100), ..PATIENCE };
    let error = Fetcher::new(&format!("http://{address}"), patience).polygons(|_| ()).unwrap_err();
    assert!(error.ends_with("/polygons: the server is still making its list, after 0.1 s"), "{error}");
}

#[test]
fn who_speaks_tls_is_told_at_once() {
    let address = serving(LOOPBACK, Limits::default());
    let began = Instant::now();
    let answer = exchange(address, b"\x16\x03\x01\x02\0\x01\0\x01\xfc\x03\x03");
    assert!(answer.starts_with("HTTP/1.1 400") && answer.contains("not https://"), "{answer}");
    assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
}

#[test]
fn it_listens_at_the_loopback_of_ipv6_too() {
    if TcpListener::bind("[::1]:0").is_err() {
        println!("SKIPPED: there is no IPv6 here");
        return;
    }
    let address = serving(([0, 0, 0, 0, 0, 0, 0, 1], 0), LITTLE);
    assert_eq!(polygons(address), b"list");
}

#[test]
fn an_address_that_is_taken_is_an_error_that_names_it() {
    let address = serving(LOOPBACK, LITTLE);
    let error = served().listen(address, LITTLE).map(|_| ()).unwrap_err();
    assert!(error.starts_with(&format!("{address}: cannot be listened at: ")), "{error}");
}
