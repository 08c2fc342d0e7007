//! A server on a real path: `serve` and `run --from`, and failures between them.

use crate::support::{Outcome, Place, finish, picture};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

const SMALL: &str = "--size 64x48";
/// Small tiles, so that even small textures have many of them.
const CUT: &str = "--set tile.width=8 --set tile.height=8";

pub fn images(place: &Place, out: &str) -> Vec<String> {
    let report = place.report(out);
    let images = report["image"].as_array().expect("images");
    images.iter().map(|i| i["sha256"].as_str().expect("a hash").to_owned()).collect()
}

fn figure(place: &Place, out: &str, name: &str) -> u64 {
    place.report(out)["figures"][name].as_u64().unwrap_or_else(|| panic!("{name}"))
}

/// A server process, killed at the end of the test, and its URL.
pub struct Server(pub Child, pub String);

/// Address for a server that restarts on the same port. Clients of other tests do not use it, so they cannot take the port
/// meanwhile. Systems other than Linux have only one loopback address.
pub const OWN_HOST: &str = if cfg!(target_os = "linux") { "127.0.0.2" } else { "127.0.0.1" };

impl Server {
    pub fn start(place: &Place, line: &str) -> Self {
        Self::start_at(place, line, "127.0.0.1")
    }

    /// Starts a server that listens at another address of this computer.
    pub fn start_at(place: &Place, line: &str, host: &str) -> Self {
        Self::start_command(&mut place.command(line), host)
    }

    /// Starts the server of a command line.
    pub fn start_command(command: &mut Command, host: &str) -> Self {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let mut said = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut said).expect("a line");
        let url = said.split_whitespace().last().unwrap_or_default().to_owned();
        assert!(url.starts_with(&format!("http://{host}:")), "{said}");
        Self(child, url)
    }

    /// Returns address and port.
    pub fn address(&self) -> &str {
        self.1.trim_start_matches("http://").trim_end_matches('/')
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Proxy between client and server that counts the forwarded tiles, and the bytes of answers.
struct Between {
    url: String,
    tiles: Arc<AtomicU64>,
    bytes: Arc<AtomicU64>,
    most: Arc<AtomicU64>,
}

impl Between {
    /// Starts a proxy for the server at `url` that closes all tile requests after `most` tiles.
    fn new(url: &str, most: u64) -> Self {
        Self::then(url, most, |_| ())
    }

    /// Starts a proxy for the server at `url`. After `most` tiles it keeps connections open without answering.
    fn stuck(url: &str, most: u64) -> Self {
        Self::then(url, most, |client| {
            // Waits until the test ends or the client disconnects.
            let _ = client.read_to_end(&mut Vec::new());
        })
    }

    fn then(url: &str, most: u64, late: fn(&mut TcpStream)) -> Self {
        let server = url.trim_start_matches("http://").trim_end_matches('/').to_owned();
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let own = format!("http://{}/", listener.local_addr().expect("an address"));
        let (tiles, most) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(most)));
        let (passed, limit) = (Arc::clone(&tiles), Arc::clone(&most));
        let bytes = Arc::new(AtomicU64::new(0));
        let sent = Arc::clone(&bytes);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (server, passed, limit) = (server.clone(), Arc::clone(&passed), Arc::clone(&limit));
                let sent = Arc::clone(&sent);
                thread::spawn(move || pass(stream, &server, (&passed, limit.load(Ordering::SeqCst)), &sent, late));
            }
        });
        Self { url: own, tiles, bytes, most }
    }

    /// Forwards all tiles from now on, and counts them from 0.
    fn reset(&self) {
        self.tiles.store(0, Ordering::SeqCst);
        self.most.store(u64::MAX, Ordering::SeqCst);
    }

    fn passed(&self) -> u64 {
        self.tiles.load(Ordering::SeqCst)
    }
}

/// Forwards one request, and its answer. Beyond `most` tiles it calls `late` and then closes the connection.
fn pass(mut client: TcpStream, server: &str, (passed, most): (&AtomicU64, u64), sent: &AtomicU64, late: fn(&mut TcpStream)) {
    let mut lines = BufReader::new(client.try_clone().expect("a stream")).lines().map_while(Result::ok);
    let Some(first) = lines.next() else { return };
    while lines.next().is_some_and(|line| !line.is_empty()) {}
    let counts = first.contains("/tile/");
    let below = |n: u64| (n < most).then_some(n + 1);
    if counts && passed.fetch_update(Ordering::SeqCst, Ordering::SeqCst, below).is_err() {
        return late(&mut client);
    }
    let mut upstream = TcpStream::connect(server).expect("the server");
    let mut answer = Vec::new();
    write!(upstream, "{first}\r\nHost: localhost\r\nConnection: close\r\n\r\n").expect("sent");
    upstream.read_to_end(&mut answer).expect("an answer");
    let head = answer.windows(2).position(|w| w == b"\r\n").expect("a status line");
    // This header keeps the client from sending another request on this connection.
    answer.splice(head..head, *b"\r\nConnection: close");
    sent.fetch_add(answer.len() as u64, Ordering::SeqCst);
    // The client may have given up and closed the connection.
    let _ = client.write_all(&answer);
}

/// Returns a server's answer to a GET request.
pub fn get(address: &str, path: &str) -> String {
    let mut client = TcpStream::connect(address).expect("connects");
    write!(client, "GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").expect("sent");
    let mut answer = Vec::new();
    client.read_to_end(&mut answer).expect("an answer");
    String::from_utf8_lossy(&answer).into_owned()
}

// Claim: defer, real path: An image from a server equals the image from the file. Passing faults are retried, permanent ones are
// named, and received tiles stay. A silent client delays no other.
#[test]
fn image_from_server_equals_image_from_file() {
    let place = Place::new();
    place.ok(&format!("demo gallery {SMALL} {CUT} --quiet --out file"));
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    for more in ["", "--set tile.encoding=png", "--set defer.mode=progressive --set path.requests=3", "--tile-cache kept"] {
        let run = place.ok(&format!("run --from {} {SMALL} {CUT} {more} --out remote", server.1));
        assert_eq!(images(&place, "remote"), images(&place, "file"), "{more}");
        assert_eq!(run.err, "", "no progress in a pipe");
    }
    let url = server.1.clone();
    drop(server);
    let gone = place.run(&format!("run --from {url} --wait 0 --out nothing"));
    assert!(gone.error(1).contains("/scene") && gone.err.contains("is `basrelief serve` running"), "{}", gone.err);
    assert!(!place.names("").contains(&"nothing".to_owned()));
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn lost_server_keeps_received_tiles() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let run = |from: &str, more: &str| -> Outcome {
        place.run(&format!("run --from {from} {SMALL} {CUT} --quiet --set defer.mode=progressive {more}"))
    };
    assert_eq!(run(&server.1, "--out whole").code(), 0);
    let pictures = place.report("whole")["figures"]["picture_round"].as_array().expect("rounds").len();
    assert!(pictures >= 3, "{pictures}");
    // The limit is the tiles of two pictures, and five more.
    assert_eq!(run(&server.1, "--set defer.pictures_per_view=2 --out two").code(), 0);
    let most = figure(&place, "two", "tiles_loaded") + 5;
    assert!(most < figure(&place, "whole", "tiles_loaded"));
    let dying = Between::new(&server.1, most);
    let lost = run(&dying.url, "--tile-cache kept --out lost");
    let error = lost.error(1);
    let names = ["texture ", " layer ", " tile ", "/tile/", "attempt 5"];
    assert!(names.iter().all(|name| error.contains(name)), "{error}");
    assert_eq!(dying.passed(), most);
    assert_eq!(place.names("lost"), ["image-round-0.png", "image-round-1.png", "image.png", "layer-depth.png", "tiles.png"]);
    for round in [0, 1] {
        let name = format!("image-round-{round}.png");
        assert_eq!(picture(&place.path("lost").join(&name)), picture(&place.path("whole").join(&name)), "{round}");
    }
    assert_eq!(place.bytes("lost/image.png"), place.bytes("lost/image-round-1.png"), "the best one is the picture");
    // The cache is that of one address, so the proxy stays.
    dying.reset();
    assert_eq!(run(&dying.url, "--tile-cache kept --out again").code(), 0);
    assert_eq!(dying.passed(), figure(&place, "whole", "tiles_loaded") - most, "only the rest");
    assert_eq!(images(&place, "again"), images(&place, "whole"));
}

/// Returns a report without the host's figures and the hash of the input, because the client has no texels to hash.
fn comparable(place: &Place, out: &str) -> serde_json::Value {
    let mut report = place.report(out);
    report.as_object_mut().expect("an object").remove("host").expect("the host's figures");
    report["input"].as_object_mut().expect("an object").remove("sha256").expect("a hash");
    report
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn served_scene_gives_report_and_images_of_file() {
    let place = Place::new();
    write_triangle(&place, [200, 0, 0]);
    let views = [
        "--size 64x48",
        "--size 40x60 --frames 2 --orbit 50 --turn 20,10 --set defer.mode=progressive --set tile.encoding=png",
        "--size 32x32 --light 1,2,3 --zoom 1.5 --set defer.lighting=gouraud --set defer.mode=conventional --set tile.encoding=jpeg",
        "--size 48x32 --set defer.dmax=1 --set tile.encoding=png --functional",
    ];
    // Textures of many sizes, only some of them used; bump targets beside textures and plain polygons; own frames; a file.
    for (model, views) in
        [("demo:gallery", &views[1..2]), ("demo:mixed", &views[2..]), ("demo:turntable", &views[..1]), ("m.obj", &views)]
    {
        let server = Server::start(&place, &format!("serve {model} --listen 127.0.0.1:0"));
        for view in views {
            place.ok(&format!("run {model} --machine defer {view} {CUT} --no-exact --quiet --out file"));
            place.ok(&format!("run --from {} {view} {CUT} --quiet --out remote", server.1));
            assert_eq!(comparable(&place, "remote"), comparable(&place, "file"), "{model} {view}");
            for name in place.names("file").iter().filter(|name| name.ends_with(".png")) {
                assert_eq!(place.bytes(&format!("remote/{name}")), place.bytes(&format!("file/{name}")), "{model} {view} {name}");
            }
        }
    }
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn views_of_one_server_share_tiles() {
    let place = Place::new();
    let view = "--frames 3 --orbit 60";
    place.ok(&format!("demo gallery {SMALL} {view} {CUT} --quiet --no-exact --out file"));
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let counted = Between::new(&server.1, u64::MAX);
    place.ok(&format!("run --from {} {SMALL} {view} {CUT} --quiet --tile-cache kept --out remote", counted.url));
    assert_eq!(images(&place, "remote"), images(&place, "file"));
    assert_eq!(images(&place, "remote").len(), 3);
    assert!(figure(&place, "remote", "tiles_reused") > 0);
    assert_eq!(counted.passed(), figure(&place, "remote", "tiles_loaded"), "none is fetched twice");
    // These views begin alike and then turn the other way.
    counted.reset();
    let other = "--frames 2 --orbit -50";
    place.ok(&format!("run --from {} {SMALL} {other} {CUT} --quiet --tile-cache kept --out other", counted.url));
    assert!((1..figure(&place, "other", "tiles_loaded")).contains(&counted.passed()), "{}", counted.passed());
}

#[test]
fn report_has_traffic_and_image_times_of_real_path() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let run = "--quiet --set defer.mode=progressive --frames 2 --orbit 10";
    place.ok(&format!("run --from {} {SMALL} {CUT} {run} --out remote", server.1));
    let report = place.report("remote");
    let path = &report["host"]["path"];
    let count = |name: &str| path[name].as_u64().unwrap_or_else(|| panic!("{name}"));
    assert_eq!(
        (count("tiles"), count("tile_bytes")),
        (figure(&place, "remote", "tiles_loaded"), figure(&place, "remote", "path_tile_bytes"))
    );
    let lists = count("requests") - count("tiles") - 1;
    assert!((1..=100).contains(&lists), "the scene, each tile, and {lists} lists of hashes");
    assert!((1..=9).contains(&count("connections")), "connections are kept: {}", count("connections"));
    let scene = get(server.address(), "/scene/8x8/raw");
    let length = scene.lines().find_map(|line| line.strip_prefix("content-length: ")).expect("a length");
    assert_eq!(count("scene_bytes").to_string(), length);
    // An answer's head has at least its status and length. A request has at least its path and host.
    let (answers, requests) = (count("head_bytes") / count("requests"), count("request_bytes") / count("requests"));
    assert!((100..500).contains(&answers) && (100..500).contains(&requests), "{answers} {requests}");
    let times: Vec<f64> = path["picture_ms"].as_array().expect("times").iter().map(|t| t.as_f64().expect("a time")).collect();
    assert_eq!(times.len(), report["figures"]["picture_ms"].as_array().expect("times").len());
    let [first, last] = ["first_picture_ms", "final_picture_ms"].map(|name| path[name].as_f64().expect("a time"));
    assert!(0.0 < first && first <= last && last <= 1e3 * report["host"]["wall_s"].as_f64().expect("a time"), "{first} {last}");
    assert_eq!(times[0], first);
    place.ok(&format!("demo gallery {SMALL} {run} --out file"));
    assert!(place.report("file")["host"].get("path").is_none());
}

#[test]
fn byte_figures_of_real_path_sum_to_all_received_bytes() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let proxy = Between::new(&server.1, u64::MAX);
    let run = place.ok(&format!("run --from {} {SMALL} {CUT} --out remote", proxy.url));
    let report = place.report("remote");
    let count = |name: &str| report["host"]["path"][name].as_u64().unwrap_or_else(|| panic!("{name}"));
    assert!(count("hash_bytes") > 0);
    let all: u64 = ["scene_bytes", "tile_bytes", "hash_bytes", "head_bytes"].map(count).iter().sum();
    assert_eq!(all, proxy.bytes.load(Ordering::SeqCst));
    let shown =
        format!("{} bytes of tile hashes, {} bytes of headers and unused responses.", count("hash_bytes"), count("head_bytes"));
    // Lines are wrapped.
    assert!(run.out.split_whitespace().collect::<Vec<_>>().join(" ").contains(&shown), "{}", run.out);
}

/// On a slow path, each picture is written when it is complete, and not all of them at the end.
// Claim: as image_from_server_equals_image_from_file.
#[test]
fn image_is_written_before_next_tiles_arrive() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let run = |from: &str, more: &str| format!("run --from {from} {SMALL} {CUT} --quiet --set defer.mode=progressive {more}");
    place.ok(&run(&server.1, "--set defer.pictures_per_view=1 --out one"));
    let first = figure(&place, "one", "tiles_loaded");
    // After the first picture, no tile arrives and no connection closes.
    let stuck = Between::stuck(&server.1, first);
    let mut client = place.command(&run(&stuck.url, "--out many")).stderr(Stdio::piped()).spawn().expect("the program starts");
    let shown = place.path("many").join("image-round-0.png");
    let began = std::time::Instant::now();
    while !shown.exists() {
        assert!(began.elapsed().as_secs() < 60 && client.try_wait().expect("runs").is_none(), "no picture");
        thread::sleep(std::time::Duration::from_millis(20));
    }
    assert_eq!(picture(&shown), picture(&place.path("one").join("image.png")));
    assert!(!place.path("many").join("report.json").exists());
    #[cfg(unix)]
    {
        interrupt(&mut client);
        assert_eq!(last_words(&mut client), "interrupted; only the images shown so far were written\n");
        assert_eq!(place.names("many"), ["image-round-0.png"]);
    }
    // The process may have ended already.
    let _ = client.kill();
    let _ = client.wait();
}

#[test]
fn late_server_is_awaited() {
    let place = Place::new();
    write_triangle(&place, [200, 0, 0]);
    let address = TcpListener::bind((OWN_HOST, 0)).expect("a port").local_addr().expect("an address");
    let line = format!("run --from http://{address}/ --size 32x24 --quiet --out remote");
    let mut client = place.command(&line).spawn().expect("the program starts");
    thread::sleep(std::time::Duration::from_millis(300));
    assert!(client.try_wait().expect("runs").is_none(), "it has given up");
    let _server = Server::start_at(&place, &format!("serve m.obj --listen {address}"), OWN_HOST);
    let status = crate::support::wait(&mut client, std::time::Duration::from_secs(60)).expect("ends");
    assert!(status.success() && place.path("remote").join("image.png").exists());
}

/// Serves a triangle with a texture of one colour, which starts faster than a gallery.
fn serve_triangle(place: &Place, colour: [u8; 3]) -> Server {
    write_triangle(place, colour);
    Server::start(place, "serve m.obj --listen 127.0.0.1:0")
}

fn write_triangle(place: &Place, colour: [u8; 3]) {
    let model = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n";
    fs::write(place.path("m.obj"), model).expect("written");
    fs::write(place.path("m.mtl"), "newmtl m\nKd 1 1 1\nmap_Kd t.png\n").expect("written");
    image::RgbImage::from_pixel(16, 16, image::Rgb(colour)).save(place.path("t.png")).expect("written");
}

#[test]
fn tiles_kept_from_other_texels_are_not_taken() {
    let place = Place::new();
    let drawn = [[200, 0, 0], [0, 0, 200]].map(|colour| {
        let server = serve_triangle(&place, colour);
        place.ok(&format!("run --from {} --size 32x24 --tile-cache kept --quiet --out remote", server.1));
        place.ok("run m.obj --machine defer --size 32x24 --quiet --out file");
        assert_eq!(images(&place, "remote"), images(&place, "file"), "{colour:?}");
        images(&place, "file")
    });
    assert_ne!(drawn[0], drawn[1]);
}

/// Starts a server that answers every request with this body and its hash.
fn answering(body: &'static [u8]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let url = format!("http://{}/", listener.local_addr().expect("an address"));
    let hash = crate::support::sha256(body);
    let head = format!("HTTP/1.1 200 OK\r\nETag: \"{hash}\"\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", body.len());
    thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let lines = BufReader::new(stream.try_clone().expect("a stream")).lines().map_while(Result::ok);
            lines.take_while(|line| !line.is_empty()).for_each(drop);
            // The client may have given up and closed the connection.
            let _ = stream.write_all(&[head.as_bytes(), body].concat());
        }
    });
    url
}

#[test]
fn server_without_scene_is_named() {
    let place = Place::new();
    // Compressed data: `basrelief-scene/2`, and a head that declares 4 GiB but is missing; then no hashes of tiles.
    let cut = b"\x78\x01\x01\x16\x00\xe9\xffbasrelief-scene/2\n\xff\xff\xff\xff\x65\xc1\x0a\x50\x00\x00\x00\x00";
    for body in [&b"{\"op\": 17, garbage"[..], b"", b"<html>It works!</html>", b"\x78\x01\xff\xff\xff", cut] {
        let url = answering(body);
        let refused = place.run(&format!("run --from {url} --quiet"));
        assert!(refused.error(1).starts_with(&format!("{url}scene/64x64/raw: ")), "{}", refused.err);
    }
    assert!(place.run(&format!("run --from {} --quiet", answering(cut))).err.contains("/scene/64x64/raw: head: is cut short"));
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
}

#[test]
fn cache_that_is_no_folder_is_refused_first() {
    let place = Place::new();
    fs::write(place.path("file"), "mine").expect("written");
    let server = serve_triangle(&place, [200, 0, 0]);
    let between = Between::new(&server.1, u64::MAX);
    let refused = place.run(&format!("run --from {} --tile-cache file --quiet", between.url));
    assert!(refused.error(1).starts_with("file: cannot be written"), "{}", refused.err);
    assert_eq!((between.passed(), place.text("file").as_str()), (0, "mine"));
}

#[cfg(unix)]
#[test]
fn pipe_in_cache_is_reported_and_does_not_block() {
    let place = Place::new();
    let server = serve_triangle(&place, [200, 0, 0]);
    let line = format!("run --from {} --tile-cache kept --out remote", server.1);
    place.ok(&format!("{line} --quiet"));
    let tile = format!("kept/{}", place.names("kept")[0]);
    fs::remove_file(place.path(&tile)).expect("removed");
    assert!(std::process::Command::new("mkfifo").arg(place.path(&tile)).status().expect("mkfifo").success());
    let run = place.ok(&line);
    assert!(run.err.contains("warning: --tile-cache kept: ") && run.err.contains(&tile), "{}", run.err);
    assert!(!fs::symlink_metadata(place.path(&tile)).expect("there").is_file(), "left as it was");
}

#[test]
fn environment_proxy_is_ignored() {
    let place = Place::new();
    let server = serve_triangle(&place, [200, 0, 0]);
    let mut command = place.command(&format!("run --from {} --quiet", server.1));
    let nobody = "http://127.0.0.1:1/";
    let run = finish(command.env("HTTP_PROXY", nobody).env("http_proxy", nobody).env("ALL_PROXY", nobody));
    assert_eq!(run.code(), 0, "{}", run.err);
}

#[cfg(unix)]
#[test]
fn silent_server_does_not_delay_interrupt() {
    let place = Place::new();
    let silent = TcpListener::bind("127.0.0.1:0").expect("a port");
    let line = format!("run --from http://{}/ --tile-cache kept", silent.local_addr().expect("an address"));
    let mut client = place.command(&line).stderr(Stdio::piped()).spawn().expect("the program starts");
    let asked = silent.accept().expect("a request");
    interrupt(&mut client);
    assert_eq!(last_words(&mut client), "interrupted; nothing was written\n");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
    drop(asked);
}

/// An interrupt before the first image reports that nothing was written.
#[cfg(unix)]
#[test]
fn interrupt_before_first_image_wrote_nothing() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let stuck = Between::stuck(&server.1, 0);
    let line = format!("run --from {} {SMALL} {CUT} --quiet --out many", stuck.url);
    let mut client = place.command(&line).stderr(Stdio::piped()).spawn().expect("the program starts");
    let began = std::time::Instant::now();
    // The folder of the outputs follows the scene.
    while place.names("").is_empty() {
        assert!(began.elapsed().as_secs() < 60 && client.try_wait().expect("runs").is_none(), "no folder");
        thread::sleep(std::time::Duration::from_millis(20));
    }
    interrupt(&mut client);
    assert_eq!(last_words(&mut client), "interrupted; nothing was written\n");
    assert!(place.names("").is_empty(), "{:?}", place.names(""));
}

/// Sends Ctrl-C and checks for its exit code.
#[cfg(unix)]
fn interrupt(child: &mut Child) {
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
    let status = crate::support::wait(child, std::time::Duration::from_secs(10)).expect("ends soon");
    assert_eq!(status.code(), Some(130));
}

/// Returns the standard error output of a process that has ended.
#[cfg(unix)]
fn last_words(child: &mut Child) -> String {
    let mut said = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("words");
    said
}

#[cfg(unix)]
#[test]
fn interrupted_server_reports_stop() {
    let place = Place::new();
    let mut server = serve_triangle(&place, [200, 0, 0]);
    interrupt(&mut server.0);
    assert_eq!(last_words(&mut server.0), "server stopped\n");
}

#[cfg(unix)]
#[test]
fn server_interrupted_while_it_loads_reports_stop() {
    let place = Place::new();
    let model = place.path("slow.gltf");
    assert!(std::process::Command::new("mkfifo").arg(&model).status().expect("mkfifo").success());
    let line = "serve slow.gltf --listen 127.0.0.1:0";
    let mut server = place.command(line).stderr(Stdio::piped()).spawn().expect("the program starts");
    // Opens once the program reads the pipe.
    let pipe = fs::File::options().write(true).open(&model).expect("a reader");
    interrupt(&mut server);
    assert_eq!(last_words(&mut server), "server stopped\n");
    drop(pipe);
}

/// Environment variable that is set if this process may open as many files as the next test needs.
#[cfg(unix)]
const MANY_FILES: &str = "BASRELIEF_TEST_MANY_FILES";

#[cfg(unix)]
#[test]
fn idle_and_dripping_clients_delay_no_request() {
    if std::env::var_os(MANY_FILES).is_some() {
        return crowd();
    }
    // The usual limit is 1024 files, and only a shell can raise it. The test therefore runs itself again inside a shell.
    let raised = |then: &str| {
        let mut shell = std::process::Command::new("sh");
        shell.arg("-c").arg(format!("ulimit -n 4096 && {then}")).env(MANY_FILES, "1");
        shell
    };
    if !raised("true").stderr(Stdio::null()).status().expect("sh").success() {
        println!("SKIPPED: no process may open 4096 files here");
        return;
    }
    let again = "exec \"$0\" --exact remote::idle_and_dripping_clients_delay_no_request";
    let test = finish(raised(again).arg(std::env::current_exe().expect("this test")));
    assert!(test.code() == 0 && test.out.contains("1 passed"), "{}{}", test.out, test.err);
}

#[cfg(unix)]
fn crowd() {
    let place = Place::new();
    let server = serve_triangle(&place, [200, 0, 0]);
    let address = server.address();
    let connect = |n: usize| -> Vec<TcpStream> { (0..n).map(|_| TcpStream::connect(address).expect("connects")).collect() };
    let (idle, mut dripping) = (connect(1000), connect(256));
    thread::spawn(move || {
        while !dripping.is_empty() {
            // Evicted clients do not connect again.
            dripping.retain_mut(|client| client.write_all(b"a").is_ok());
            thread::sleep(std::time::Duration::from_millis(20));
        }
    });
    for _ in 0..5 {
        let began = std::time::Instant::now();
        let answer = get(address, "/scene");
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        assert!(began.elapsed().as_secs_f64() < 1.0, "{:?}", began.elapsed());
    }
    drop(idle);
}

#[test]
fn public_address_and_bad_combinations_are_refused() {
    let place = Place::new();
    let refused = |line: &str| place.run(line).error(2).to_owned();
    assert!(refused("serve demo:gallery --listen 0.0.0.0:0").contains("--public"));
    assert!(refused("serve demo:gallery --listen [::]:0").contains("--public"));
    assert!(refused("serve demo:gallery --listen localhost:80").contains("such as 127.0.0.1:8080"));
    assert!(refused("run --from http://127.0.0.1:1/ --machine bump").contains("only machine `defer`"));
    assert!(refused("run --from http://127.0.0.1:1/ --compare-methods").contains("--compare-methods"));
    assert!(refused("serve demo:gallery --size 8x8").contains("unexpected argument '--size'"));
    for address in ["ftp://x", "127.0.0.1:8080", "http://", "http://a:99999/"] {
        assert!(refused(&format!("run --from {address}")).contains("expected http://ADDRESS:PORT/"), "{address}");
    }
    assert!(refused("run PATCH --tile-cache x").contains("--from"));
    assert!(refused("run PATCH --wait 3").contains("--from"));
}

/// Serves tiles of one server under the addresses of another.
fn lying(honest: &Server, liar: &Server) -> String {
    let picture = |server: &Server| {
        let page = get(server.address(), "/served");
        let (before, _) = page.split_once("</code></td></tr>").expect("a picture");
        before.rsplit_once("<code>").expect("a picture").1.to_owned()
    };
    let (pictures, addresses) = ([honest, liar].map(picture), [honest, liar].map(|server| server.address().to_owned()));
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let url = format!("http://{}/", listener.local_addr().expect("an address"));
    thread::spawn(move || {
        for mut client in listener.incoming().flatten() {
            let mut lines = BufReader::new(client.try_clone().expect("a stream")).lines().map_while(Result::ok);
            let first = lines.next().unwrap_or_default();
            while lines.next().is_some_and(|line| !line.is_empty()) {}
            let path = first.split(' ').nth(1).unwrap_or("/");
            let lies = path.starts_with("/tile/");
            let asked = if lies { path.replace(&pictures[0], &pictures[1]) } else { path.to_owned() };
            let mut upstream = TcpStream::connect(&addresses[usize::from(lies)]).expect("the server");
            write!(upstream, "GET {asked} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").expect("sent");
            let mut answer = Vec::new();
            upstream.read_to_end(&mut answer).expect("an answer");
            // The client may have given up and closed the connection.
            let _ = client.write_all(&answer);
        }
    });
    url
}

#[test]
fn lying_tile_is_refused_and_not_cached() {
    let place = Place::new();
    let (liar, honest) = (serve_triangle(&place, [0, 0, 200]), serve_triangle(&place, [200, 0, 0]));
    let url = lying(&honest, &liar);
    let run = |url: &str| place.run(&format!("run --from {url} --size 32x24 --tile-cache kept --quiet --out remote"));
    let refused = run(&url);
    let error = refused.error(1);
    assert!(
        ["texture ", "tile 0", "/tile/", "not the tile that the scene states"].iter().all(|part| error.contains(part)),
        "{error}"
    );
    assert_eq!(run(&honest.1).code(), 0);
    place.ok("run m.obj --machine defer --size 32x24 --quiet --out file");
    assert_eq!(images(&place, "remote"), images(&place, "file"));
}

/// The head of the answer arrives one byte at a time, and would take more than ten minutes.
#[test]
fn dripping_head_of_scene_ends_soon() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            thread::spawn(move || {
                let head = format!("HTTP/1.1 200 OK\r\nx: {}", "x".repeat(10_000));
                for byte in head.bytes() {
                    if stream.write_all(&[byte]).is_err() {
                        return;
                    }
                    thread::sleep(std::time::Duration::from_millis(500));
                }
            });
        }
    });
    let (place, began) = (Place::new(), std::time::Instant::now());
    let refused = place.run(&format!("run --from http://{address}/ --quiet"));
    assert!(refused.error(1).contains("too slow: the head of the answer takes more than 10 s"), "{}", refused.err);
    assert!(began.elapsed().as_secs() < 60, "{:?}", began.elapsed());
}
