//! The parts of a state dump that an import reads.

use crate::draw::DrawCall;
use crate::vertices::VertexColumns;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// State of OpenGL behind a draw call, as `apitrace replay -D CALL` writes it. `draw` is an addition of `basrelief capture`.
#[derive(Deserialize)]
pub(crate) struct GlDump {
    pub draw: Option<DrawCall>,
    #[serde(default)]
    pub parameters: BTreeMap<String, Value>,
    /// Source texts by type of shader.
    #[serde(default)]
    pub shaders: BTreeMap<String, String>,
    #[serde(default)]
    pub uniforms: BTreeMap<String, Value>,
    #[serde(default)]
    pub buffers: GlBuffers,
    #[serde(default)]
    pub textures: BTreeMap<String, ImageRecord>,
    #[serde(default)]
    pub framebuffer: BTreeMap<String, ImageRecord>,
}

/// Contents of buffers.
#[derive(Default, Deserialize)]
pub(crate) struct GlBuffers {
    /// Generic attributes of the first vertices in the bound buffers.
    #[serde(default)]
    pub vertices: VertexColumns,
}

/// A picture: a texture level or a part of the frame buffer.
#[derive(Deserialize)]
pub(crate) struct ImageRecord {
    #[serde(rename = "__width__")]
    pub width: u32,
    #[serde(rename = "__height__")]
    pub height: u32,
    #[serde(rename = "__depth__", default = "one")]
    pub depth: u32,
    /// PNG or PFM in base64, possibly with line ends.
    #[serde(rename = "__data__")]
    pub data: String,
}

fn one() -> u32 {
    1
}
