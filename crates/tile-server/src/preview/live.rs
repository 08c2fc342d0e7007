//! `--watch`: the latest image, for a browser.

use super::partial::{PartialFrame, TileCount};
use crate::protocol::etag_of;
use crate::server::http::{CachePolicy, Response};
use crate::server::listen::{RequestHandler, ServerLimits, listen};
use serde_json::json;
use std::net::SocketAddr;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The page, which requests each next image and shows it.
const PAGE: &str = include_str!("page.html");
/// Longest time that a request for the next image stays open; shorter than timeouts of proxies and browsers.
const OPEN: Duration = Duration::from_secs(5);
/// Longest time that a finished run waits for the browser to fetch the last image.
const LAST: Duration = Duration::from_secs(3);

/// The latest image. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct LivePreview(Arc<SharedPreview>);

#[derive(Debug, Default)]
struct SharedPreview {
    shown: Mutex<PreviewState>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct PreviewState {
    /// Number of images so far.
    number: u64,
    /// The last image as a PNG, and its name.
    picture: Arc<[u8]>,
    name: String,
    /// No more images follow.
    over: bool,
    /// Time of the last request for the next image.
    asked: Option<Instant>,
    /// A browser has received the last image and its announcement.
    taken: bool,
    /// Received tiles, while the image is partial.
    tiles: Option<TileCount>,
    growing: PartialFrame,
}

impl PreviewState {
    /// Shows another image; an equal image only changes the name.
    fn show(&mut self, name: String, tiles: Option<TileCount>, png: &[u8]) {
        (self.name, self.tiles) = (name, tiles);
        if *self.picture != *png {
            self.picture = png.into();
            self.number += 1;
        }
    }

    /// Returns the JSON of the next image.
    fn state_json(&self, over: bool) -> Vec<u8> {
        json!({ "picture": self.number, "name": self.name, "tiles": self.tiles, "over": over }).to_string().into_bytes()
    }
}

impl LivePreview {
    /// Starts to listen at an address; port 0 selects a free port. Returns the address.
    ///
    /// # Errors
    /// The address cannot be used.
    pub fn listen(&self, address: SocketAddr) -> Result<SocketAddr, String> {
        listen(self.clone(), address, ServerLimits::default()).map(|(address, _)| address)
    }

    fn lock(&self) -> MutexGuard<'_, PreviewState> {
        self.0.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows an image. An image equal to the previous one only changes the name.
    pub fn show(&self, name: &str, png: &[u8]) {
        let mut shown = self.lock();
        shown.growing.is_shown();
        shown.show(name.into(), None, png);
        self.0.changed.notify_all();
    }

    /// Renames the last image.
    pub fn rename(&self, name: &str) {
        self.lock().name = name.into();
    }

    /// Updates the partial image.
    pub(crate) fn update_partial(&self, grow: impl FnOnce(&mut PartialFrame)) {
        grow(&mut self.lock().growing);
        self.0.changed.notify_all();
    }

    /// Computes the partial image, and shows it unless the device has shown another meanwhile.
    fn compute_partial<'a>(&'a self, mut shown: MutexGuard<'a, PreviewState>) -> MutexGuard<'a, PreviewState> {
        let Some(mut colouring) = shown.growing.take() else { return shown };
        let name = shown.name.clone();
        drop(shown);
        let png = colouring.png();
        let mut shown = self.lock();
        // Names are unique: they are those of the device, or count tiles.
        if let (Ok(png), true) = (png, shown.name == name) {
            shown.show(colouring.come.name(), Some(colouring.come), &png);
        }
        shown.growing.return_preview(colouring);
        self.0.changed.notify_all();
        shown
    }

    /// Announces the end. Waits for a browser that still requests images to fetch the last one.
    pub fn finish(&self) {
        let mut shown = self.lock();
        shown.over = true;
        self.0.changed.notify_all();
        if shown.asked.is_some_and(|asked| asked.elapsed() < OPEN + LAST) {
            let waited = self.0.changed.wait_timeout_while(shown, LAST, |shown| !shown.taken);
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
    }

    /// Waits up to some seconds for the image after this number.
    fn wait_for_image(&self, number: u64) -> Response {
        let mut shown = self.lock();
        shown.asked = Some(Instant::now());
        let end = Instant::now() + OPEN;
        while shown.number <= number && !shown.over {
            let now = Instant::now();
            let due = shown.growing.due_time(now);
            if now >= end {
                break;
            }
            if due.is_some_and(|due| due <= now) {
                shown = self.compute_partial(shown);
                continue;
            }
            let next = due.map_or(end, |due| due.min(end));
            let waited = self.0.changed.wait_timeout(shown, next - now);
            shown = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        let over = shown.over && shown.number <= number;
        shown.asked = Some(Instant::now());
        let told = shown.state_json(over);
        Response::found(told.clone().into(), etag_of(&told), "application/json", CachePolicy::NoStore)
    }
}

impl RequestHandler for LivePreview {
    fn answer(&self, path: &str) -> Response {
        let number = |prefix| path.strip_prefix(prefix).and_then(|number: &str| number.parse::<u64>().ok());
        if path == "/" {
            let page = PAGE.as_bytes();
            return Response::found(page.into(), etag_of(page), "text/html; charset=utf-8", CachePolicy::Revalidate);
        }
        if let Some(number) = number("/after/") {
            return self.wait_for_image(number);
        }
        let shown = self.lock();
        match number("/picture/") {
            // The latest image answers every number.
            Some(1..) if shown.number > 0 => {
                Response::found(Arc::clone(&shown.picture), etag_of(&shown.picture), "image/png", CachePolicy::NoStore)
            }
            _ => Response::refused(404, "expected /, /after/NUMBER or, once there is one, /picture/NUMBER\n".into()),
        }
    }

    fn headers(&self) -> &str {
        ""
    }

    /// The process ends after this, so only a response that is sent completely counts.
    fn sent(&self, answer: &Response) {
        let mut shown = self.lock();
        if shown.over && *answer.body == *shown.state_json(true) {
            shown.taken = true;
            self.0.changed.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn run_ends_once_last_response_is_sent() {
        let watched = LivePreview::default();
        watched.show("image.png", b"a picture");
        let early = watched.answer("/after/0");
        let run = thread::spawn({
            let watched = watched.clone();
            move || watched.finish()
        });
        let last = watched.answer("/after/1");
        watched.sent(&early);
        thread::sleep(LAST / 10);
        assert!(!run.is_finished(), "nobody knows yet that it is over");
        let began = Instant::now();
        watched.sent(&last);
        run.join().expect("ends");
        assert!(began.elapsed() < LAST / 2, "{:?}", began.elapsed());
    }
}
