//! Tokens on the wires: plain data, with no behaviour beyond conversion.
//!
//! There are three groups, in the order in which a picture flows through a machine:
//! - [`model`]: input of a geometry processor: meshes, materials, textures, lights, camera;
//! - [`polygon`]: output of a geometry processor: screen-space polygons. A display list records these;
//! - [`fragment`]: tokens between the units behind the rasterizer.
//!
//! [`packet`] defines the traits of pixel tokens that a depth test and a frame buffer need.
//!
//! [`GatheredLines`] are the lines of a picture's memory that a unit has open for writing, and [`LineFlags`] state which lines are clear.
//!
//! [`width`] lists the fields of each token on a wire, [`wire_fields`] packs them, [`attribution`] its attribution.
//!
//! [`inline_array`] maps small arrays without calls.
//!
//! [`layout`] is the address map of the one memory that several units share.
//!
//! [`schema_of`] makes JSON schemas of such data.
//!
//! [`Flow`] puts control tokens in band (law 7): every wire behind the geometry processor carries `Flow<T>`.
//!
//! Conventions: matrices are row-major and multiply column vectors (clip = M * \[x y z 1\]^T, OpenGL depth range). In window
//! coordinates x points right and **y down**. Pixel (0, 0) is top left, and its centre is (0.5, 0.5). Depth runs from 0 (near) to
//! 1 (far). Images store their top row first. Texture coordinates u, v follow glTF (v down).

pub mod attribution;
mod digest;
pub mod flow;
pub mod fragment;
pub mod gathered_lines;
pub mod inline_array;
pub mod layout;
pub mod line_flags;
pub mod model;
pub mod packet;
pub mod polygon;
pub mod quantization_memory;
pub mod schema;
pub mod width;
pub mod wire_fields;

pub use attribution::{Attribution, PixelSet};
pub use flow::{Control, Flow};
pub use fragment::{
    Fragment, MAX_SAMPLES, MAX_STAMP, NormalIndexes, PictureFlow, Pixel, PixelBlock, PseudoNormals, ShadedFragment, Stamp,
    StampLanes, StampNormals, StampSample, StampSamples,
};
pub use gathered_lines::GatheredLines;
pub use inline_array::{MapInline, from_fn_inline};
pub use line_flags::LineFlags;
pub use model::{
    Camera, Draw, Frame, Image, Light, LightKind, Lighting, MAX_PICTURE_PIXELS, Material, Mesh, Object, Sampler, Scene,
    ShadingMode, ShadingSettings, TexelFilter, Texture, WrapMode,
};
pub use packet::{
    ColorToken, DepthToken, LINE_NUMBER, LINE_PIXELS, PACKET_PIXELS, Packet, PixelPacket, PixelPlace, PixelToken, line_of, lines,
};
pub use polygon::{LightingStage, MeshInfo, ObjectInfo, Polygon, SentAttributes, Vertex, VertexAttributes};
pub use schema::{reference_pointer, resolve_reference, schema_of};
pub use wire_fields::{BitWidth, FieldWidth, SignalWidths, WireField, WireFields};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
