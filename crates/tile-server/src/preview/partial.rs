//! A picture that grows while its tiles come, for who watches: between the pictures that the device shows, which has none there.

use super::live::LivePreview;
use basrelief_deferred_renderer::{FilledBuffer, PicturePreview, PreviewObserver, PyramidCut, TexturePage, TileSource, ViewUser};
use basrelief_reference::Picture;
use basrelief_signals::Texture;
use basrelief_sim::to_png;
use serde::Serialize;
use std::mem;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// From one picture to the next, at least.
const PAUSE: Duration = Duration::from_millis(250);
/// How much longer than a picture took to make it is rested: the run wants the processors, too.
const REST: u32 = 4;

/// How far the tiles of an acquisition have come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct TileCount {
    /// Its number, from 1.
    acquisition: u64,
    come: u64,
    needed: u64,
}

impl TileCount {
    /// What the picture is called meanwhile.
    pub(crate) fn name(self) -> String {
        format!("Acquisition {}: {} of {} tiles", self.acquisition, self.come, self.needed)
    }
}

/// A tile that has come: its page, its number, itself as it is encoded.
type Tile = (Arc<TexturePage>, u32, Arc<[u8]>);

/// What has come of the picture that is under way. It is coloured by who watches: where nobody does, never.
#[derive(Debug, Default)]
pub(crate) struct PartialFrame {
    /// None where tiles are not waited for, and while somebody colours.
    preview: Option<PicturePreview>,
    filled: Option<Arc<FilledBuffer>>,
    /// Tiles that the preview has not got yet.
    tiles: Vec<Tile>,
    come: TileCount,
    /// Tiles have come since the last picture.
    has_grown: bool,
    rests_until: Option<Instant>,
}

impl PartialFrame {
    /// From now on, coloured by this.
    pub(crate) fn begin(&mut self, preview: PicturePreview) {
        self.preview = Some(preview);
    }

    fn listed(&mut self, tiles: u64) {
        self.come = TileCount { acquisition: self.come.acquisition + 1, come: 0, needed: tiles };
    }

    fn came(&mut self, tile: Tile) {
        self.tiles.push(tile);
        self.come.come += 1;
        self.has_grown = true;
    }

    /// The device itself shows a picture of all that has come.
    pub(crate) fn is_shown(&mut self) {
        self.has_grown = false;
    }

    /// When the next picture may be coloured; none where there is nothing new.
    pub(crate) fn due(&self, now: Instant) -> Option<Instant> {
        let is_ready = self.has_grown && self.preview.is_some() && self.filled.is_some();
        is_ready.then(|| self.rests_until.unwrap_or(now))
    }

    /// What the next picture is coloured from.
    pub(crate) fn take(&mut self) -> Option<PreviewRender> {
        let filled = Arc::clone(self.filled.as_ref()?);
        let preview = self.preview.take()?;
        self.has_grown = false;
        Some(PreviewRender { preview, filled, tiles: mem::take(&mut self.tiles), come: self.come, began: Instant::now() })
    }

    /// It is coloured.
    pub(crate) fn rest(&mut self, PreviewRender { preview, began, .. }: PreviewRender) {
        self.preview = Some(preview);
        self.rests_until = Some(Instant::now() + (REST * began.elapsed()).max(PAUSE));
    }
}

/// A picture that is being coloured.
#[derive(Debug)]
pub(crate) struct PreviewRender {
    preview: PicturePreview,
    filled: Arc<FilledBuffer>,
    tiles: Vec<Tile>,
    pub(crate) come: TileCount,
    began: Instant,
}

impl PreviewRender {
    /// The picture, a PNG.
    pub(crate) fn png(&mut self) -> Result<Vec<u8>, String> {
        for (page, tile, bytes) in self.tiles.drain(..) {
            self.preview.store(&page, tile, &bytes);
        }
        let FilledBuffer { width, height, .. } = *self.filled;
        let pixels = self.preview.picture(&self.filled);
        let rgb = pixels.iter().map(|pixel| pixel.unwrap_or_default()).collect();
        to_png(&Picture { width, height, rgb, covered: pixels.iter().map(Option::is_some).collect() })
    }
}

/// Tiles from elsewhere, watched as the device takes them.
#[derive(Debug)]
pub struct PreviewedTiles {
    source: Box<dyn TileSource>,
    watched: LivePreview,
}

impl PreviewedTiles {
    /// Shows a picture that grows with these tiles.
    pub fn new(source: Box<dyn TileSource>, watched: LivePreview, preview: PicturePreview) -> Self {
        watched.grow(|growing| growing.begin(preview));
        Self { source, watched }
    }
}

impl TileSource for PreviewedTiles {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.source.offer(texture);
    }

    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        self.watched.grow(|growing| growing.listed(tiles.len() as u64));
        self.source.announce(tiles);
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        let bytes = self.source.tile(page, tile)?;
        self.watched.grow(|growing| growing.came((Arc::clone(page), tile, Arc::clone(&bytes))));
        Ok(bytes)
    }

    fn user(&self) -> Option<Arc<dyn ViewUser>> {
        self.source.user()
    }

    fn onlooker(&self) -> Option<Arc<dyn PreviewObserver>> {
        Some(Arc::new(self.watched.clone()))
    }

    fn finest_bytes(&self, texture: &Arc<Texture>, cut: PyramidCut) -> Option<u64> {
        self.source.finest_bytes(texture, cut)
    }
}

impl PreviewObserver for LivePreview {
    fn filled(&self, filled: FilledBuffer) {
        self.grow(|growing| growing.filled = Some(Arc::new(filled)));
    }
}
