//! The display-list trace: the recorded output of the geometry processor (102).
//!
//! # Format
//!
//! JSON Lines, one [`TraceCommand`] per line, an object whose one key is the command's name:
//!
//! | command | place | meaning |
//! |---|---|---|
//! | `begin` | first | format, version, size of the pictures |
//! | `texture`, `material` | before their first use | definitions, by number |
//! | `frame` ... `frame_end` | | a picture: camera and lights. It declares all colour textures defined since the previous frame |
//! | `object` | in a frame | the polygons that follow belong to it |
//! | `shading` | directly ahead of `frame` or `object` | mode, Ia and Is of the figure shading device for it |
//! | `importance` | directly ahead of `object` | levels by which its VQ table and CLUT are coarser |
//! | `criterion` | in a frame | the texel value generator keeps this bound from here on |
//! | `polygon` | behind its object | a convex polygon in window coordinates |
//! | `expect` | outside frames | results that a machine must give for the trace; at most 64 |
//! | `end` | last | count of commands before it; without it a trace is truncated |
//!
//! An unknown command, an unknown field, a number that is not finite and an index out of range are errors. Numbers are
//! held exactly: shortest decimals that read back to the same bits. [`schema()`] gives the JSON schema of a line.
//!
//! The *binary twin* holds the same commands: eight magic bytes (`89 42 44 4c 0d 0a 1a 0a`), the version (32 bits,
//! little endian), then each command as a length (32 bits, little endian) and a [postcard](https://postcard.jamesmunns.com)
//! record in the order of fields of the types here. Either may be compressed with zstd as a whole. [`open`] tells the
//! forms apart by their first bytes.
//!
//! # Ways in and out
//!
//! ```text
//!   bytes --open--> Reader --commands--> Writer --> bytes            convert: lossless between all forms
//!                      |                    ^
//!                  Resolver              Recorder
//!                      v                    |
//!                  Control (tokens of the wires)       --> CanonicalHash
//! ```
//!
//! This crate reaches no file system: it is generic over [`Read`](std::io::Read) and [`Write`](std::io::Write), and
//! asks its caller for the files beside a trace through [`TextureFiles`].

mod canonical_hash;
mod check;
mod command;
mod data;
mod dent;
mod error;
mod form;
mod lent;
mod parameter_value;
mod reader;
mod recorder;
mod resolver;
mod schema;
mod sequence;
mod writer;

pub use canonical_hash::CanonicalHash;
pub use check::GUARD_BAND;
pub use command::{
    BeginCommand, Criterion, EndCommand, ExpectedResults, ExpectedTraffic, FORMAT, FrameBegin, FrameEnd, ImportanceWeights,
    LightRecord, MAX_EXPECTATIONS, MAX_SIDE, MAX_VERTICES, MaterialDefinition, ObjectBegin, PolygonRecord, ShadingRecord,
    TextureDefinition, TextureKind, TraceCommand, VERSION,
};
pub use data::{Digest, Texels};
pub use dent::DentedPolygons;
pub use error::{ErrorKind, TraceError, TracePlace};
#[cfg(feature = "zstd")]
pub use form::checked_encoder;
pub use form::{TraceEncoding, TraceForm, looks_compressed, looks_like_trace};
pub use parameter_value::{ParameterValue, ScalarValue};
pub use reader::{TraceReader, open};
pub use recorder::TraceRecorder;
pub use resolver::{NoFiles, PlacedExpectation, TextureFiles, TraceResolver};
pub use schema::schema;
pub use writer::{TraceWriter, convert, convert_with_texels};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
