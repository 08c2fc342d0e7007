//! Auxiliary outputs of machine `defer`.

use super::aux_output::AuxForm;
use super::aux_spec::AuxOutputSpec;
use super::tile_lines::{write_reference_buffer, write_tiles};
use super::tile_pictures::{layer_depth_picture, tile_map_picture};
use basrelief_machines::defer::{DeferConfig, DeferLog};

pub(crate) const AUX_OUTPUTS: &[AuxOutputSpec<DeferConfig, DeferLog>] = &[
    AuxOutputSpec::rounds("image", "each picture of the progressive mode"),
    AuxOutputSpec::picture("layer-depth", AuxForm::NamedPicturePerFrame, "pyramid layer of each pixel", |_, log| match log {
        DeferLog::ReferenceBuffer(filled) => Some(layer_depth_picture(filled)),
        DeferLog::Tiles(_) | DeferLog::TileLists(_) => None,
    }),
    AuxOutputSpec::picture("tiles", AuxForm::PictureAtEnd, "the state of each tile", |_, log| match log {
        DeferLog::TileLists(lists) => Some(tile_map_picture(lists)),
        DeferLog::ReferenceBuffer(_) | DeferLog::Tiles(_) => None,
    }),
    AuxOutputSpec::lines("reference-buffer", "textured pixels", |_, log, out| match log {
        DeferLog::ReferenceBuffer(filled) => write_reference_buffer(filled, out),
        DeferLog::Tiles(_) | DeferLog::TileLists(_) => Ok(()),
    }),
    AuxOutputSpec::lines("tiles", "tiles acquired or reused", |frame, log, out| match log {
        DeferLog::Tiles(tiles) => write_tiles(frame, tiles, out),
        DeferLog::ReferenceBuffer(_) | DeferLog::TileLists(_) => Ok(()),
    }),
];
