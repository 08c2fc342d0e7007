//! The parts of a glTF 2.0 document that this importer reads. Names and optional fields follow the specification.

use super::extras::Extras;
use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, Visitor};
use std::collections::BTreeMap;
use std::fmt::{Formatter, Result as FmtResult};

/// A non-negative integer; glTF allows to write it with a zero fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Int(pub u64);

impl Int {
    /// Returns the number as an index. A number too large for this platform is out of range of any list.
    pub(crate) fn index(self) -> usize {
        usize::try_from(self.0).unwrap_or(usize::MAX)
    }
}

impl<'de> Deserialize<'de> for Int {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct IntVisitor;
        impl Visitor<'_> for IntVisitor {
            type Value = Int;
            fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
                f.write_str("a non-negative integer")
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<Int, E> {
                Ok(Int(v))
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<Int, E> {
                // 2^53: above it a fraction of zero says nothing.
                if (0.0..=9_007_199_254_740_992.0).contains(&v) && v.floor() == v {
                    Ok(Int(v as u64))
                } else {
                    Err(E::invalid_value(serde::de::Unexpected::Float(v), &self))
                }
            }
        }
        deserializer.deserialize_any(IntVisitor)
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Document {
    pub asset: Asset,
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    pub scene: Option<Int>,
    #[serde(default)]
    pub scenes: Vec<SceneDef>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub meshes: Vec<MeshDef>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub buffers: Vec<Buffer>,
    #[serde(default)]
    pub materials: Vec<MaterialDef>,
    #[serde(default)]
    pub textures: Vec<TextureDef>,
    #[serde(default)]
    pub images: Vec<ImageDef>,
    #[serde(default)]
    pub samplers: Vec<SamplerDef>,
    #[serde(default)]
    pub cameras: Vec<CameraDef>,
    #[serde(default)]
    pub skins: Vec<SkinDef>,
    #[serde(default)]
    pub animations: Vec<IgnoredAny>,
    #[serde(default)]
    pub extensions: RootExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Asset {
    pub version: String,
    pub min_version: Option<String>,
}

#[derive(Default, Deserialize)]
pub(crate) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: Option<Lights>,
}

#[derive(Deserialize)]
pub(crate) struct Lights {
    pub lights: Vec<LightDef>,
}

#[derive(Deserialize)]
pub(crate) struct LightDef {
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default = "white")]
    pub color: [f64; 3],
    #[serde(default = "one")]
    pub intensity: f64,
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

fn one() -> f64 {
    1.0
}

#[derive(Deserialize)]
pub(crate) struct SceneDef {
    #[serde(default)]
    pub nodes: Vec<Int>,
    #[serde(default)]
    pub extras: Extras,
}

#[derive(Deserialize)]
pub(crate) struct Node {
    pub name: Option<String>,
    #[serde(default)]
    pub children: Vec<Int>,
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub mesh: Option<Int>,
    /// Weights of morph targets, in place of the mesh's own.
    pub weights: Option<Vec<f64>>,
    pub camera: Option<Int>,
    pub skin: Option<Int>,
    pub extensions: Option<Box<NodeExtensions>>,
    #[serde(default)]
    pub extras: Extras,
}

#[derive(Deserialize)]
pub(crate) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub light: Option<LightReference>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<Visibility>,
}

#[derive(Deserialize)]
pub(crate) struct LightReference {
    pub light: Int,
}

#[derive(Deserialize)]
pub(crate) struct Visibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
pub(crate) struct MeshDef {
    pub name: Option<String>,
    pub primitives: Vec<Primitive>,
    /// Weights of morph targets at rest.
    #[serde(default)]
    pub weights: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SkinDef {
    pub inverse_bind_matrices: Option<Int>,
    #[serde(default)]
    pub joints: Vec<Int>,
}

#[derive(Deserialize)]
pub(crate) struct Primitive {
    pub attributes: BTreeMap<String, Int>,
    pub indices: Option<Int>,
    pub material: Option<Int>,
    pub mode: Option<Int>,
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, Int>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Accessor {
    pub buffer_view: Option<Int>,
    #[serde(default)]
    pub byte_offset: Int,
    pub component_type: Int,
    #[serde(default)]
    pub normalized: bool,
    pub count: Int,
    #[serde(rename = "type")]
    pub kind: String,
    pub min: Option<Vec<f64>>,
    pub max: Option<Vec<f64>>,
    pub sparse: Option<Box<Sparse>>,
}

#[derive(Deserialize)]
pub(crate) struct Sparse {
    pub count: Int,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseIndices {
    pub buffer_view: Int,
    #[serde(default)]
    pub byte_offset: Int,
    pub component_type: Int,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseValues {
    pub buffer_view: Int,
    #[serde(default)]
    pub byte_offset: Int,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub buffer: Int,
    #[serde(default)]
    pub byte_offset: Int,
    pub byte_length: Int,
    pub byte_stride: Option<Int>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Buffer {
    pub byte_length: Int,
    pub uri: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct MaterialDef {
    pub name: Option<String>,
    pub pbr_metallic_roughness: Option<Pbr>,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<TextureInfo>,
    pub emissive_texture: Option<TextureInfo>,
    #[serde(default)]
    pub emissive_factor: [f64; 3],
    pub alpha_mode: Option<String>,
    #[serde(default)]
    pub double_sided: bool,
    #[serde(default)]
    pub extensions: BTreeMap<String, IgnoredAny>,
    #[serde(default)]
    pub extras: Extras,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Pbr {
    #[serde(default = "opaque_white")]
    pub base_color_factor: [f64; 4],
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_roughness_texture: Option<TextureInfo>,
}

fn opaque_white() -> [f64; 4] {
    [1.0; 4]
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct TextureInfo {
    pub index: Int,
    #[serde(default)]
    pub tex_coord: Int,
    /// Of a normal texture.
    pub scale: Option<f64>,
    #[serde(default)]
    pub extensions: TextureInfoExtensions,
}

#[derive(Default, Deserialize)]
pub(crate) struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub transform: Option<TextureTransform>,
}

#[derive(Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct TextureTransform {
    #[serde(default)]
    pub offset: [f64; 2],
    #[serde(default)]
    pub rotation: f64,
    #[serde(default = "unscaled")]
    pub scale: [f64; 2],
    pub tex_coord: Option<Int>,
}

fn unscaled() -> [f64; 2] {
    [1.0; 2]
}

#[derive(Deserialize)]
pub(crate) struct TextureDef {
    pub sampler: Option<Int>,
    pub source: Option<Int>,
    #[serde(default)]
    pub extensions: BTreeMap<String, OtherSource>,
}

/// Picture that an extension such as `KHR_texture_basisu` adds to a texture.
#[derive(Deserialize)]
pub(crate) struct OtherSource {
    pub source: Option<Int>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ImageDef {
    pub name: Option<String>,
    pub uri: Option<String>,
    pub buffer_view: Option<Int>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SamplerDef {
    pub mag_filter: Option<Int>,
    pub wrap_s: Option<Int>,
    pub wrap_t: Option<Int>,
}

#[derive(Deserialize)]
pub(crate) struct CameraDef {
    #[serde(rename = "type")]
    pub kind: String,
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
}

#[derive(Clone, Copy, Deserialize)]
pub(crate) struct Perspective {
    pub yfov: f64,
    pub znear: f64,
    pub zfar: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
pub(crate) struct Orthographic {
    pub xmag: f64,
    pub ymag: f64,
    pub znear: f64,
    pub zfar: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_may_have_a_zero_fraction() {
        assert_eq!(serde_json::from_str::<Int>("3.0").unwrap(), Int(3));
        for bad in ["3.5", "-1", "\"3\"", "1e300"] {
            assert!(serde_json::from_str::<Int>(bad).is_err(), "{bad}");
        }
    }
}
