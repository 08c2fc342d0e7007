//! Frames of OpenGL applications as scenes.
//!
//! apitrace records an application and writes the state behind a draw call as JSON. This crate turns the dumps of one frame into a glTF
//! scene that every device draws, with the application's view and picture.
//!
//! # Mapping
//! - *Geometry*: each draw call becomes an object. Its triangles keep vertices and indices. The matrix from object to clip space is
//!   read from the source of the vertex program, which must be a product of matrices with the position. The program is not executed.
//!   apitrace dumps transform feedback only of applications that record it themselves, so other programs are refused.
//! - *Fixed function*: vertices of immediate mode, client arrays and display lists come from the trace. Matrices, material and first
//!   light come from the dump. The coefficients of light are those multiples of the diffuse colour that are nearest to the material.
//! - *View*: world space is behind the last matrix of the product, else eye space. The camera holds the rest of the first draw call's
//!   product, so that camera times world is the application's matrix to the bit of rounding.
//! - *Surface*: fragment programs are not executed. Textures, base colour and lighting coefficients are found by the names of uniforms.
//! - *State*: viewport and culling are read. Other state is refused if it changes coverage, else left out with a warning.
//!
//! Every guess is a [note](GlFrame::notes), and a [`Mapping`] replaces it.
//!
//! # Format of a dump
//! The members `parameters`, `shaders`, `uniforms`, `buffers`, `textures` and `framebuffer` of `apitrace replay -D CALL`. A dump has at
//! most 4,096 vertices, none of the fixed function, and neither indices nor the arguments of the draw call. `basrelief capture` adds them as
//! the member `draw`.

mod calls;
mod compare;
mod draw;
mod dump;
mod fixed;
mod frame;
mod geometry;
mod gltf;
mod map_value;
mod mapping;
mod matrix;
mod normal_space;
mod picture;
mod program;
mod reader;
mod state;
mod surface;
mod text;
mod triangles;
mod vertices;

pub use calls::{BlobFiles, FrameCalls, StateDump, frames, with_draws};
pub use compare::{GeometryAgreement, PictureComparison, compare};
pub use frame::{DumpFile, GlFrame, import};
pub use mapping::{MapEntry, MapKey, Mapping};
pub use picture::ApplicationPicture;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
