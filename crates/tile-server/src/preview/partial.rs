//! The partial image between two images of the device, updated as tiles arrive.

use basrelief_deferred_renderer::{FilledBuffer, PicturePreview, TexturePage};
use basrelief_reference::RgbPicture;
use basrelief_sim::to_png;
use serde::Serialize;
use std::mem;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Minimum time between two partial images.
const PAUSE: Duration = Duration::from_millis(250);
/// Pause after a partial image, as a multiple of its computing time, so that the run keeps the processors.
const REST: u32 = 4;

/// Received tiles of an acquisition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct TileCount {
    /// Number of the acquisition, from 1.
    acquisition: u64,
    come: u64,
    needed: u64,
}

impl TileCount {
    /// Returns the caption.
    pub(crate) fn name(self) -> String {
        format!("Acquisition {}: {} of {} tiles", self.acquisition, self.come, self.needed)
    }
}

/// A received tile: page, number and encoded bytes.
type ReceivedTile = (Arc<TexturePage>, u32, Arc<[u8]>);

/// State of the partial image. A request of the browser computes it; without a browser it costs nothing.
#[derive(Debug, Default)]
pub(crate) struct PartialFrame {
    /// `None` without remote tiles, and while a thread computes an image.
    preview: Option<PicturePreview>,
    filled: Option<Arc<FilledBuffer>>,
    /// Tiles that the preview has not stored yet.
    tiles: Vec<ReceivedTile>,
    come: TileCount,
    /// True if tiles have arrived since the last image.
    has_grown: bool,
    rests_until: Option<Instant>,
}

impl PartialFrame {
    /// Starts with this preview.
    pub(crate) fn begin(&mut self, preview: PicturePreview) {
        self.preview = Some(preview);
    }

    pub(crate) fn begin_acquisition(&mut self, tiles: u64) {
        self.come = TileCount { acquisition: self.come.acquisition + 1, come: 0, needed: tiles };
    }

    /// Stores the filled buffer from which the image is computed.
    pub(crate) fn set_filled(&mut self, filled: FilledBuffer) {
        self.filled = Some(Arc::new(filled));
    }

    pub(crate) fn add_tile(&mut self, tile: ReceivedTile) {
        self.tiles.push(tile);
        self.come.come += 1;
        self.has_grown = true;
    }

    /// The device shows an image of all received tiles.
    pub(crate) fn is_shown(&mut self) {
        self.has_grown = false;
    }

    /// Returns the earliest time of the next partial image; `None` without new tiles.
    pub(crate) fn due_time(&self, now: Instant) -> Option<Instant> {
        let is_ready = self.has_grown && self.preview.is_some() && self.filled.is_some();
        is_ready.then(|| self.rests_until.unwrap_or(now))
    }

    /// Takes the input of the next partial image.
    pub(crate) fn take(&mut self) -> Option<PreviewRender> {
        let filled = Arc::clone(self.filled.as_ref()?);
        let preview = self.preview.take()?;
        self.has_grown = false;
        Some(PreviewRender { preview, filled, tiles: mem::take(&mut self.tiles), come: self.come, began: Instant::now() })
    }

    /// Returns the preview after an image.
    pub(crate) fn return_preview(&mut self, PreviewRender { preview, began, .. }: PreviewRender) {
        self.preview = Some(preview);
        self.rests_until = Some(Instant::now() + (REST * began.elapsed()).max(PAUSE));
    }
}

/// A partial image in progress.
#[derive(Debug)]
pub(crate) struct PreviewRender {
    preview: PicturePreview,
    filled: Arc<FilledBuffer>,
    tiles: Vec<ReceivedTile>,
    pub(crate) come: TileCount,
    began: Instant,
}

impl PreviewRender {
    /// Computes the image as a PNG.
    pub(crate) fn png(&mut self) -> Result<Vec<u8>, String> {
        for (page, tile, bytes) in self.tiles.drain(..) {
            self.preview.store(&page, tile, &bytes);
        }
        let FilledBuffer { width, height, .. } = *self.filled;
        let pixels = self.preview.picture(&self.filled);
        let rgb = pixels.iter().map(|pixel| pixel.unwrap_or_default()).collect();
        to_png(&RgbPicture::drawn([width, height], rgb, pixels.iter().map(Option::is_some).collect()))
    }
}
