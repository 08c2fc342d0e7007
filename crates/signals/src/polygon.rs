//! Screen-space polygons, the output of the geometry processor.

use crate::{Material, ShadingSettings};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A vertex of a screen-space polygon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vertex {
    /// Window x \[pixels\], y \[pixels, down\], depth 0..=1, and 1 / w of the clip-space position (> 0).
    pub position: [f32; 4],
    /// Unit normal, world space.
    pub normal: [f32; 3],
    /// Tangent in world space, and handedness. Zero if the surface has no normal map.
    pub tangent: [f32; 4],
    /// Coordinates of the colour texture.
    pub uv: [f32; 2],
    /// Coordinates of the normal map.
    pub uv_normal: [f32; 2],
    /// Vertex colour, RGBA, without the factor of the material.
    pub color: [f32; 4],
    /// Brightness at the vertex for polygons that are not bump targets: `[ka + kd.., ks..]`, the two terms separate.
    pub brightness: [f32; 2],
}

impl Default for Vertex {
    fn default() -> Self {
        Self {
            position: [0.0, 0.0, 0.0, 1.0],
            normal: [0.0, 0.0, 1.0],
            tangent: [0.0; 4],
            uv: [0.0; 2],
            uv_normal: [0.0; 2],
            color: [1.0; 4],
            brightness: [1.0, 0.0],
        }
    }
}

/// A convex polygon in window coordinates: clipped, culled and projected. Display lists consist of these.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// Three or more vertices of either winding, as culling is done. The polygon is drawn as a fan around the first.
    pub vertices: Vec<Vertex>,
    /// Surface of the polygon.
    pub material: Arc<Material>,
    /// Number of the object that the polygon belongs to.
    pub object: u32,
    /// Level of detail 0..=63: 8 * log2(texels of level 0 per pixel), rounded.
    pub lod: u8,
    /// True for bump targets.
    pub bump: bool,
    /// Cycle at which the geometry processor would have delivered the polygon if nothing had blocked it.
    pub arrival: u64,
}

/// Bytes of a number in single precision.
const NUMBER: u64 = 4;
/// Bytes of a colour, RGBA, 8 bits each (assumed: as in vertex formats of the time).
const COLOR: u64 = 4;

/// Vertex attributes, besides positions, that a machine accepts if a surface has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VertexAttributes {
    /// Stage that lights surfaces.
    pub lit: LightingStage,
    /// Accepts tangents and coordinates of normal maps.
    pub normal_maps: bool,
    /// Accepts coordinates of colour textures.
    pub textures: bool,
}

/// Stage at which a machine lights surfaces. It decides whether the machine accepts normals or brightness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightingStage {
    /// No lighting: neither.
    #[default]
    Nowhere,
    /// Lighting at the vertices, in the geometry processor: brightness.
    AtVertices,
    /// Bump targets are lit in the machine and need normals. Other polygons are lit at the vertices and need brightness.
    Targets,
    /// Lighting in the machine: normals.
    InMachine,
}

/// Vertex attributes that are sent for a polygon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SentAttributes {
    /// Normal.
    pub normal: bool,
    /// Tangent and coordinates of the normal map.
    pub normal_map: bool,
    /// Coordinates of the colour texture.
    pub texture: bool,
    /// Colour.
    pub color: bool,
    /// Brightness, with its two terms.
    pub brightness: bool,
}

impl VertexAttributes {
    /// Returns the attributes sent for a surface of this material. `bump` marks a bump target, `color` colours at the vertices.
    pub fn of(self, material: &Material, bump: bool, color: bool) -> SentAttributes {
        let normal = self.lit == LightingStage::InMachine || (self.lit == LightingStage::Targets && bump);
        let brightness = self.lit == LightingStage::AtVertices || (self.lit == LightingStage::Targets && !bump);
        let normal_map = self.normal_maps && bump && material.normal_map.is_some();
        SentAttributes { normal, normal_map, texture: self.textures && material.color_texture.is_some(), color, brightness }
    }

    /// Returns all attributes that a machine may accept.
    pub fn all(self) -> SentAttributes {
        let is_taken = |lit: [LightingStage; 2]| lit.contains(&self.lit);
        SentAttributes {
            normal: is_taken([LightingStage::InMachine, LightingStage::Targets]),
            normal_map: self.normal_maps,
            texture: self.textures,
            color: true,
            brightness: is_taken([LightingStage::AtVertices, LightingStage::Targets]),
        }
    }

    /// Returns the size of a triangle with all attributes \[bits\].
    pub fn triangle_bits(self) -> u32 {
        8 * (Polygon::HEAD_BYTES + 3 * (Polygon::POSITION_BYTES + self.all().bytes())) as u32
    }
}

impl SentAttributes {
    /// Returns the size of the attributes \[bytes\].
    #[inline]
    pub fn bytes(self) -> u64 {
        let of = |there: bool, bytes: u64| if there { bytes } else { 0 };
        of(self.normal, 3 * NUMBER)
            + of(self.normal_map, 6 * NUMBER)
            + of(self.texture, 2 * NUMBER)
            + of(self.color, COLOR)
            + of(self.brightness, 2 * NUMBER)
    }
}

impl Polygon {
    /// Size of a polygon's head on a link \[bytes\]: one word with vertex count, LOD and flags, and one word each for the numbers
    /// of material and object.
    pub const HEAD_BYTES: u64 = 3 * NUMBER;
    /// Size of the window coordinates and 1 / w of a vertex \[bytes\].
    pub const POSITION_BYTES: u64 = 4 * NUMBER;

    /// Returns the size of the polygon on a link to a machine \[bytes\]: its head, and for each vertex the position and the
    /// attributes sent. A flag leaves out colours that are white at all vertices.
    pub fn bytes(&self, taken: VertexAttributes) -> u64 {
        let is_coloured = self.vertices.iter().any(|v| v.color != [1.0; 4]);
        let attributes = taken.of(&self.material, self.bump, is_coloured);
        Self::HEAD_BYTES + self.vertices.len() as u64 * (Self::POSITION_BYTES + attributes.bytes())
    }
}

/// Data of an object that the units need.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectInfo {
    /// Object number, counted from 0.
    pub id: u32,
    /// Name for messages.
    pub name: String,
    /// Centre in world space, at which point lights are evaluated.
    pub centre: [f32; 3],
    /// Number of reference normals if the model fixes it.
    pub entries: Option<u32>,
    /// Levels by which table and CLUT are coarser than the MIP level if the model fixes the object's importance.
    pub bias: Option<u8>,
    /// Settings of the figure shading device.
    pub shading: ShadingSettings,
    /// Size of its mesh, if known.
    pub mesh: Option<MeshInfo>,
}

/// Contents of an indexed mesh, which are sent before any of its triangles is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshInfo {
    /// Number of vertices.
    pub vertices: u32,
    /// Number of indices: three per triangle.
    pub indices: u32,
    /// True if vertices have coordinates of the colour texture.
    pub uv: bool,
    /// True if vertices have colours.
    pub colors: bool,
    /// Digest of the contents, below 2^53. Instances of a mesh have the same one. 0 if it is unknown.
    #[serde(default)]
    pub digest: u64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Texture;

    fn texture() -> Arc<Texture> {
        Arc::new(Texture { ..Texture::default() })
    }

    fn polygon(bump: bool, material: Material) -> Polygon {
        let (vertices, material) = (vec![Vertex::default(); 3], Arc::new(material));
        Polygon { vertices, material, object: 0, lod: 0, bump, arrival: 0 }
    }

    #[test]
    fn polygon_bytes_follow_material_and_lighting() {
        let bare = Material::default();
        let mapped = Material { normal_map: Some(texture()), ..Material::default() };
        let textured = Material { color_texture: Some(texture()), ..mapped.clone() };
        let bytes = |lit, bump, material: &Material| {
            polygon(bump, material.clone()).bytes(VertexAttributes { lit, normal_maps: true, textures: true })
        };
        let positions = 12 + 3 * 16;
        assert_eq!(bytes(LightingStage::Nowhere, true, &bare), positions);
        assert_eq!(bytes(LightingStage::Targets, true, &bare), positions + 3 * 12, "a normal");
        assert_eq!(bytes(LightingStage::Targets, false, &bare), positions + 3 * 8, "brightness");
        assert_eq!(bytes(LightingStage::Targets, true, &mapped), positions + 3 * (12 + 24), "with tangent and coordinates");
        assert_eq!(bytes(LightingStage::Targets, false, &mapped), positions + 3 * 8, "which no plain polygon needs");
        assert_eq!(bytes(LightingStage::Targets, true, &textured), positions + 3 * (12 + 24 + 8));
        assert_eq!(bytes(LightingStage::InMachine, false, &bare), positions + 3 * 12);
        let mut coloured = polygon(false, bare);
        coloured.vertices[1].color = [1.0, 0.0, 0.0, 1.0];
        assert_eq!(coloured.bytes(VertexAttributes::default()), positions + 3 * 4);
    }
}
