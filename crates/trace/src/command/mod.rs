//! The commands of a display list, as they stand in a trace: plain data, one type per command.

mod definition;
mod expectation;
mod fields;

pub use definition::{MAX_SIDE, MaterialDefinition, TextureDefinition, TextureKind};
pub use expectation::{ExpectedResults, ExpectedTraffic, MAX_EXPECTATIONS};

use basrelief_signals::{Camera, Light, LightKind, MeshInfo, ShadingMode, ShadingSettings};
use fields::fields;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Value of `begin.format`.
pub const FORMAT: &str = "basrelief-display-list";
/// Version of the format that this crate reads and writes.
pub const VERSION: u32 = 1;
/// Maximum number of vertices of a polygon.
pub const MAX_VERTICES: usize = 64;

/// One command: one line of a trace, or one record of its binary twin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TraceCommand {
    /// Opens the trace.
    Begin(BeginCommand),
    /// Defines a texture.
    Texture(TextureDefinition),
    /// Defines a material.
    Material(MaterialDefinition),
    /// Opens a frame.
    Frame(FrameBegin),
    /// The polygons that follow belong to this object.
    Object(ObjectBegin),
    /// Draws a polygon.
    Polygon(PolygonRecord),
    /// Closes the frame.
    FrameEnd(FrameEnd),
    /// Expected results of a machine; up to 64, outside frames.
    Expect(Box<ExpectedResults>),
    /// Closes the trace.
    End(EndCommand),
    /// Shading settings of the figure shading device for the next frame or object.
    Shading(ShadingRecord),
    /// Importance of the next object.
    Importance(ImportanceWeights),
    /// Selects the accuracy criterion of the texel value generator.
    Criterion(Criterion),
}

impl TraceCommand {
    /// Names of all commands, in the order of their numbers in the binary form.
    pub const NAMES: [&'static str; 12] = [
        "begin",
        "texture",
        "material",
        "frame",
        "object",
        "polygon",
        "frame_end",
        "expect",
        "end",
        "shading",
        "importance",
        "criterion",
    ];

    /// Returns the name of the command in a line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Begin(_) => "begin",
            Self::Texture(_) => "texture",
            Self::Material(_) => "material",
            Self::Frame(_) => "frame",
            Self::Object(_) => "object",
            Self::Polygon(_) => "polygon",
            Self::FrameEnd(_) => "frame_end",
            Self::Expect(_) => "expect",
            Self::End(_) => "end",
            Self::Shading(_) => "shading",
            Self::Importance(_) => "importance",
            Self::Criterion(_) => "criterion",
        }
    }
}

/// First command: format, version and size of the pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BeginCommand {
    /// Always `basrelief-display-list`.
    pub format: String,
    /// Version of the format.
    pub version: u32,
    /// Width of every picture \[pixels\], 1..=16384.
    #[schemars(range(min = 1, max = MAX_SIDE))]
    pub width: u32,
    /// Height of every picture \[pixels\], 1..=16384; times the width at most 2^23.
    #[schemars(range(min = 1, max = MAX_SIDE))]
    pub height: u32,
    /// Program that wrote the trace. No version and no date, so that an unchanged trace keeps its hash.
    pub generator: String,
}

impl BeginCommand {
    /// Creates the beginning of a trace by this project's geometry processor (102).
    pub fn new(width: u32, height: u32) -> Self {
        Self { format: FORMAT.into(), version: VERSION, width, height, generator: "basrelief".into() }
    }
}

/// A light of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LightRecord {
    /// At infinity.
    Directional {
        /// Unit vector towards the light, world space.
        to_light: [f32; 3],
        /// Multiplies the diffuse and specular terms.
        intensity: f32,
    },
    /// At a point, evaluated at each object's centre.
    Point {
        /// World space.
        position: [f32; 3],
        /// Multiplies the diffuse and specular terms.
        intensity: f32,
    },
}

impl From<&Light> for LightRecord {
    fn from(light: &Light) -> Self {
        let intensity = light.intensity;
        match light.kind {
            LightKind::Directional { to_light } => Self::Directional { to_light, intensity },
            LightKind::Point { position } => Self::Point { position, intensity },
        }
    }
}

impl From<&LightRecord> for Light {
    fn from(light: &LightRecord) -> Self {
        match *light {
            LightRecord::Directional { to_light, intensity } => Self { kind: LightKind::Directional { to_light }, intensity },
            LightRecord::Point { position, intensity } => Self { kind: LightKind::Point { position }, intensity },
        }
    }
}

/// Opens a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrameBegin {
    /// Counted from 0.
    pub index: u32,
    /// The view.
    pub camera: Camera,
    /// All lights, 1..=1024.
    #[schemars(length(min = 1, max = 1024))]
    pub lights: Vec<LightRecord>,
}

fields! {
    /// Shading settings of the figure shading device for the next frame or object. Settings of an object precede those of its
    /// frame; missing settings are those of the machine's configuration. Other machines ignore them.
    ///
    /// A command and not fields of `frame` and `object`: the binary form has no field names, so that new fields would make
    /// older traces unreadable.
    pub struct ShadingRecord {} optional {
        /// Mode register (14).
        mode: Option<ShadingMode>,
        /// Ambient intensity Ia, 0..=16.
        #[schemars(range(min = 0.0, max = 16.0))]
        ia: Option<f32>,
        /// Light intensity Is, 0..=16; multiplies the intensity of every light.
        #[schemars(range(min = 0.0, max = 16.0))]
        is: Option<f32>,
    }
}

/// Importance of the next object. A command for the same reason as `shading`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ImportanceWeights {
    /// Levels by which its VQ table and CLUT are coarser than the MIP level, 0..=7.
    #[schemars(range(max = 7))]
    pub bias: u8,
}

impl From<ShadingSettings> for ShadingRecord {
    fn from(ShadingSettings { mode, ia, is }: ShadingSettings) -> Self {
        Self { mode, ia, is }
    }
}

impl From<&ShadingRecord> for ShadingSettings {
    fn from(&ShadingRecord { mode, ia, is }: &ShadingRecord) -> Self {
        Self { mode, ia, is }
    }
}

fields! {
    /// Begins an object, which owns the following polygons. The previous object is complete.
    pub struct ObjectBegin {
        /// Number.
        id: u32,
        /// For messages.
        name: String,
        /// Centre in world space, where point lights are evaluated.
        centre: [f32; 3],
    } optional {
        /// Number of reference normals, where the model fixes it, 1..=65536.
        #[schemars(range(min = 1, max = 65_536))]
        entries: Option<u32>,
        /// Sizes of the indexed mesh of the polygons. A binary record may end ahead of this field, which is then empty.
        mesh: Option<MeshInfo>,
    }
}

fields! {
    /// Draws a convex polygon as a fan around its first vertex. The arrays have one item per vertex; one in which
    /// every vertex has its default may be left out.
    pub struct PolygonRecord {
        /// Number of the current object.
        object: u32,
        /// Number of a material defined before.
        material: u32,
        /// Level of detail.
        #[schemars(range(max = 63))]
        lod: u8,
        /// Bump target.
        bump: bool,
        /// Cycle in which the geometry processor (102) would have delivered it unblocked; never falls.
        #[schemars(range(max = 9_007_199_254_740_992_u64))]
        arrival: u64,
        /// Window x and y \[pixels, y down, within +-2^19\], depth, 1 / w of the clip-space position (> 0). Depth is 0..=1. Because
        /// of rounding, corners at the near or far plane may have -1..=2, and the machine clamps the depth of each pixel.
        #[schemars(length(min = 3, max = MAX_VERTICES))]
        position: Vec<[f32; 4]>,
    } optional {
        /// Unit normal, world space. Default: 0, 0, 1.
        normal: Vec<[f32; 3]>,
        /// Tangent, world space, and handedness. Default: 0, 0, 0, 0.
        tangent: Vec<[f32; 4]>,
        /// Coordinates of the colour texture. Default: 0, 0.
        uv: Vec<[f32; 2]>,
        /// Coordinates of the normal map. Default: 0, 0.
        uv_normal: Vec<[f32; 2]>,
        /// Vertex colour, RGBA. Default: 1, 1, 1, 1.
        color: Vec<[f32; 4]>,
        /// Brightness of a polygon that is no bump target: ambient + diffuse, specular. Default: 1, 0.
        brightness: Vec<[f32; 2]>,
    }
}

/// Selects the accuracy criterion e of the texel value generator (its step 442), in a frame: behind `frame` for all of it, behind
/// `object` for that object. It holds until the next one; ahead of the first it is `texel.error_bound`. Other machines ignore it.
///
/// A command and not a field of `frame` and `object`: the binary form has no field names, so that a new field would make older
/// traces unreadable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Criterion {
    /// Largest displacement of a texel \[pixels\], 0.001..=1024.
    #[schemars(range(min = 0.001, max = 1024.0))]
    pub error_bound: f64,
}

/// Closes a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrameEnd {}

/// Last command: without it a trace is truncated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EndCommand {
    /// Number of commands before this one.
    pub commands: u64,
}
