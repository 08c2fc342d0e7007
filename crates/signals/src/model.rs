//! Scene data that the host sends to the geometry processor.

use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Mapping of texture coordinates outside 0..1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrapMode {
    /// The texture repeats.
    #[default]
    Repeat,
    /// The texture repeats, and every second copy is mirrored.
    Mirror,
    /// The edge texel extends.
    Clamp,
}

/// Filter between texels of one level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TexelFilter {
    /// Takes the texel whose area holds the sample point.
    Nearest,
    /// Takes the weighted mean of the four texels around the sample point.
    #[default]
    Bilinear,
}

/// Wrap modes in u and v, and the filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sampler {
    /// Wrap mode in u, then in v.
    pub wrap: [WrapMode; 2],
    /// Filter within a level.
    pub filter: TexelFilter,
}

/// One level of a texture: RGBA, 8 bits each, as stored (no sRGB decoding).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// Width \[texels\], at least 1.
    pub width: u32,
    /// Height \[texels\], at least 1.
    pub height: u32,
    /// `width * height` texels, top row first. Empty in a texture whose texels are [elsewhere](Texture::elsewhere).
    pub texels: Vec<[u8; 4]>,
}

/// A texture (118) or an ordinary colour texture, with its MIP levels.
///
/// A normal map stores unit tangent-space normals as RGB = round(127.5 * (n + 1)), +Y up (glTF convention), A = 255.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    /// Number within its display list or scene. Colour textures and normal maps share one numbering.
    pub id: u32,
    /// Name for messages.
    pub name: String,
    /// Wrap modes and filter.
    pub sampler: Sampler,
    /// Level 0 (finest) first. Each next level has max(1, floor(size / 2)) texels per side. There is at least one level.
    pub levels: Vec<Image>,
    /// Start of the texture in its memory, in texels. Each level of the earlier textures is padded to whole 4 x 4 blocks.
    pub offset: u64,
    /// SHA-256 of the finest level of a picture whose texels only a server has, as the server defines it. The levels then have
    /// sizes but no texels.
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
    /// Returns the defaults of this project (assumed): ka 0.1, kd 0.8, ks 0.4, n 32.
    fn default() -> Self {
        Self { ka: 0.1, kd: 0.8, ks: 0.4, n: 32.0 }
    }
}

/// Surface of an object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Number within its display list or scene.
    pub id: u32,
    /// Name for messages.
    pub name: String,
    /// RGBA factor. It multiplies the texture and the vertex colour.
    pub base_color: [f32; 4],
    /// Colour texture.
    pub color_texture: Option<Arc<Texture>>,
    /// Normal map. Its presence makes the surface a candidate for bump mapping.
    pub normal_map: Option<Arc<Texture>>,
    /// Factor of x and y of the tangent-space normal (glTF `normalTexture.scale`).
    pub normal_scale: f32,
    /// Lighting coefficients.
    pub lighting: Lighting,
    /// True if back faces are drawn too.
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

/// Indexed triangles in object space. Per-vertex arrays have the length of `positions`, but optional ones may be empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Positions in object space.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals. Never empty: importers compute them if the file has none.
    pub normals: Vec<[f32; 3]>,
    /// Unit tangents with handedness w = +-1. Never empty if the material has a normal map.
    pub tangents: Vec<[f32; 4]>,
    /// Coordinates of the colour texture, with the texture transform applied. May be empty.
    pub uv: Vec<[f32; 2]>,
    /// Coordinates of the normal map, with the texture transform applied. May be empty.
    pub uv_normal: Vec<[f32; 2]>,
    /// Vertex colours, RGBA. May be empty.
    pub colors: Vec<[f32; 4]>,
    /// Vertex numbers, three per triangle, counter-clockwise seen from the front. Each is below `positions.len()`.
    pub indices: Vec<u32>,
}

/// Shading mode of a polygon in the figure shading device, as in its mode register (14).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShadingMode {
    /// Normal interpolation: the specular term uses interpolated normals.
    #[default]
    Normal,
    /// Brightness interpolation: all terms are computed at the sample points and interpolated.
    Brightness,
    /// Polyhedron (constant shading): all pixels get the mean of the sample points.
    Polyhedron,
}

/// Settings of the figure shading device for a frame or an object. An object's settings override its frame's, and both override
/// the machine's configuration (`shade.mode`, `shade.ia`, `shade.is`). Other machines ignore them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShadingSettings {
    /// Shading mode.
    pub mode: Option<ShadingMode>,
    /// Ambient intensity Ia, 0..=16.
    pub ia: Option<f32>,
    /// Light intensity Is, 0..=16. It multiplies the intensity of every light.
    pub is: Option<f32>,
}

impl ShadingSettings {
    /// Largest value of Ia and Is.
    pub const MAX_INTENSITY: f32 = 16.0;

    /// Returns these settings, with unset ones taken from `other`.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { mode: self.mode.or(other.mode), ia: self.ia.or(other.ia), is: self.is.or(other.is) }
    }

    /// Returns name and value of the first of Ia and Is that is out of range.
    pub fn out_of_range(&self) -> Option<(&'static str, f32)> {
        let values = [("ia", self.ia), ("is", self.is)].into_iter().filter_map(|(name, value)| Some((name, value?)));
        values.into_iter().find(|(_, value)| !(0.0..=Self::MAX_INTENSITY).contains(value))
    }
}

/// A mesh placed in the world with its material. Code books and point lights are evaluated per object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Object {
    /// Number within the scene, counted from 0.
    pub id: u32,
    /// Name for messages.
    pub name: String,
    /// The triangles.
    pub mesh: Arc<Mesh>,
    /// Transform from object to world space, row-major.
    pub world: [f64; 16],
    /// Surface of the object.
    pub material: Arc<Material>,
    /// Number of reference normals if fixed when the object was modelled (spec variant (c)).
    pub entries: Option<u32>,
    /// Levels by which table and CLUT are coarser than the MIP level, fixed by the object's importance when it was modelled.
    pub bias: Option<u8>,
    /// Bump mapping if decided when the object was modelled (spec variant (d)). `None` leaves the decision to the machine.
    pub bump: Option<bool>,
    /// Settings of the figure shading device.
    pub shading: ShadingSettings,
}

impl Object {
    /// Numbers of reference normals that an object may have.
    pub const ENTRIES: RangeInclusive<u32> = 1..=65_536;
    /// Levels by which its table and CLUT may be coarser.
    pub const BIAS: RangeInclusive<u8> = 0..=7;
}

/// Position of a light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// A light at infinity.
    Directional {
        /// Unit direction towards the light, world space.
        to_light: [f32; 3],
    },
    /// A light at a point in world space, evaluated at the object's centre.
    Point {
        /// Position in world space.
        position: [f32; 3],
    },
}

/// One light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Light {
    /// Type and position.
    #[serde(flatten)]
    pub kind: LightKind,
    /// Factor of the diffuse and specular terms. It is 1 for a single light.
    pub intensity: f32,
}

/// View of a frame. Its fields are the keys of `--camera` files and of the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// View-projection matrix, row-major: clip = M \[x y z 1\]^T, OpenGL depth range.
    pub view_projection: [f64; 16],
    /// Unit direction to the (first) light, world space.
    pub to_light: [f64; 3],
    /// Unit direction to the viewer at infinity, world space.
    pub to_viewer: [f64; 3],
}

/// Maximum number of pixels of one picture: enough for 3840 x 2160. The machine's image, the reference image and the metrics between them take
/// about 80 bytes per pixel. No number in a file may request more than a gibibyte of memory.
pub const MAX_PICTURE_PIXELS: u64 = 1 << 23;

/// One picture of a sequence. Width times height is at most [`MAX_PICTURE_PIXELS`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Frame number, counted from 0.
    pub index: u32,
    /// Width of the picture \[pixels\].
    pub width: u32,
    /// Height of the picture \[pixels\].
    pub height: u32,
    /// View.
    pub camera: Camera,
    /// All lights, at least one.
    pub lights: Vec<Light>,
    /// Settings of the figure shading device.
    pub shading: ShadingSettings,
    /// Colour textures that are declared ahead of this frame, used or not. The first frame declares all colour textures of the
    /// scene.
    pub textures: Vec<Arc<Texture>>,
}

/// A scene as imported, known to the host only.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name of the file or of the demo.
    pub name: String,
    /// Objects in drawing order.
    pub objects: Vec<Arc<Object>>,
    /// All frames to draw, in order.
    pub frames: Vec<Arc<Frame>>,
    /// Parts that import left out or replaced, one sentence each.
    pub warnings: Vec<String>,
}

/// A command from the host to the geometry processor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Draw {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// The following triangles belong to this object.
    Object(Arc<Object>),
    /// A triangle of the current object, by number. Its indices are `3 * t ..= 3 * t + 2`.
    Triangle(u32),
    /// The frame is complete.
    FrameEnd,
}
