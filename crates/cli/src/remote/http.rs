//! As much of HTTP/1.1 as the server needs: GET without a body. The heads of requests are read by `httparse`.

use super::{HASH, LATER, hash_of};
use httparse::{EMPTY_HEADER, Header, Request, Status};
use std::sync::Arc;

/// Longest head of a request \[bytes\].
pub(super) const LONGEST_HEAD: usize = 8192;
const MOST_HEADERS: usize = 64;
/// How a TLS handshake begins: a record of type 22, version 3.
const TLS: [u8; 2] = [22, 3];

/// What a client asks for.
#[derive(Debug, PartialEq)]
pub(super) struct Asked {
    /// Path of the address, without what stands behind `?`.
    pub path: String,
    /// No other request follows on this connection.
    pub last: bool,
}

/// What the bytes that have come so far are.
#[derive(Debug, PartialEq)]
pub(super) enum Head {
    /// The beginning of a request.
    Half,
    /// A request, and its length.
    Whole(Asked, usize),
    /// No request that is answered with what it asks for: status and reason. What follows is not looked at.
    Wrong(u16, String),
}

impl Head {
    /// Reads the head of a request.
    pub(super) fn read(bytes: &[u8]) -> Self {
        if bytes.starts_with(&TLS) {
            return Self::Wrong(400, "this server speaks HTTP without TLS: ask for http://, not https://\n".into());
        }
        let mut headers = [EMPTY_HEADER; MOST_HEADERS];
        let mut request = Request::new(&mut headers);
        match request.parse(bytes) {
            Ok(Status::Complete(length)) => {
                asked(&request).map_or_else(|(s, why)| Self::Wrong(s, why), |a| Self::Whole(a, length))
            }
            Ok(Status::Partial) if bytes.len() < LONGEST_HEAD => Self::Half,
            Ok(Status::Partial) => Self::Wrong(431, format!("expected a head of at most {LONGEST_HEAD} bytes\n")),
            Err(httparse::Error::TooManyHeaders) => Self::Wrong(431, format!("expected at most {MOST_HEADERS} headers\n")),
            Err(error) => Self::Wrong(400, format!("expected an HTTP/1.1 request: {error}\n")),
        }
    }
}

fn asked(request: &Request<'_, '_>) -> Result<Asked, (u16, String)> {
    let values = |name: &'static str| request.headers.iter().filter(move |h| h.name.eq_ignore_ascii_case(name)).map(value);
    if values("transfer-encoding").next().is_some() || values("content-length").any(|length| length != "0") {
        return Err((400, "expected a request without a body\n".into()));
    }
    if request.method != Some("GET") {
        return Err((405, "expected GET\n".into()));
    }
    let version = request.version.unwrap_or_default();
    if version > 0 && values("host").count() != 1 {
        return Err((400, "expected one header Host\n".into()));
    }
    let target = request.path.unwrap_or_default();
    // A proxy is asked for the whole address.
    let local = target.strip_prefix("http://").map_or(target, |rest| rest.find('/').map_or("/", |slash| &rest[slash..]));
    if !local.starts_with('/') {
        return Err((400, "expected an address that begins with /\n".into()));
    }
    let path = local.split(['?', '#']).next().unwrap_or_default().to_owned();
    let close = values("connection").any(|list| list.split(',').any(|word| word.trim().eq_ignore_ascii_case("close")));
    Ok(Asked { path, last: close || version == 0 })
}

fn value<'a>(header: &Header<'a>) -> &'a str {
    std::str::from_utf8(header.value).unwrap_or("?")
}

/// An answer: its status and its body.
#[derive(Debug)]
pub(super) struct Answer {
    status: u16,
    pub(super) body: Arc<[u8]>,
    hash: String,
    /// What kind of file it is, where that is told.
    kind: Option<&'static str>,
}

impl Answer {
    /// What was asked for, with its hash.
    pub(super) fn found(body: Arc<[u8]>, hash: String) -> Self {
        Self { status: 200, body, hash, kind: None }
    }

    /// A file, as browsers name kinds of files.
    pub(super) fn file(body: Arc<[u8]>, hash: String, kind: &'static str) -> Self {
        Self { kind: Some(kind), ..Self::found(body, hash) }
    }

    /// Why there is nothing.
    pub(super) fn refused(status: u16, why: String) -> Self {
        Self { status, hash: hash_of(why.as_bytes()), body: why.into_bytes().into(), kind: Some("text/plain; charset=utf-8") }
    }

    /// Its head. `last` announces that the connection is closed behind it.
    pub(super) fn head(&self, headers: &str, last: bool) -> String {
        let &Self { status, ref body, ref hash, kind } = self;
        let reason = match status {
            200 => "OK",
            400 => "Bad Request",
            404 => "Not Found",
            405 => "Method Not Allowed",
            431 => "Request Header Fields Too Large",
            LATER => "Service Unavailable",
            _ => "Internal Server Error",
        };
        let more = match status {
            405 => "allow: GET\r\n",
            LATER => "retry-after: 1\r\n",
            _ => "",
        };
        let kind = kind.map(|kind| format!("content-type: {kind}\r\nx-content-type-options: nosniff\r\n")).unwrap_or_default();
        let close = if last { "connection: close\r\n" } else { "" };
        format!(
            "HTTP/1.1 {status} {reason}\r\ncontent-length: {}\r\n{HASH}: {hash}\r\n{kind}{headers}{more}{close}\r\n",
            body.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(request: &str) -> Option<(String, bool)> {
        match Head::read(request.as_bytes()) {
            Head::Whole(Asked { path, last }, length) => {
                assert_eq!(length, request.len());
                Some((path, last))
            }
            _ => None,
        }
    }

    #[test]
    fn a_request_is_read_when_its_head_is_whole() {
        let whole = "GET /polygons?x HTTP/1.1\r\nHost: x\r\n\r\n";
        assert_eq!(path(whole), Some(("/polygons".into(), false)));
        (0..whole.len()).for_each(|cut| assert_eq!(Head::read(&whole.as_bytes()[..cut]), Head::Half, "{cut}"));
        let two = whole.repeat(2);
        assert!(matches!(Head::read(two.as_bytes()), Head::Whole(_, length) if length == whole.len()));
        assert_eq!(path("GET / HTTP/1.1\r\nHost: x\r\nConnection: x, Close\r\n\r\n"), Some(("/".into(), true)));
        assert_eq!(path("GET / HTTP/1.0\r\n\r\n"), Some(("/".into(), true)));
        assert_eq!(path("GET http://a:1/b HTTP/1.1\r\nHost: x\r\n\r\n"), Some(("/b".into(), false)));
        assert_eq!(path("GET http://a HTTP/1.1\r\nHost: x\r\ncontent-length: 0\r\n\r\n"), Some(("/".into(), false)));
    }

    #[test]
    fn what_is_no_request_says_what_was_expected() {
        let wrong = |bytes: &[u8]| match Head::read(bytes) {
            Head::Wrong(status, why) => (status, why),
            head => panic!("{head:?}"),
        };
        assert!(wrong(b"\x16\x03\x01\x02\0\x01\0").1.contains("not https://"));
        assert_eq!(wrong(b"POST / HTTP/1.1\r\nHost: x\r\n\r\n"), (405, "expected GET\n".into()));
        assert_eq!(wrong(b"GET / HTTP/1.1\r\n\r\n").1, "expected one header Host\n");
        assert_eq!(wrong(b"GET x HTTP/1.1\r\nHost: x\r\n\r\n").0, 400);
        assert_eq!(wrong(b"GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\n\r\n").0, 400);
        assert_eq!(wrong(b"\0\0").0, 400);
        assert_eq!(wrong(format!("GET /{}", "a".repeat(LONGEST_HEAD)).as_bytes()).0, 431);
        assert_eq!(wrong(format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(65)).as_bytes()).0, 431);
    }

    #[test]
    fn an_answer_says_how_long_it_is_and_whether_it_is_the_last() {
        let answer = Answer::refused(405, "no".into());
        let head = answer.head("x-textures: 1\r\n", true);
        assert!(head.starts_with("HTTP/1.1 405 Method Not Allowed\r\ncontent-length: 2\r\n"), "{head}");
        assert!(
            head.contains("x-textures: 1\r\nallow: GET\r\nconnection: close\r\n\r\n") && head.contains(&hash_of(b"no")),
            "{head}"
        );
    }
}
