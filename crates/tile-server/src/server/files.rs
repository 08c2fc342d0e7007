//! A few files as a web site: those of the page.

use super::http::{CachePolicy, Packed, Response};
use super::listen::{Limits, ListeningServer, RequestHandler, listen};
use crate::protocol::etag_of;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;

/// Files by their addresses; nothing else is there.
#[derive(Debug, Default)]
pub struct StaticFiles {
    files: BTreeMap<String, StaticFile>,
}

/// A file.
#[derive(Debug)]
struct StaticFile {
    bytes: Arc<[u8]>,
    tag: String,
    /// As browsers name kinds of files.
    kind: &'static str,
    /// Compressed forms, the best first.
    packed: Vec<Packed>,
}

impl StaticFiles {
    /// Offers a file under its name, and `index.html` where no name is given; to who takes them, its compressed forms, the best first,
    /// each with how it is compressed.
    pub fn offer(&mut self, name: &str, bytes: &[u8], packed: Vec<(&'static str, Vec<u8>)>) {
        let address = if name == "index.html" { "/".into() } else { format!("/{name}") };
        let packed = packed.into_iter().map(|(encoding, bytes)| (encoding, bytes.as_slice().into(), etag_of(&bytes))).collect();
        self.files.insert(address, StaticFile { bytes: bytes.into(), tag: etag_of(bytes), kind: kind(name), packed });
    }

    /// The file at an address, if there is one.
    pub(super) fn file(&self, path: &str) -> Option<Response> {
        let StaticFile { bytes, tag, kind, packed } = self.files.get(path)?;
        // What is built anew is to be seen.
        Some(Response::found((Arc::clone(bytes), tag.clone()), kind, CachePolicy::Revalidate).or_packed(packed.clone()))
    }

    /// RequestHandler at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
    ///
    /// # Errors
    /// A sentence, where the address cannot be listened at.
    pub fn listen(self, address: SocketAddr) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, Limits::default()).map_err(|e| format!("{address}: cannot be listened at: {e}"))
    }
}

impl RequestHandler for StaticFiles {
    fn answer(&self, path: &str) -> Response {
        self.file(path).unwrap_or_else(|| Response::refused(404, "there is no such file; the page is at /\n".into()))
    }

    fn headers(&self) -> &str {
        ""
    }
}

fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        _ => "application/octet-stream",
    }
}
