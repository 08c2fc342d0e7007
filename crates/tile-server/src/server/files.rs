//! Static files over HTTP: the page in a browser.

use super::http::{CachePolicy, CompressedForm, Response};
use super::listen::{ListeningServer, RequestHandler, ServerLimits, listen};
use crate::protocol::etag_of;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;

/// Files by path.
#[derive(Debug, Default)]
pub struct StaticFiles {
    files: BTreeMap<String, StaticFile>,
    host_names: Vec<String>,
}

/// A file.
#[derive(Debug)]
struct StaticFile {
    bytes: Arc<[u8]>,
    tag: String,
    /// Media type.
    kind: &'static str,
    /// Compressed forms, best first.
    packed: Vec<CompressedForm>,
}

impl StaticFiles {
    /// Adds a file under its name; `index.html` is also the root. Clients that accept it receive a compressed form, given with its content
    /// coding, best first.
    pub fn offer(&mut self, name: &str, bytes: &[u8], packed: Vec<(&'static str, Vec<u8>)>) {
        let address = if name == "index.html" { "/".into() } else { format!("/{name}") };
        let packed = packed.into_iter().map(|(encoding, bytes)| (encoding, bytes.as_slice().into(), etag_of(&bytes))).collect();
        self.files.insert(address, StaticFile { bytes: bytes.into(), tag: etag_of(bytes), kind: kind(name), packed });
    }

    /// Answers requests whose header Host holds one of these names, besides those to the address of the server.
    pub fn with_host_names(self, host_names: Vec<String>) -> Self {
        Self { host_names, ..self }
    }

    /// Returns the file at a path.
    pub(super) fn file(&self, path: &str) -> Option<Response> {
        let StaticFile { bytes, tag, kind, packed } = self.files.get(path)?;
        // Revalidated, so that a rebuilt page shows.
        Some(Response::found(Arc::clone(bytes), tag.clone(), kind, CachePolicy::Revalidate).or_packed(packed.clone()))
    }

    /// Starts to listen at an address; port 0 selects a free port. Returns the address and the running server.
    ///
    /// # Errors
    /// The address cannot be used.
    pub fn listen(self, address: SocketAddr) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, ServerLimits::default())
    }
}

impl RequestHandler for StaticFiles {
    fn answer(&self, path: &str) -> Response {
        self.file(path).unwrap_or_else(|| Response::refused(404, "there is no such file; the page is at /\n".into()))
    }

    fn headers(&self) -> &str {
        ""
    }

    fn host_names(&self) -> &[String] {
        &self.host_names
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
