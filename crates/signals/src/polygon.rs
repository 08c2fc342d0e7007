//! What the geometry processor hands on.

use crate::Material;
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
