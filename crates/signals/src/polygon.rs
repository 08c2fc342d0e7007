//! What the geometry processor hands on.

use crate::{Material, Shading};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A vertex of a screen-space polygon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vertex {
    /// Window x \[pixels\], y \[pixels, down\], depth 0..=1, and 1 / w of the clip-space position (> 0).
    pub position: [f32; 4],
    /// Unit normal, world space.
    pub normal: [f32; 3],
    /// Tangent, world space, and handedness; zero where there is no normal map.
    pub tangent: [f32; 4],
    /// Coordinates of the colour texture.
    pub uv: [f32; 2],
    /// Coordinates of the normal map.
    pub uv_normal: [f32; 2],
    /// Vertex colour, RGBA, without the material's factor.
    pub color: [f32; 4],
    /// Brightness at the vertex, for polygons that are no bump target: `[ka + kd.., ks..]`, the two terms apart.
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

/// A convex polygon in window coordinates, clipped, culled and projected: the unit of the display list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// Three or more, either winding (culling is done); drawn as a fan around the first.
    pub vertices: Vec<Vertex>,
    /// The surface.
    pub material: Arc<Material>,
    /// Number of the object it belongs to.
    pub object: u32,
    /// Level of detail 0..=63: 8 * log2(texels of level 0 per pixel), rounded.
    pub lod: u8,
    /// Bump target.
    pub bump: bool,
    /// Cycle at which the geometry processor would have delivered it, had nothing blocked it.
    pub arrival: u64,
}

/// Bytes of a number in single precision.
const NUMBER: u64 = 4;
/// Bytes of a colour, RGBA, 8 bits each (assumed: what vertex formats of the time had).
const COLOR: u64 = 4;

/// What a machine takes of vertices, beside their positions, where a surface has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Taken {
    /// Where surfaces are lit.
    pub lit: Lit,
    /// Tangents and coordinates of normal maps.
    pub normal_maps: bool,
    /// Coordinates of colour textures.
    pub textures: bool,
}

/// Where a machine lights surfaces, which says whether it takes normals or brightness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lit {
    /// Nowhere: neither.
    #[default]
    Nowhere,
    /// At the vertices, in the geometry processor: brightness.
    AtVertices,
    /// Bump targets in the machine, others at the vertices: normals of the ones, brightness of the others.
    Targets,
    /// In the machine: normals.
    InMachine,
}

/// Attributes of a vertex that go somewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    /// Normal.
    pub normal: bool,
    /// Tangent and coordinates of the normal map.
    pub normal_map: bool,
    /// Coordinates of the colour texture.
    pub texture: bool,
    /// Colour.
    pub color: bool,
    /// Brightness, its two terms.
    pub brightness: bool,
}

impl Taken {
    /// Attributes of a surface of this material that are handed on, as those of a bump target or not, with colours at its
    /// vertices or without.
    pub fn of(self, material: &Material, bump: bool, color: bool) -> Attributes {
        let normal = self.lit == Lit::InMachine || (self.lit == Lit::Targets && bump);
        let brightness = self.lit == Lit::AtVertices || (self.lit == Lit::Targets && !bump);
        let normal_map = self.normal_maps && bump && material.normal_map.is_some();
        Attributes { normal, normal_map, texture: self.textures && material.color_texture.is_some(), color, brightness }
    }
}

impl Attributes {
    /// What they take \[bytes\].
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
    /// On a link: a word with the number of its vertices, LOD and flags, a word each with the numbers of material and object
    /// \[bytes\].
    pub const HEAD_BYTES: u64 = 3 * NUMBER;
    /// Window coordinates of a vertex and 1 / w \[bytes\].
    pub const POSITION_BYTES: u64 = 4 * NUMBER;

    /// What it takes on a link to a machine \[bytes\]: its head, and of each vertex the position and what its material and its way
    /// through the machine need. Colours that are white at all vertices are left out, as a flag says.
    pub fn bytes(&self, taken: Taken) -> u64 {
        let is_coloured = self.vertices.iter().any(|v| v.color != [1.0; 4]);
        let attributes = taken.of(&self.material, self.bump, is_coloured);
        Self::HEAD_BYTES + self.vertices.len() as u64 * (Self::POSITION_BYTES + attributes.bytes())
    }
}

/// What the units need to know about an object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObjectInfo {
    /// Number, counted from 0.
    pub id: u32,
    /// For messages.
    pub name: String,
    /// Centre in world space: where point lights are evaluated.
    pub centre: [f32; 3],
    /// Number of reference normals, where the model fixes it.
    pub entries: Option<u32>,
    /// Levels by which table and CLUT are coarser than the MIP level, where the model says how important it is.
    pub bias: Option<u8>,
    /// How the figure shading device shades it.
    pub shading: Shading,
    /// What its mesh consists of, where that is known.
    pub mesh: Option<MeshInfo>,
}

/// What an indexed mesh consists of: what there is to send of it before any of its triangles is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshInfo {
    /// Vertices.
    pub vertices: u32,
    /// Indices: three per triangle.
    pub indices: u32,
    /// Vertices have coordinates of the colour texture.
    pub uv: bool,
    /// Vertices have colours.
    pub colors: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sampler, Texture};

    fn texture() -> Arc<Texture> {
        Arc::new(Texture {
            id: 0,
            name: String::new(),
            sampler: Sampler::default(),
            levels: Vec::new(),
            offset: 0,
            elsewhere: None,
        })
    }

    fn polygon(bump: bool, material: Material) -> Polygon {
        let (vertices, material) = (vec![Vertex::default(); 3], Arc::new(material));
        Polygon { vertices, material, object: 0, lod: 0, bump, arrival: 0 }
    }

    #[test]
    fn a_polygon_takes_the_bytes_of_what_its_material_and_its_way_need() {
        let bare = Material::default();
        let mapped = Material { normal_map: Some(texture()), ..Material::default() };
        let textured = Material { color_texture: Some(texture()), ..mapped.clone() };
        let bytes = |lit, bump, material: &Material| {
            polygon(bump, material.clone()).bytes(Taken { lit, normal_maps: true, textures: true })
        };
        let positions = 12 + 3 * 16;
        assert_eq!(bytes(Lit::Nowhere, true, &bare), positions);
        assert_eq!(bytes(Lit::Targets, true, &bare), positions + 3 * 12, "a normal");
        assert_eq!(bytes(Lit::Targets, false, &bare), positions + 3 * 8, "brightness");
        assert_eq!(bytes(Lit::Targets, true, &mapped), positions + 3 * (12 + 24), "with tangent and coordinates");
        assert_eq!(bytes(Lit::Targets, false, &mapped), positions + 3 * 8, "which no plain polygon needs");
        assert_eq!(bytes(Lit::Targets, true, &textured), positions + 3 * (12 + 24 + 8));
        assert_eq!(bytes(Lit::InMachine, false, &bare), positions + 3 * 12);
        let mut coloured = polygon(false, bare);
        coloured.vertices[1].color = [1.0, 0.0, 0.0, 1.0];
        assert_eq!(coloured.bytes(Taken::default()), positions + 3 * 4);
    }
}
