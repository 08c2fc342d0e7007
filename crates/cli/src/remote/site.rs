//! A few files as a web site: those of the page.

use super::http::{Answer, Keep, Packed};
use super::listen::{Answers, Limits, ListeningServer, listen};
use basrelief_served::tag_of;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;

/// Files by their addresses; nothing else is there.
#[derive(Debug, Default)]
pub struct Site {
    files: BTreeMap<String, SiteFile>,
}

/// A file.
#[derive(Debug)]
struct SiteFile {
    bytes: Arc<[u8]>,
    tag: String,
    /// As browsers name kinds of files.
    kind: &'static str,
    /// Compressed forms, the best first.
    packed: Vec<Packed>,
}

impl Site {
    /// Offers a file under its name, and `index.html` where no name is given; to who takes them, its compressed forms, the best first,
    /// each with how it is compressed.
    pub fn offer(&mut self, name: &str, bytes: &[u8], packed: Vec<(&'static str, Vec<u8>)>) {
        let address = if name == "index.html" { "/".into() } else { format!("/{name}") };
        let packed = packed.into_iter().map(|(encoding, bytes)| (encoding, bytes.as_slice().into(), tag_of(&bytes))).collect();
        self.files.insert(address, SiteFile { bytes: bytes.into(), tag: tag_of(bytes), kind: kind(name), packed });
    }

    /// The file at an address, if there is one.
    pub(super) fn file(&self, path: &str) -> Option<Answer> {
        let SiteFile { bytes, tag, kind, packed } = self.files.get(path)?;
        // What is built anew is to be seen.
        Some(Answer::found((Arc::clone(bytes), tag.clone()), kind, Keep::WhileItLasts).or_packed(packed.clone()))
    }

    /// Answers at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
    ///
    /// # Errors
    /// A sentence, where the address cannot be listened at.
    pub fn listen(self, address: SocketAddr) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, Limits::default()).map_err(|e| format!("{address}: cannot be listened at: {e}"))
    }
}

impl Answers for Site {
    fn answer(&self, path: &str) -> Answer {
        self.file(path).unwrap_or_else(|| Answer::refused(404, "there is no such file; the page is at /\n".into()))
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
