//! What the host hands to the geometry processor.

use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How texture coordinates outside 0..1 are mapped back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wrap {
    /// The texture repeats.
    #[default]
    Repeat,
    /// It repeats, every other time mirrored.
    Mirror,
    /// The edge texel extends.
    Clamp,
}

/// How texels are filtered within a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// The texel whose area holds the sample point.
    Nearest,
    /// Four texels around the sample point, weighted.
    #[default]
    Bilinear,
}

/// Wrap modes in u and v, and the filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sampler {
    /// Wrap mode in u, then in v.
    pub wrap: [Wrap; 2],
    /// Filter within a level.
    pub filter: Filter,
}

/// One level of a texture: RGBA, 8 bits each, as stored (no sRGB decoding).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// Width \[texels\], at least 1.
    pub width: u32,
    /// Height \[texels\], at least 1.
    pub height: u32,
    /// `width * height` texels, top row first; none in a texture whose texels are [elsewhere](Texture::elsewhere).
    pub texels: Vec<[u8; 4]>,
}

/// A texture (118) or an ordinary colour texture, with its MIP levels.
///
/// A normal map stores unit tangent-space normals as RGB = round(127.5 * (n + 1)), +Y up (glTF convention), A = 255.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    /// Number within its display list or scene; colour textures and normal maps share one numbering.
    pub id: u32,
    /// For messages.
    pub name: String,
    /// Wrap and filter.
    pub sampler: Sampler,
    /// Level 0 (finest) first; each next level has max(1, floor(size / 2)) texels per side. At least one level.
    pub levels: Vec<Image>,
    /// Texels of earlier textures in the same memory, each level padded to whole 4 x 4 blocks: where this one starts.
    pub offset: u64,
    /// SHA-256 of a picture whose texels only a server has: of its finest level, as the server defines it. Its levels then have
    /// sizes and no texels.
    #[serde(default)]
    pub elsewhere: Option<[u8; 32]>,
}

/// Coefficients of the lighting formula `ka + kd * max(N.L, 0) + ks * max(N.H, 0)^n`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lighting {
    /// Ambient coefficient, 0..=1.
    pub ka: f32,
    /// Diffuse coefficient, 0..=1.
    pub kd: f32,
    /// Specular coefficient, 0..=1.
    pub ks: f32,
    /// Specular exponent, 1..=1000.
    pub n: f32,
}

impl Default for Lighting {
    /// The defaults of this project (assumed): ka 0.1, kd 0.8, ks 0.4, n 32.
    fn default() -> Self {
        Self { ka: 0.1, kd: 0.8, ks: 0.4, n: 32.0 }
    }
}

/// Surface of an object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Number within its display list or scene.
    pub id: u32,
    /// For messages.
    pub name: String,
    /// RGBA factor, multiplies the texture and the vertex colour.
    pub base_color: [f32; 4],
    /// Ordinary texture.
    pub color_texture: Option<Arc<Texture>>,
    /// Normal map; its presence makes the surface a candidate for bump mapping.
    pub normal_map: Option<Arc<Texture>>,
    /// Multiplies x and y of the tangent-space normal (glTF `normalTexture.scale`).
    pub normal_scale: f32,
    /// Lighting coefficients.
    pub lighting: Lighting,
    /// Back faces are drawn too.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            id: 0,
            name: String::new(),
            base_color: [1.0; 4],
            color_texture: None,
            normal_map: None,
            normal_scale: 1.0,
            lighting: Lighting::default(),
            double_sided: false,
        }
    }
}

/// Indexed triangles in object space. Per-vertex arrays have the length of `positions`; an optional one may be empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Positions in object space.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals; never empty (importers compute them where the file has none).
    pub normals: Vec<[f32; 3]>,
    /// Unit tangents with handedness w = +-1; never empty where the material has a normal map.
    pub tangents: Vec<[f32; 4]>,
    /// Coordinates of the colour texture (texture transform applied); may be empty.
    pub uv: Vec<[f32; 2]>,
    /// Coordinates of the normal map (texture transform applied); may be empty.
    pub uv_normal: Vec<[f32; 2]>,
    /// Vertex colours, RGBA; may be empty.
    pub colors: Vec<[f32; 4]>,
    /// Three per triangle, counter-clockwise seen from the front; each below `positions.len()`.
    pub indices: Vec<u32>,
}

/// How the figure shading device shades a polygon: what its mode register (14) says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Normal interpolation: specular term by interpolated normals.
    #[default]
    Normal,
    /// Brightness interpolation: all terms at the sample points, interpolated.
    Brightness,
    /// Polyhedron (constant shading): mean of the sample points.
    Polyhedron,
}

/// What the host tells the figure shading device for a frame or an object; of an object it goes ahead of its frame's, and what
/// neither says is the machine's configuration (`shade.mode`, `shade.ia`, `shade.is`). Other machines do not ask.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shading {
    /// Mode.
    pub mode: Option<Mode>,
    /// Ambient intensity Ia, 0..=16.
    pub ia: Option<f32>,
    /// Light intensity Is, 0..=16; multiplies the intensity of every light.
    pub is: Option<f32>,
}

impl Shading {
    /// Largest Ia and Is.
    pub const MOST: f32 = 16.0;

    /// What this says, and where it says nothing, what `other` says.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { mode: self.mode.or(other.mode), ia: self.ia.or(other.ia), is: self.is.or(other.is) }
    }

    /// The first of Ia and Is that is not in its range, with its name.
    pub fn out_of_range(&self) -> Option<(&'static str, f32)> {
        let values = [("ia", self.ia), ("is", self.is)].into_iter().filter_map(|(name, value)| Some((name, value?)));
        values.into_iter().find(|(_, value)| !(0.0..=Self::MOST).contains(value))
    }
}

/// A mesh placed in the world with its material: what a code book or a point light is evaluated per.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Number within the scene, counted from 0.
    pub id: u32,
    /// For messages.
    pub name: String,
    /// The triangles.
    pub mesh: Arc<Mesh>,
    /// Object to world, row-major.
    pub world: [f64; 16],
    /// The surface.
    pub material: Arc<Material>,
    /// Number of reference normals fixed when the object was modelled (spec variant (c)).
    pub entries: Option<u32>,
    /// Levels by which its table and CLUT are coarser than the MIP level, fixed by its importance when it was modelled.
    pub bias: Option<u8>,
    /// Bump mapping decided when the object was modelled (spec variant (d)); `None` leaves it to the machine.
    pub bump: Option<bool>,
    /// How the figure shading device shades it.
    pub shading: Shading,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// At infinity; unit direction towards the light, world space.
    Directional {
        /// Unit vector.
        to_light: [f32; 3],
    },
    /// At a point in world space; evaluated at the object's centre.
    Point {
        /// World space.
        position: [f32; 3],
    },
}

/// One light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Light {
    /// Type and place.
    #[serde(flatten)]
    pub kind: LightKind,
    /// Multiplies the diffuse and specular terms; 1 for a single light.
    pub intensity: f32,
}

/// The view actually used; the keys of `--camera` files and of the report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Row-major, clip = M \[x y z 1\]^T, OpenGL depth range.
    pub view_projection: [f64; 16],
    /// Unit direction to the (first) light, world space.
    pub to_light: [f64; 3],
    /// Unit direction to the viewer at infinity, world space.
    pub to_viewer: [f64; 3],
}

/// Most pixels of one picture: enough for 3840 x 2160. The machine's picture, the exact one and the metrics between them
/// take about 80 bytes for each, and no number in a file may ask for more memory than a gibibyte.
pub const MAX_PICTURE_PIXELS: u64 = 1 << 23;

/// One picture of a sequence; width times height at most [`MAX_PICTURE_PIXELS`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Counted from 0.
    pub index: u32,
    /// Width of the picture \[pixels\].
    pub width: u32,
    /// Height of the picture \[pixels\].
    pub height: u32,
    /// The view.
    pub camera: Camera,
    /// All lights; at least one.
    pub lights: Vec<Light>,
    /// How the figure shading device shades it.
    pub shading: Shading,
    /// Colour textures that are declared ahead of this frame, whether a polygon names them or not: with the first frame all
    /// those of the scene.
    pub textures: Vec<Arc<Texture>>,
}

/// A scene as imported: what the host knows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name of the file or of the demo.
    pub name: String,
    /// In drawing order.
    pub objects: Vec<Arc<Object>>,
    /// All frames to draw, in order.
    pub frames: Vec<Arc<Frame>>,
    /// What was left out or replaced on import, one sentence each.
    pub warnings: Vec<String>,
}

/// Host to geometry processor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Draw {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// The triangles that follow are of this object.
    Object(Arc<Object>),
    /// Number of a triangle of the current object (its indices are `3 * t ..= 3 * t + 2`).
    Triangle(u32),
    /// The frame is complete.
    FrameEnd,
}
