//! `--watch`: a run as a browser sees it.

use crate::relay::relay;
use crate::remote::Server;
use crate::support::Place;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::Stdio;
use std::time::Duration;

/// The body of an answer; none where nobody listens any more.
fn get(address: &str, path: &str) -> Option<Vec<u8>> {
    let mut client = TcpStream::connect(address).ok()?;
    write!(client, "GET {path} HTTP/1.0\r\n\r\n").ok()?;
    let mut answer = Vec::new();
    client.read_to_end(&mut answer).ok()?;
    let end = answer.windows(4).position(|w| w == b"\r\n\r\n")? + 4;
    Some(answer.split_off(end))
}

#[test]
fn who_watches_sees_each_picture_when_it_is_there_and_the_last_one_for_certain() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let shaped = relay(server.address(), 1e6, Duration::ZERO).expect("a relay");
    let line = format!(
        "run --from http://{shaped}/ --size 64x48 --set tile.width=8 --set tile.height=8 --set defer.mode=progressive --watch=127.0.0.1:0"
    );
    let mut run = place.command(&line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let mut said = String::new();
    let mut errors = BufReader::new(run.stderr.take().expect("a pipe"));
    errors.read_line(&mut said).expect("a line");
    let address = said.trim_end().trim_end_matches('/').rsplit("http://").next().expect("an address").to_owned();
    assert!(String::from_utf8(get(&address, "/").expect("the page")).expect("text").contains("<!doctype html>"), "{said}");
    let (mut number, mut seen) = (0, Vec::new());
    while let Some(told) = get(&address, &format!("/after/{number}")) {
        let told: serde_json::Value = serde_json::from_slice(&told).expect("JSON");
        if told["over"] == true {
            break;
        }
        number = told["picture"].as_u64().expect("a number");
        if number > 0 {
            // Nothing follows while the next tiles are under way, unless the path is faster than this test.
            seen.push(get(&address, &format!("/picture/{number}")).expect("a picture"));
        }
    }
    assert!(run.wait().expect("ends").success());
    let last = place.bytes("out/image.png");
    assert!(seen.last().is_some_and(|png| *png == last), "of {} pictures the last is another", seen.len());
    assert!(seen.iter().any(|png| *png != last), "no picture is seen before the last");
}

#[test]
fn only_this_computer_may_watch_and_nobody_who_does_not_is_waited_for() {
    let place = Place::new();
    place.run("demo cut-plane@1 --size 16x12 --watch=0.0.0.0:0").error(2);
    let began = std::time::Instant::now();
    let run = place.ok("demo cut-plane@1 --size 16x12 --no-exact --watch=127.0.0.1:0 --out out");
    assert!(run.err.starts_with("Watch it at http://127.0.0.1:"), "{}", run.err);
    assert!(began.elapsed() < Duration::from_secs(3), "{:?}", began.elapsed());
}
