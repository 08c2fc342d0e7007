//! Failures between `serve` and `run --from`: killed clients, a server restart, a full disk. Also the server's bounds on threads
//! and memory under any client.

use crate::remote::{OWN_HOST, Server, get, images};
use crate::support::{Place, wait};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Views that each need new tiles. They are large, so many tiles are still missing when the first picture appears.
const VIEWS: &str = "--size 320x240 --set tile.width=8 --set tile.height=8 --frames 4 --orbit 270 --set defer.mode=progressive \
                     --no-exact --no-bottlenecks --quiet";
const LONGEST: Duration = Duration::from_secs(60);

/// Waits until the condition holds.
fn until(what: &str, mut so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !so() {
        assert!(began.elapsed() < LONGEST, "{what}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Starts a run from this server into `out` and returns it, still running, after its first picture.
fn looking(place: &Place, server: &Server, out: &str) -> Child {
    let line = format!("run --from {} {VIEWS} --out {out}", server.1);
    let mut client = place.command(&line).stderr(Stdio::piped()).spawn().expect("the program starts");
    let first = place.path(out).join("image-round-0.png");
    until("a first picture", || first.exists() || client.try_wait().expect("runs").is_some());
    assert!(client.try_wait().expect("runs").is_none(), "over before anything could break");
    client
}

// Claim: as crowded_clients_get_every_tile.
#[test]
fn killed_client_leaves_whole_images_only() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let mut client = looking(&place, &server, "out");
    client.kill().expect("killed");
    client.wait().expect("a child");
    let hidden = |names: &[String]| names.iter().filter(|name| name.starts_with('.')).count();
    let left = place.names("out");
    assert_eq!(hidden(&left), 1, "{left:?}");
    for shown in left.iter().filter(|name| name.ends_with(".png")) {
        image::open(place.path("out").join(shown)).unwrap_or_else(|e| panic!("{shown}: {e}"));
    }
    assert!(!left.contains(&"report.json".to_owned()), "{left:?}");
    place.ok(&format!("run --from {} {VIEWS} --out out", server.1));
    assert_eq!(hidden(&place.names("out")), 0, "{:?}", place.names("out"));
    place.ok(&format!("run --from {} {VIEWS} --out other", server.1));
    assert_eq!(images(&place, "out"), images(&place, "other"));
}

/// The server is away for 2 s, longer than the retries of a request. These detect a missing answer after 1.5 s.
// Claim: as crowded_clients_get_every_tile.
#[test]
fn server_restart_costs_clients_only_time() {
    let place = Place::new();
    let server = Server::start_at(&place, &format!("serve demo:gallery --listen {OWN_HOST}:0"), OWN_HOST);
    place.ok(&format!("run --from {} {VIEWS} --out undisturbed", server.1));
    let mut client = looking(&place, &server, "out");
    let address = server.address().to_owned();
    drop(server);
    thread::sleep(Duration::from_secs(2));
    assert!(client.try_wait().expect("runs").is_none(), "it has given up, or was over");
    let _again = Server::start_at(&place, &format!("serve demo:gallery --listen {address}"), OWN_HOST);
    assert!(wait(&mut client, LONGEST).expect("ends").success());
    assert_eq!(images(&place, "out"), images(&place, "undisturbed"));
    assert_eq!(place.names("out"), place.names("undisturbed"));
}

// Claim: as crowded_clients_get_every_tile.
#[test]
fn full_disk_names_image_and_leaves_no_partial_file() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let full = place.on_a_full_disk(&format!("run --from {} {VIEWS} --tile-cache kept --out out", server.1));
    let error = full.error(1);
    assert!(error.starts_with("out/image-round-0.png: cannot be written: "), "{error}");
    assert_eq!(place.names(""), ["kept"]);
    // Tiles of 256 bytes fit on the disk, so the next run can use them.
    assert!(place.names("kept").len() > 10);
    assert!(place.names("kept").iter().all(|name| !name.starts_with('.')));
}

/// Upper bound on the memory of `serve` per connection: answer, head and thread [bytes].
const ANSWER: u64 = 1 << 20;
/// Limit on simultaneous connections.
const CONNECTIONS: u64 = 256;
/// Clients beyond the limit. Each evicts another client, and the evicted thread may still be ending.
const LET_GO: u64 = 20;

/// Returns a number from `/proc/PID/status`.
#[cfg(target_os = "linux")]
fn status(server: &Server, name: &str) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{}/status", server.0.id())).expect("a process");
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':')).expect("a line");
    line.split_whitespace().next().expect("a number").parse().expect("a number")
}

/// More clients than connections request the largest answers, and each reads only the first byte.
#[cfg(target_os = "linux")]
// Claim: as crowded_clients_get_every_tile.
#[test]
fn server_threads_and_memory_are_bounded() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let address = server.address();
    let page = get(address, "/served");
    let (before, _) = page.split_once("</code></td></tr>").expect("a picture");
    let picture = before.rsplit_once("<code>").expect("a picture").1;
    // After this request the server holds all layers.
    let tile = |number: u32| format!("/tile/{picture}/512x512/raw/{number}");
    assert!(get(address, &tile(0)).starts_with("HTTP/1.1 200"));
    let refused = get(address, &format!("/tile/{picture}/512x512/raw/1,1"));
    assert!(
        refused.starts_with("HTTP/1.1 400") && refused.ends_with("expected at most 1 tiles of 512 x 512 texels\n"),
        "{refused}"
    );
    let (threads, memory) = (status(&server, "Threads"), status(&server, "VmHWM"));
    let ask = |_| {
        let mut client = TcpStream::connect(address).expect("connects");
        write!(client, "GET {} HTTP/1.1\r\nHost: localhost\r\n\r\n", tile(1)).expect("sent");
        client
    };
    let mut clients: Vec<TcpStream> = (0..CONNECTIONS + LET_GO).map(ask).collect();
    // Each client has an answer or was evicted for another.
    let mut most = 0;
    for client in &mut clients {
        client.set_read_timeout(Some(LONGEST)).expect("set");
        let _ = client.read(&mut [0]);
        most = most.max(status(&server, "Threads"));
    }
    assert!((CONNECTIONS..=threads + CONNECTIONS + LET_GO).contains(&most), "{most} threads");
    let grown = 1024 * (status(&server, "VmHWM") - memory);
    assert!(grown < CONNECTIONS * ANSWER, "{grown} bytes more");
    drop(clients);
    until("as few threads as before", || status(&server, "Threads") <= threads);
}
