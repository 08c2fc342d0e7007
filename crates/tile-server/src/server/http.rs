//! The part of HTTP/1.1 that the server needs: GET and HEAD without a body. `httparse` reads the heads of requests.

use httparse::{EMPTY_HEADER, Header, Status};
use std::sync::Arc;

/// Maximum size of a request head \[bytes\].
pub(crate) const MAX_HEAD: usize = 8192;
const MOST_HEADERS: usize = 64;
/// Start of a TLS handshake: a record of type 22, version 3.
const TLS: [u8; 2] = [22, 3];

/// A request.
#[derive(Debug, PartialEq)]
pub(crate) struct Request {
    /// Path without query and fragment.
    pub path: String,
    /// Header Host; `None` in HTTP/1.0.
    pub host: Option<String>,
    /// The client closes the connection after the response.
    pub last: bool,
    /// The request is HEAD.
    pub head: bool,
    /// The header If-None-Match.
    pub has: Option<String>,
    /// The header Accept-Encoding.
    pub accepts: Option<String>,
}

/// Result of parsing the received bytes.
#[derive(Debug, PartialEq)]
pub(crate) enum HeaderParse {
    /// The start of a request.
    Incomplete,
    /// A request and the length of its head.
    Complete(Request, usize),
    /// Status and reason of an error. The rest of the stream is ignored.
    Rejected(u16, String),
}

impl HeaderParse {
    /// Parses the head of a request.
    pub(crate) fn read(bytes: &[u8]) -> Self {
        if bytes.starts_with(&TLS) {
            return Self::Rejected(400, "this server speaks HTTP without TLS: ask for http://, not https://\n".into());
        }
        let mut headers = [EMPTY_HEADER; MOST_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(bytes) {
            Ok(Status::Complete(length)) => {
                request_of(&request).map_or_else(|(s, why)| Self::Rejected(s, why), |a| Self::Complete(a, length))
            }
            Ok(Status::Partial) if bytes.len() < MAX_HEAD => Self::Incomplete,
            Ok(Status::Partial) => Self::Rejected(431, format!("expected a head of at most {MAX_HEAD} bytes\n")),
            Err(httparse::Error::TooManyHeaders) => Self::Rejected(431, format!("expected at most {MOST_HEADERS} headers\n")),
            Err(error) => Self::Rejected(400, format!("expected an HTTP/1.1 request: {error}\n")),
        }
    }
}

fn request_of(request: &httparse::Request<'_, '_>) -> Result<Request, (u16, String)> {
    let values = |name: &'static str| request.headers.iter().filter(move |h| h.name.eq_ignore_ascii_case(name)).map(value);
    if values("transfer-encoding").next().is_some() || values("content-length").any(|length| length != "0") {
        return Err((400, "expected a request without a body\n".into()));
    }
    let head = request.method == Some("HEAD");
    if !head && request.method != Some("GET") {
        return Err((405, "expected GET or HEAD\n".into()));
    }
    let version = request.version.unwrap_or_default();
    if version > 0 && values("host").count() != 1 {
        return Err((400, "expected one header Host\n".into()));
    }
    let target = request.path.unwrap_or_default();
    // A request to a proxy holds the whole URL.
    let local = target.strip_prefix("http://").map_or(target, |rest| rest.find('/').map_or("/", |slash| &rest[slash..]));
    if !local.starts_with('/') {
        return Err((400, "expected an address that begins with /\n".into()));
    }
    let path = local.split(['?', '#']).next().unwrap_or_default().to_owned();
    let close = values("connection").any(|list| list.split(',').any(|word| word.trim().eq_ignore_ascii_case("close")));
    let has = values("if-none-match").next().map(str::to_owned);
    let accepts = values("accept-encoding").next().map(str::to_owned);
    let host = values("host").next().map(str::to_owned);
    Ok(Request { path, host, last: close || version == 0, head, has, accepts })
}

fn value<'a>(header: &Header<'a>) -> &'a str {
    std::str::from_utf8(header.value).unwrap_or("?")
}

/// Cache policy of a response.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CachePolicy {
    /// The content at the address never changes.
    Immutable,
    /// Clients must revalidate.
    Revalidate,
    /// Clients must not store it.
    NoStore,
}

impl CachePolicy {
    /// Returns the value of Cache-Control.
    fn control(self) -> &'static str {
        match self {
            Self::Immutable => "public, max-age=31536000, immutable",
            Self::Revalidate => "no-cache",
            Self::NoStore => "no-store",
        }
    }
}

/// A compressed form: content coding, body and ETag.
pub(crate) type CompressedForm = (&'static str, Arc<[u8]>, String);

/// A response.
#[derive(Debug)]
pub(crate) struct Response {
    status: u16,
    pub(crate) body: Arc<[u8]>,
    /// Bytes behind the body, so that responses can share a large body.
    pub(crate) tail: Arc<[u8]>,
    /// ETag; errors have none.
    tag: Option<String>,
    /// Media type.
    kind: &'static str,
    keep: CachePolicy,
    /// Compressed forms, best first.
    packed: Vec<CompressedForm>,
    /// Content coding of the body.
    encoding: Option<&'static str>,
}

impl Response {
    /// Makes a response with status 200.
    pub(crate) fn found(body: Arc<[u8]>, tag: String, kind: &'static str, keep: CachePolicy) -> Self {
        Self { status: 200, body, tail: [].into(), tag: Some(tag), kind, keep, packed: vec![], encoding: None }
    }

    /// Adds bytes behind the body.
    pub(crate) fn with_tail(self, tail: Arc<[u8]>) -> Self {
        Self { tail, ..self }
    }

    /// Adds compressed forms.
    pub(crate) fn or_packed(self, packed: Vec<CompressedForm>) -> Self {
        Self { packed, ..self }
    }

    /// Selects the best form that Accept-Encoding allows.
    pub(crate) fn accepted(self, accepts: Option<&str>) -> Self {
        let found = self.packed.iter().find(|(encoding, ..)| accepts.is_some_and(|accepts| is_among(accepts, encoding)));
        match found.cloned() {
            Some((encoding, body, tag)) => Self { body, tag: Some(tag), encoding: Some(encoding), ..self },
            None => self,
        }
    }

    /// Makes an error response.
    pub(crate) fn refused(status: u16, why: String) -> Self {
        let kind = "text/plain; charset=utf-8";
        Self {
            status,
            body: why.into_bytes().into(),
            tail: [].into(),
            tag: None,
            kind,
            keep: CachePolicy::NoStore,
            packed: vec![],
            encoding: None,
        }
    }

    /// Becomes status 304 if If-None-Match holds the ETag.
    pub(crate) fn unless(self, has: Option<&str>) -> Self {
        let known = |tag: &str| {
            has.is_some_and(|has| has.split(',').any(|one| ["*", tag].contains(&one.trim().trim_start_matches("W/"))))
        };
        if self.tag.as_deref().is_some_and(known) { Self { status: 304, body: [].into(), tail: [].into(), ..self } } else { self }
    }

    /// Returns the head. `last` announces that the connection closes.
    pub(crate) fn head(&self, headers: &str, last: bool) -> String {
        let &Self { status, ref body, ref tail, ref tag, kind, keep, ref packed, encoding } = self;
        let reason = match status {
            200 => "OK",
            304 => "Not Modified",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            431 => "Request Header Fields Too Large",
            _ => "Internal Server Error",
        };
        let more = if status == 405 { "allow: GET, HEAD\r\n" } else { "" };
        let tag = tag.as_ref().map(|tag| format!("etag: {tag}\r\n")).unwrap_or_default();
        // Caches must know that the form depends on Accept-Encoding.
        let vary = if packed.is_empty() { "" } else { "vary: accept-encoding\r\n" };
        let close = if last { "connection: close\r\n" } else { "" };
        // Status 304 has no body headers.
        let body = match status {
            304 => String::new(),
            _ => {
                let encoding = encoding.map(|encoding| format!("content-encoding: {encoding}\r\n")).unwrap_or_default();
                let length = body.len() + tail.len();
                format!("content-length: {length}\r\ncontent-type: {kind}\r\n{encoding}x-content-type-options: nosniff\r\n")
            }
        };
        format!("HTTP/1.1 {status} {reason}\r\n{body}{tag}{vary}cache-control: {}\r\n{headers}{more}{close}\r\n", keep.control())
    }
}

/// Returns true if Accept-Encoding allows this content coding.
fn is_among(accepts: &str, encoding: &str) -> bool {
    let refused = |parameter: &str| parameter.trim().strip_prefix("q=").is_some_and(|q| q.parse() == Ok(0.0_f32));
    accepts.split(',').any(|one| {
        let mut parts = one.split(';');
        parts.next().is_some_and(|name| name.trim().eq_ignore_ascii_case(encoding)) && !parts.any(refused)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(request: &str) -> Option<(String, bool)> {
        match HeaderParse::read(request.as_bytes()) {
            HeaderParse::Complete(Request { path, last, .. }, length) => {
                assert_eq!(length, request.len());
                Some((path, last))
            }
            _ => None,
        }
    }

    #[test]
    fn request_is_read_once_its_head_is_complete() {
        let whole = "GET /scene?x HTTP/1.1\r\nHost: x\r\n\r\n";
        assert_eq!(path(whole), Some(("/scene".into(), false)));
        (0..whole.len())
            .for_each(|cut| assert_eq!(HeaderParse::read(&whole.as_bytes()[..cut]), HeaderParse::Incomplete, "{cut}"));
        let two = whole.repeat(2);
        assert!(matches!(HeaderParse::read(two.as_bytes()), HeaderParse::Complete(_, length) if length == whole.len()));
        assert_eq!(path("GET / HTTP/1.1\r\nHost: x\r\nConnection: x, Close\r\n\r\n"), Some(("/".into(), true)));
        assert_eq!(path("GET / HTTP/1.0\r\n\r\n"), Some(("/".into(), true)));
        assert_eq!(path("GET http://a:1/b HTTP/1.1\r\nHost: x\r\n\r\n"), Some(("/b".into(), false)));
        assert_eq!(path("GET http://a HTTP/1.1\r\nHost: x\r\ncontent-length: 0\r\n\r\n"), Some(("/".into(), false)));
    }

    #[test]
    fn malformed_request_reports_expectation() {
        let wrong = |bytes: &[u8]| match HeaderParse::read(bytes) {
            HeaderParse::Rejected(status, why) => (status, why),
            head => panic!("{head:?}"),
        };
        assert!(wrong(b"\x16\x03\x01\x02\0\x01\0").1.contains("not https://"));
        assert_eq!(wrong(b"POST / HTTP/1.1\r\nHost: x\r\n\r\n"), (405, "expected GET or HEAD\n".into()));
        assert_eq!(wrong(b"GET / HTTP/1.1\r\n\r\n").1, "expected one header Host\n");
        assert_eq!(wrong(b"GET x HTTP/1.1\r\nHost: x\r\n\r\n").0, 400);
        assert_eq!(wrong(b"GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\n\r\n").0, 400);
        assert_eq!(wrong(b"\0\0").0, 400);
        assert_eq!(wrong(format!("GET /{}", "a".repeat(MAX_HEAD)).as_bytes()).0, 431);
        assert_eq!(wrong(format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(65)).as_bytes()).0, 431);
    }

    #[test]
    fn request_has_method_and_known_tags() {
        let asked = |request: &str| match HeaderParse::read(request.as_bytes()) {
            HeaderParse::Complete(asked, _) => asked,
            head => panic!("{head:?}"),
        };
        let whole = asked("HEAD / HTTP/1.1\r\nHost: x\r\nIf-None-Match: \"a\"\r\n\r\n");
        assert_eq!((whole.head, whole.has.as_deref()), (true, Some("\"a\"")));
        let plain = asked("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
        assert_eq!((plain.head, plain.has, plain.accepts), (false, None, None));
        let packed = asked("GET / HTTP/1.1\r\nHost: x\r\nAccept-Encoding: gzip, br\r\n\r\n");
        assert_eq!(packed.accepts.as_deref(), Some("gzip, br"));
    }

    #[test]
    fn body_is_compressed_as_accepted_with_own_tag() {
        let form = |name: &'static str| (name, name.as_bytes().into(), format!("\"{name}\""));
        let answer = || {
            let plain = Response::found(b"plain"[..].into(), "\"plain\"".into(), "text/css", CachePolicy::Revalidate);
            plain.or_packed(vec![form("br"), form("gzip")])
        };
        let sent = |accepts| answer().accepted(accepts);
        for (accepts, body) in [
            (Some("gzip, deflate, br, zstd"), "br"),
            (Some("br;q=0, GZIP;q=0.5"), "gzip"),
            (Some("gzip; q=0.000, brotli"), "plain"),
            (Some("identity"), "plain"),
            (None, "plain"),
        ] {
            assert_eq!(*sent(accepts).body, *body.as_bytes(), "{accepts:?}");
            assert!(sent(accepts).head("", false).contains("vary: accept-encoding\r\n"), "{accepts:?}");
        }
        let head = sent(Some("gzip")).head("", false);
        assert!(head.contains("content-length: 4\r\ncontent-type: text/css\r\ncontent-encoding: gzip\r\n"), "{head}");
        assert!(head.contains("etag: \"gzip\"\r\n") && !sent(None).head("", false).contains("content-encoding"), "{head}");
        let unchanged = sent(Some("gzip")).unless(Some("\"gzip\"")).head("", false);
        assert!(
            unchanged.starts_with("HTTP/1.1 304") && unchanged.contains("vary") && !unchanged.contains("content-"),
            "{unchanged}"
        );
        assert_eq!(*sent(None).unless(Some("\"gzip\"")).body, *b"plain", "another form");
    }

    #[test]
    fn response_head_has_length_type_and_close() {
        let refused = Response::refused(405, "no".into()).head("x-more: 1\r\n", true);
        assert!(refused.starts_with("HTTP/1.1 405 Method Not Allowed\r\ncontent-length: 2\r\n"), "{refused}");
        assert!(
            refused.contains("cache-control: no-store\r\nx-more: 1\r\nallow: GET, HEAD\r\nconnection: close\r\n\r\n"),
            "{refused}"
        );
        assert!(!refused.contains("etag"), "{refused}");
    }

    #[test]
    fn known_tag_gets_not_modified() {
        let answer = || Response::found(b"tile"[..].into(), "\"t\"".into(), "image/png", CachePolicy::Immutable);
        for has in ["\"t\"", "\"s\", \"t\"", "W/\"t\""] {
            let unchanged = answer().unless(Some(has));
            assert!(unchanged.body.is_empty(), "{has}");
            let head = unchanged.head("", false);
            assert_eq!(
                head,
                "HTTP/1.1 304 Not Modified\r\netag: \"t\"\r\ncache-control: public, max-age=31536000, immutable\r\n\r\n"
            );
        }
        for has in [None, Some("\"s\""), Some("t")] {
            assert_eq!(&*answer().unless(has).body, b"tile", "{has:?}");
        }
    }
}
