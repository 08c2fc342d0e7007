//! Rendering device for a rate-limited path (HP, 1998; JP 2000-057370): fetches only the data that the picture needs.
//!
//! ```text
//!  server (110) --> path (104, 106, 108) --> polygons --> [rasterizer, z-test] --> cells (454) --> reference buffer (126)
//!       ^                  |                                                          |                     |
//!       |                  +--> tiles --> expander --+                     passes: identification (461)     |
//!       |                                            v                                |                     |
//!       +---- requests ---- tile load lists (136) --orders--> texture-data memory (130), final <------------+
//!                                                             rasterization (463, 472) --> pixel buffer (124)
//! ```
//!
//! Arithmetic without tokens and time: [`page`] (layers, tiles, marking), [`pyramid`] (texels), [`cell`], [`acquisition`],
//! [`texels`], [`colour`], [`encoding`], [`preview`]. Units: [`server`], [`path`], [`expander`], [`cells`], [`reference_buffer`],
//! [`identification`], [`tile_lists`], [`rasterization`].
//!
//! A frame passes through phases (Figure 4B). Each unit knows its own phase, and its input tokens change it. The machine as a
//! whole has no phase.

pub mod acquisition;
pub mod cell;
mod cell_work;
pub mod cells;
pub mod colour;
pub mod config;
pub mod encoding;
pub mod expander;
pub mod identification;
mod interpolators;
mod layer_figures;
mod layers;
mod leaving;
pub mod page;
pub mod path;
pub mod polygon_memory;
pub mod preview;
pub mod pyramid;
pub mod rasterization;
mod records;
pub mod reference_buffer;
pub mod server;
mod sizes;
mod slopes;
pub mod texels;
pub mod tile_lists;
pub mod tokens;
mod touched;
mod twin_tables;
mod widths;

pub use acquisition::{AcquiredTile, TileList, TileOrigin, TileState};
pub use cell::{CellFormat, ReferenceCell};
pub use cells::{Cells, CellsCounters, CellsState, brightness_range};
pub use config::{
    CellConfig, DepthPixel, EngineConfig, LightingMode, NumberFormat, PathConfig, RenderMode, RendererConfig, TileConfig,
    TileOrder, WrapOverride,
};
pub use encoding::{TileEncoding, TileFormat};
pub use expander::Expander;
pub use identification::{Identification, IdentificationCounters, IdentificationState};
pub use leaving::{UpcomingTiles, ViewUser, ViewpointEnds};
pub use page::{PyramidCut, PyramidLayer, TexelArea, TexelCentre, TexturePage, WrappedCoordinates};
pub use path::{Path, PathCounters, PathState};
pub use preview::PicturePreview;
pub use pyramid::{LayerTexels, ServedTexture};
pub use rasterization::{Rasterization, RasterizationCounters, RasterizationState};
pub use records::TileRecord;
pub use reference_buffer::{FilledBuffer, PreviewObserver, ReferenceBuffer, ReferenceBufferCounters, ReferenceBufferState};
pub use server::{ConventionalLoad, Server, ServerCounters, ServerState, TextureMemory, TileSource};
pub use sizes::TableSizes;
pub use texels::{LayerCounts, PageTexels};
pub use tile_lists::{TileLists, TileListsCounters, TileListsState};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
