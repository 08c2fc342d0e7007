//! A few files as a web site: those of the page.

use super::http::{Answer, Keep};
use super::listen::{Answers, Limits, ListeningServer, listen};
use basrelief_served::tag_of;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;

/// Files by their addresses; nothing else is there.
#[derive(Debug, Default)]
pub struct Site {
    /// With their tags, and their kinds as browsers name them.
    files: BTreeMap<String, (Arc<[u8]>, String, &'static str)>,
}

impl Site {
    /// Offers a file under its name, and `index.html` where no name is given.
    pub fn offer(&mut self, name: &str, bytes: &[u8]) {
        let address = if name == "index.html" { "/".into() } else { format!("/{name}") };
        self.files.insert(address, (bytes.into(), tag_of(bytes), kind(name)));
    }

    /// The file at an address, if there is one.
    pub(super) fn file(&self, path: &str) -> Option<Answer> {
        let (bytes, tag, kind) = self.files.get(path)?;
        // What is built anew is to be seen.
        Some(Answer::found((Arc::clone(bytes), tag.clone()), kind, Keep::WhileItLasts))
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
