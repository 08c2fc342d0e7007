//! The parts of a glTF 2.0 document that this importer reads. Names and optional fields follow the specification.

use super::extras::BasreliefExtras;
use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, Visitor};
use std::collections::BTreeMap;
use std::fmt::{Formatter, Result as FmtResult};

/// A non-negative integer; glTF allows to write it with a zero fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GltfInteger(pub u64);

impl GltfInteger {
    /// Returns the number as an index. A number too large for this platform is out of range of any list.
    pub(crate) fn index(self) -> usize {
        usize::try_from(self.0).unwrap_or(usize::MAX)
    }
}

impl<'de> Deserialize<'de> for GltfInteger {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct IntVisitor;
        impl Visitor<'_> for IntVisitor {
            type Value = GltfInteger;
            fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
                f.write_str("a non-negative integer")
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<GltfInteger, E> {
                Ok(GltfInteger(v))
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<GltfInteger, E> {
                // 2^53: above it a fraction of zero says nothing.
                if (0.0..=9_007_199_254_740_992.0).contains(&v) && v.floor() == v {
                    Ok(GltfInteger(v as u64))
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
pub(crate) struct GltfDocument {
    pub asset: GltfAsset,
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    pub scene: Option<GltfInteger>,
    #[serde(default)]
    pub scenes: Vec<SceneDef>,
    #[serde(default)]
    pub nodes: Vec<GltfNode>,
    #[serde(default)]
    pub meshes: Vec<MeshDef>,
    #[serde(default)]
    pub accessors: Vec<GltfAccessor>,
    #[serde(default)]
    pub buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub buffers: Vec<GltfBuffer>,
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
pub(crate) struct GltfAsset {
    pub version: String,
    pub min_version: Option<String>,
}

#[derive(Default, Deserialize)]
pub(crate) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: Option<GltfLights>,
}

#[derive(Deserialize)]
pub(crate) struct GltfLights {
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
    pub range: Option<f64>,
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
    pub nodes: Vec<GltfInteger>,
    #[serde(default)]
    pub extras: BasreliefExtras,
}

#[derive(Deserialize)]
pub(crate) struct GltfNode {
    pub name: Option<String>,
    #[serde(default)]
    pub children: Vec<GltfInteger>,
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub mesh: Option<GltfInteger>,
    /// Weights of morph targets, in place of the mesh's own.
    pub weights: Option<Vec<f64>>,
    pub camera: Option<GltfInteger>,
    pub skin: Option<GltfInteger>,
    pub extensions: Option<Box<NodeExtensions>>,
    #[serde(default)]
    pub extras: BasreliefExtras,
}

#[derive(Deserialize)]
pub(crate) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub light: Option<LightReference>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<NodeVisibility>,
}

#[derive(Deserialize)]
pub(crate) struct LightReference {
    pub light: GltfInteger,
}

#[derive(Deserialize)]
pub(crate) struct NodeVisibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
pub(crate) struct MeshDef {
    pub name: Option<String>,
    pub primitives: Vec<GltfPrimitive>,
    /// Weights of morph targets at rest.
    #[serde(default)]
    pub weights: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SkinDef {
    pub inverse_bind_matrices: Option<GltfInteger>,
    #[serde(default)]
    pub joints: Vec<GltfInteger>,
}

#[derive(Deserialize)]
pub(crate) struct GltfPrimitive {
    pub attributes: BTreeMap<String, GltfInteger>,
    pub indices: Option<GltfInteger>,
    pub material: Option<GltfInteger>,
    pub mode: Option<GltfInteger>,
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, GltfInteger>>,
    #[serde(rename = "extensions")]
    pub _extensions: Option<NoExtension>,
}

/// Extensions of an object for which the importer supports none. Each of its keys is an ignored key.
#[derive(Deserialize)]
pub(crate) struct NoExtension {}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct GltfAccessor {
    pub buffer_view: Option<GltfInteger>,
    #[serde(default)]
    pub byte_offset: GltfInteger,
    pub component_type: GltfInteger,
    #[serde(default)]
    pub normalized: bool,
    pub count: GltfInteger,
    #[serde(rename = "type")]
    pub kind: String,
    pub min: Option<Vec<f64>>,
    pub max: Option<Vec<f64>>,
    pub sparse: Option<Box<SparseAccessor>>,
}

#[derive(Deserialize)]
pub(crate) struct SparseAccessor {
    pub count: GltfInteger,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseIndices {
    pub buffer_view: GltfInteger,
    #[serde(default)]
    pub byte_offset: GltfInteger,
    pub component_type: GltfInteger,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseValues {
    pub buffer_view: GltfInteger,
    #[serde(default)]
    pub byte_offset: GltfInteger,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub buffer: GltfInteger,
    #[serde(default)]
    pub byte_offset: GltfInteger,
    pub byte_length: GltfInteger,
    pub byte_stride: Option<GltfInteger>,
    #[serde(rename = "extensions")]
    pub _extensions: Option<NoExtension>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct GltfBuffer {
    pub byte_length: GltfInteger,
    pub uri: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct MaterialDef {
    pub name: Option<String>,
    pub pbr_metallic_roughness: Option<PbrMaterial>,
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
    pub extras: BasreliefExtras,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct PbrMaterial {
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
    pub index: GltfInteger,
    #[serde(default)]
    pub tex_coord: GltfInteger,
    /// Scale of a normal texture.
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
    pub tex_coord: Option<GltfInteger>,
}

fn unscaled() -> [f64; 2] {
    [1.0; 2]
}

#[derive(Deserialize)]
pub(crate) struct TextureDef {
    pub sampler: Option<GltfInteger>,
    pub source: Option<GltfInteger>,
    #[serde(default)]
    pub extensions: BTreeMap<String, OtherSource>,
}

/// Picture that an extension such as `KHR_texture_basisu` adds to a texture.
#[derive(Deserialize)]
pub(crate) struct OtherSource {
    pub source: Option<GltfInteger>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ImageDef {
    pub name: Option<String>,
    pub uri: Option<String>,
    pub buffer_view: Option<GltfInteger>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SamplerDef {
    pub mag_filter: Option<GltfInteger>,
    pub min_filter: Option<GltfInteger>,
    pub wrap_s: Option<GltfInteger>,
    pub wrap_t: Option<GltfInteger>,
}

#[derive(Deserialize)]
pub(crate) struct CameraDef {
    #[serde(rename = "type")]
    pub kind: String,
    pub perspective: Option<PerspectiveCamera>,
    pub orthographic: Option<OrthographicCamera>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct PerspectiveCamera {
    pub aspect_ratio: Option<f64>,
    pub yfov: f64,
    pub znear: f64,
    pub zfar: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
pub(crate) struct OrthographicCamera {
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
        assert_eq!(serde_json::from_str::<GltfInteger>("3.0").unwrap(), GltfInteger(3));
        for bad in ["3.5", "-1", "\"3\"", "1e300"] {
            assert!(serde_json::from_str::<GltfInteger>(bad).is_err(), "{bad}");
        }
    }
}
