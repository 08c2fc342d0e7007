//! What travels on the wires: plain data, no behaviour beyond conversion.
//!
//! Three groups, in the order in which a picture flows through a machine:
//! - [`model`]: what the host hands to a geometry processor: meshes, materials, textures, lights, camera;
//! - [`polygon`]: what a geometry processor hands on: screen-space polygons. A display list records these;
//! - [`fragment`]: what travels between the units behind the rasterizer.
//!
//! [`packet`] says what a depth test and a frame buffer ask of any token of pixels.
//!
//! [`GatheredLines`] are the lines of a picture's memory that a unit has open for writing.
//!
//! [`width`] says how many bits each takes on a wire, [`about`] what it is about.
//!
//! [`layout`] is the address map of the one memory that several units share.
//!
//! [`Flow`] puts control tokens in band (law 7): every wire behind the geometry processor carries `Flow<T>`.
//!
//! Conventions, everywhere: matrices are row-major and multiply column vectors (clip = M * \[x y z 1\]^T, OpenGL depth
//! range); window coordinates have x to the right and **y down**, pixel (0, 0) is top left and its centre is
//! (0.5, 0.5); depth runs from 0 (near) to 1 (far); images store their top row first; u, v follow glTF (v down).

pub mod about;
pub mod flow;
pub mod fragment;
pub mod gathered_lines;
pub mod layout;
pub mod model;
pub mod packet;
pub mod polygon;
pub mod quantization_memory;
pub mod width;

pub use about::{About, Pixels};
pub use flow::{Control, Flow};
pub use fragment::{
    Fragment, Indexes, Lanes, MAX_SAMPLES, MAX_STAMP, Normals, PictureFlow, Pixel, PixelBlock, PseudoNormals, Sample, Samples,
    Shaded, Stamp,
};
pub use gathered_lines::GatheredLines;
pub use model::{
    Camera, Draw, Filter, Frame, Image, Light, LightKind, Lighting, MAX_PICTURE_PIXELS, Material, Mesh, Mode, Object, Sampler,
    Scene, Shading, Texture, Wrap,
};
pub use packet::{
    ColorToken, DepthToken, LINE_NUMBER, LINE_PIXELS, PACKET_PIXELS, Packet, PixelPacket, PixelPlace, PixelToken, line_of, lines,
};
pub use polygon::{Attributes, Lit, MeshInfo, ObjectInfo, Polygon, Taken, Vertex};
pub use width::{Signal, Widths};
