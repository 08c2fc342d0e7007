//! The exhibits of machine `defer`: pictures of rounds, layer depth, tile load lists, the reference buffer, tiles.

use super::content::Form;
use super::spec::ExhibitSpec;
use super::tile_lines::{write_reference_buffer, write_tiles};
use super::tile_pictures::{layer_depth_picture, tile_map_picture};
use basrelief_deferred_renderer::{FilledBuffer, Page, TileList, TileRecord};
use basrelief_machines::defer::DeferConfig;
use std::sync::Arc;

/// What is logged.
#[derive(Debug)]
pub enum DeferLog {
    /// The reference buffer (126), filled by a frame.
    ReferenceBuffer(FilledBuffer),
    /// Tiles that came in a frame, and those of earlier frames that it was coloured from.
    Tiles(Vec<TileRecord>),
    /// Tile load lists (136) of all pages (132) at the end of the run.
    TileLists(Vec<(Arc<Page>, TileList)>),
}

pub(crate) const EXHIBITS: &[ExhibitSpec<DeferConfig, DeferLog>] = &[
    ExhibitSpec::rounds("image", "each picture of the progressive mode"),
    ExhibitSpec::picture("layer-depth", Form::NamedPicturePerFrame, "layer of the pyramid by pixel", |_, log| match log {
        DeferLog::ReferenceBuffer(filled) => Some(layer_depth_picture(filled)),
        DeferLog::Tiles(_) | DeferLog::TileLists(_) => None,
    }),
    ExhibitSpec::picture("tiles", Form::PictureAtEnd, "the state of each tile", |_, log| match log {
        DeferLog::TileLists(lists) => Some(tile_map_picture(lists)),
        DeferLog::ReferenceBuffer(_) | DeferLog::Tiles(_) => None,
    }),
    ExhibitSpec::lines("reference-buffer", "its textured pixels", |_, log, out| match log {
        DeferLog::ReferenceBuffer(filled) => write_reference_buffer(filled, out),
        DeferLog::Tiles(_) | DeferLog::TileLists(_) => Ok(()),
    }),
    ExhibitSpec::lines("tiles", "those acquired or used again", |frame, log, out| match log {
        DeferLog::Tiles(tiles) => write_tiles(frame, tiles, out),
        DeferLog::ReferenceBuffer(_) | DeferLog::TileLists(_) => Ok(()),
    }),
];
