//! Pure graphics arithmetic that several units share: no state, no time, no I/O.
//!
//! - [`lighting`]: ambient + Lambert + Blinn-Phong, for CLUT entries and vertices;
//! - [`area`]: areas of polygons on the screen and in a texture, and the LOD computed from them;
//! - [`mod@lod`]: level of detail 0..=63, and the MIP levels and weights that it selects;
//! - [`texture`]: texels and weights of a sample;
//! - [`layout`]: addresses of texels in memory;
//! - [`footprint_lines`]: cache lines of samples;
//! - [`mod@reference_normals`]: the contents of the VQ tables (121);
//! - [`table_places`]: their addresses in memory (120);
//! - [`interpolation`]: interpolation of attributes over a triangle;
//! - [`scan`]: rasterization of a polygon.
//!
//! Arithmetic is in single precision; only tables are built in double precision. Transcendental functions come from `libm`, so
//! that every platform computes the same bits.

pub mod area;
pub mod footprint_lines;
pub mod interpolation;
pub mod layout;
pub mod lighting;
pub mod lod;
pub mod reference_normals;
pub mod scan;
pub mod table_places;
pub mod texture;

pub use area::{doubled_area, polygon_lod};
pub use footprint_lines::FootprintLines;
pub use interpolation::{AttributeGradient, fan_triangle, side_by_side, weights};
pub use layout::{BLOCK, BlockLayout, LevelPlace, TextureLayout, pixel_offset};
pub use lighting::{LightVector, brightness, light_vectors, saturated, saturated_beside};
pub use lod::{LEVELS, LevelSet, lod, select_levels};
pub use reference_normals::{MAX_ENTRIES, ReferenceNormals, TableError, TableSet, quantize_unit, reference_normals};
pub use scan::{MAX_BLOCK, PolygonScan, PolygonSpans, RasterGrid, fan_triangles};
pub use table_places::{TablePlaces, TableRoomError};
pub use texture::{LANES, SampleFootprints, SampleTaps, decode_normal, footprints, stored, taps, wrapped};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
