//! `--watch`: the preview of a run in a browser.

use crate::relay::relay;
use crate::remote::Server;
use crate::support::{Place, without_host};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::Stdio;
use std::time::Duration;

/// Returns the body of an answer, or `None` if the server no longer listens.
fn get(address: &str, path: &str) -> Option<Vec<u8>> {
    let mut client = TcpStream::connect(address).ok()?;
    write!(client, "GET {path} HTTP/1.0\r\n\r\n").ok()?;
    let mut answer = Vec::new();
    client.read_to_end(&mut answer).ok()?;
    let end = answer.windows(4).position(|w| w == b"\r\n\r\n")? + 4;
    Some(answer.split_off(end))
}

/// Options of the runs over a path.
const DRAWN: &str = "--size 64x48 --set tile.width=8 --set tile.height=8 --set defer.mode=progressive";

/// Iterator over the states and pictures of a preview, from the first picture to the last.
struct Watching {
    address: String,
    number: u64,
    /// Name of the last picture.
    last: String,
}

impl Iterator for Watching {
    type Item = (Value, Vec<u8>);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let told = get(&self.address, &format!("/after/{}", self.number))?;
            let told: Value = serde_json::from_slice(&told).expect("JSON");
            if told["over"] == true {
                self.last = told["name"].as_str().expect("a name").into();
                return None;
            }
            let before = std::mem::replace(&mut self.number, told["picture"].as_u64().expect("a number"));
            if self.number > before {
                return Some((told, get(&self.address, &format!("/picture/{}", self.number)).expect("a picture")));
            }
        }
    }
}

/// Runs a command line with `--watch`. Returns the states and pictures of its preview and the name of the last picture.
fn watched(place: &Place, line: &str) -> (Vec<(Value, Vec<u8>)>, String) {
    let mut run = place
        .command(&format!("{line} --watch=127.0.0.1:0"))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut said = String::new();
    let mut errors = BufReader::new(run.stderr.take().expect("a pipe"));
    errors.read_line(&mut said).expect("a line");
    let address = said.trim_end().trim_end_matches('/').rsplit("http://").next().expect("an address").to_owned();
    let page = get(&address, "/").unwrap_or_else(|| panic!("no page: {said}"));
    assert!(page.starts_with(b"<!doctype html>"), "{said}");
    let mut watching = Watching { address, number: 0, last: String::new() };
    let seen = watching.by_ref().collect();
    assert!(run.wait().expect("ends").success());
    (seen, watching.last)
}

#[test]
fn preview_shows_every_image_and_the_last() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let shaped = relay(server.address(), 1e6, Duration::ZERO).expect("a relay");
    let (seen, name) = watched(&place, &format!("run --from http://{shaped}/ {DRAWN}"));
    assert_eq!(name, "image.png", "as its file");
    let last = place.bytes("out/image.png");
    assert!(seen.last().is_some_and(|(_, png)| *png == last), "of {} pictures the last is another", seen.len());
    assert!(seen.iter().any(|(_, png)| *png != last), "no picture is seen before the last");
}

/// Returns the pixels of a picture.
fn pixels(png: &[u8]) -> Vec<[u8; 3]> {
    image::load_from_memory(png).expect("a picture").into_rgb8().pixels().map(|pixel| pixel.0).collect()
}

/// The second acquisition lies between the first two rounds.
#[test]
fn preview_grows_between_rounds() {
    // On a busy computer, all tiles can arrive before a picture with some of them is coloured.
    assert!((0..4).any(|_| grows()), "no picture is half there, each time");
}

/// Returns true if the preview showed a mixture of the first two rounds. Checks that every picture between them consists of
/// pixels of these two rounds.
fn grows() -> bool {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let shaped = relay(server.address(), 1.5e5, Duration::ZERO).expect("a relay");
    let (seen, _) = watched(&place, &format!("run --from http://{shaped}/ {DRAWN}"));
    let rounds = ["out/image-round-0.png", "out/image-round-1.png"].map(|round| pixels(&place.bytes(round)));
    let changes: Vec<usize> = (0..rounds[0].len()).filter(|&i| rounds[0][i] != rounds[1][i]).collect();
    let growing =
        |told: &Value| told["tiles"]["acquisition"] == 2 && told["tiles"]["come"].as_u64() < told["tiles"]["needed"].as_u64();
    let growing: Vec<Vec<[u8; 3]>> = seen.iter().filter(|(told, _)| growing(told)).map(|(_, png)| pixels(png)).collect();
    let new = |picture: &Vec<[u8; 3]>| changes.iter().filter(|&&i| picture[i] == rounds[1][i]).count();
    for picture in &growing {
        let strange = (0..picture.len()).find(|&i| picture[i] != rounds[0][i] && picture[i] != rounds[1][i]);
        assert_eq!(strange, None, "a pixel of neither round");
    }
    growing.iter().any(|picture| (1..changes.len()).contains(&new(picture)))
}

/// Returns all pictures of a run, and its report without the host's figures.
fn results(place: &Place, out: &str) -> (Vec<(String, Vec<u8>)>, Value) {
    let pictures = place.names(out).into_iter().filter(|name| name.ends_with(".png"));
    (pictures.map(|name| (name.clone(), place.bytes(&format!("{out}/{name}")))).collect(), without_host(place.report(out)))
}

#[test]
fn preview_changes_neither_images_nor_cycles() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    for mode in ["progressive", "best"] {
        let shaped = relay(server.address(), 5e5, Duration::ZERO).expect("a relay");
        let line = format!("run --from http://{shaped}/ {DRAWN} --set defer.mode={mode} --frames 2 --orbit 40 --out");
        place.ok(&format!("{line} alone"));
        let (seen, name) = watched(&place, &format!("{line} seen"));
        assert_eq!(name, "image-0002.png", "as its file");
        assert!(seen.iter().any(|(told, _)| told["tiles"]["come"].is_u64()), "{mode}: nothing has grown");
        let (alone, seen) = (results(&place, "alone"), results(&place, "seen"));
        assert!(alone.0.len() >= 2 && alone == seen, "{mode}");
    }
}

#[test]
fn preview_is_loopback_only_and_never_waits() {
    let place = Place::new();
    place.run("demo cut-plane@1 --size 16x12 --watch=0.0.0.0:0").error(2);
    let began = std::time::Instant::now();
    let run = place.ok("demo cut-plane@1 --size 16x12 --no-exact --watch=127.0.0.1:0 --out out");
    assert!(run.err.starts_with("Preview: http://127.0.0.1:"), "{}", run.err);
    assert!(began.elapsed() < Duration::from_secs(3), "{:?}", began.elapsed());
}
