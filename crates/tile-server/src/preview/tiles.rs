//! Tiles that also go to the live preview.

use super::live::LivePreview;
use basrelief_deferred_renderer::{FilledBuffer, PicturePreview, PreviewObserver, PyramidCut, TexturePage, TileSource, ViewUser};
use basrelief_signals::Texture;
use std::sync::Arc;

/// A tile source that also feeds the live preview.
#[derive(Debug)]
pub struct PreviewedTiles {
    source: Box<dyn TileSource>,
    watched: LivePreview,
}

impl PreviewedTiles {
    /// Wraps a tile source.
    pub fn new(source: Box<dyn TileSource>, watched: LivePreview, preview: PicturePreview) -> Self {
        watched.update_partial(|growing| growing.begin(preview));
        Self { source, watched }
    }
}

impl TileSource for PreviewedTiles {
    fn offer(&mut self, texture: &Arc<Texture>) {
        self.source.offer(texture);
    }

    fn announce(&mut self, tiles: &[(Arc<TexturePage>, u32)]) {
        self.watched.update_partial(|growing| growing.begin_acquisition(tiles.len() as u64));
        self.source.announce(tiles);
    }

    fn tile(&mut self, page: &Arc<TexturePage>, tile: u32) -> Result<Arc<[u8]>, String> {
        let bytes = self.source.tile(page, tile)?;
        self.watched.update_partial(|growing| growing.add_tile((Arc::clone(page), tile, Arc::clone(&bytes))));
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
        self.update_partial(|growing| growing.set_filled(filled));
    }
}
