//! The files of the viewer page that `serve` sends.

use crate::remote::Server;
use crate::support::{PROGRAM, Place};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::{Command, Stdio};

/// Sends a request and returns head and body of the answer.
fn ask(server: &Server, request: &str, headers: &str) -> (String, Vec<u8>) {
    let mut client = TcpStream::connect(server.address()).expect("connects");
    write!(client, "{request} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}\r\n").expect("sent");
    let mut answer = Vec::new();
    client.read_to_end(&mut answer).expect("an answer");
    let end = answer.windows(4).position(|w| w == b"\r\n\r\n").expect("a head") + 4;
    let body = answer.split_off(end);
    (String::from_utf8(answer).expect("text"), body)
}

/// Returns the value of a header.
fn value<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    head.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "))
}

#[test]
fn page_is_sent_compressed_if_accepted() {
    let place = Place::new();
    std::fs::create_dir(place.path("built")).expect("a folder");
    for name in ["viewer.html", "page.css", "page.js", "worker.js", "basrelief.wasm"] {
        std::fs::write(place.path(&format!("built/{name}")), name).expect("written");
    }
    for (name, form) in [("viewer.html.br", "1"), ("page.js.br", "22"), ("page.js.gz", "333")] {
        std::fs::write(place.path(&format!("built/{name}")), form).expect("written");
    }
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0 --folder built");
    let sent = |path: &str, accepts: &str| {
        let headers = if accepts.is_empty() { String::new() } else { format!("Accept-Encoding: {accepts}\r\n") };
        let (head, body) = ask(&server, &format!("GET {path}"), &headers);
        let (of_head, none) = ask(&server, &format!("HEAD {path}"), &headers);
        assert_eq!((of_head, none.len()), (head.clone(), 0), "{path}, {accepts}");
        assert_eq!(value(&head, "content-length"), Some(&*body.len().to_string()), "{path}, {accepts}");
        let tag = value(&head, "etag").expect("a tag").to_owned();
        let (same, _) = ask(&server, &format!("GET {path}"), &format!("{headers}If-None-Match: {tag}\r\n"));
        assert!(same.starts_with("HTTP/1.1 304"), "{same}");
        let vary = value(&head, "vary").map(str::to_owned);
        (value(&head, "content-encoding").map(str::to_owned), String::from_utf8(body).expect("text"), vary, tag)
    };
    let form = |path: &str, accepts: &str| {
        let (encoding, body, vary, _) = sent(path, accepts);
        (encoding.unwrap_or_default(), body, vary.unwrap_or_default())
    };
    let expected = |encoding: &str, body: &str, vary: &str| (encoding.to_owned(), body.to_owned(), vary.to_owned());
    assert_eq!(form("/page.js", "gzip, deflate, br"), expected("br", "22", "accept-encoding"));
    assert_eq!(form("/page.js", "gzip"), expected("gzip", "333", "accept-encoding"));
    assert_eq!(form("/page.js", ""), expected("", "page.js", "accept-encoding"));
    assert_eq!(form("/", "br"), expected("br", "1", "accept-encoding"));
    assert_eq!(form("/worker.js", "br"), expected("", "worker.js", ""), "it has no other form");
    assert_ne!(sent("/page.js", "br").3, sent("/page.js", "gzip").3, "one tag for two forms");
}

/// BASRELIEF_WITH_PAGE may name a program that has the page in it. Otherwise the test takes the program that was built with it.
#[test]
fn copied_program_shows_the_page_if_built_with_it() {
    let (place, named) = (Place::new(), std::env::var_os("BASRELIEF_WITH_PAGE"));
    let has_page = named.is_some() || cfg!(feature = "page");
    std::fs::create_dir(place.path("alone")).expect("a folder");
    let program = place.path("alone/basrelief");
    // Copied by another process. Programs that other tests start in this moment would inherit a file that is open for writing, and a
    // program in such a file cannot run.
    let copied = Command::new("cp").arg(named.unwrap_or_else(|| PROGRAM.into())).arg(&program).status();
    assert!(copied.expect("cp runs").success());
    let command = |line: &str| {
        let mut command = Command::new(&program);
        command.args(line.split_whitespace()).current_dir(place.path("alone")).stdin(Stdio::null());
        command
    };
    let export = command("page --export page.html").output().expect("the program runs");
    let text = String::from_utf8_lossy(&export.stderr);
    assert_eq!(export.status.success(), has_page, "{text}");
    assert_eq!(text.contains("the page is not built"), !has_page, "{text}");
    let server = Server::start_command(&mut command("serve demo:gallery --listen 127.0.0.1:0"), "127.0.0.1");
    let (_, viewer) = ask(&server, "GET /", "");
    assert_eq!(String::from_utf8_lossy(&viewer).contains("data-from"), has_page);
    if has_page {
        let page = std::fs::read_to_string(place.path("alone/page.html")).expect("a page");
        assert!(page.contains("<html") && page.len() > 1_000_000, "{} bytes", page.len());
        let (head, simulator) = ask(&server, "GET /basrelief.wasm", "Accept-Encoding: br\r\n");
        assert_eq!(value(&head, "content-encoding"), Some("br"));
        assert!(simulator.len() > 1_000_000, "{} bytes", simulator.len());
    }
}
