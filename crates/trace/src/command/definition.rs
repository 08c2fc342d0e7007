//! Commands that define textures and materials.

use super::fields::fields;
use crate::data::{Digest, Texels};
use basrelief_signals::{Lighting, Sampler};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Maximum number of texels or pixels per side.
pub const MAX_SIDE: u32 = 16_384;

/// Use of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextureKind {
    /// Ordinary texture: RGBA, 4 bytes per texel.
    Color,
    /// Texture (118) of normals: RGB, 3 bytes per texel.
    Normal,
}

impl TextureKind {
    /// Bytes per texel in a trace.
    pub fn texel_bytes(self) -> u64 {
        match self {
            Self::Color => 4,
            Self::Normal => 3,
        }
    }
}

fields! {
    /// Defines a texture. Its texels stand either here (`data`) or in a file beside the trace (`file`): all levels,
    /// finest first, rows from the top, 8 bits per channel; each level has max(1, floor(size / 2)) texels per side of
    /// the one before.
    pub struct TextureDefinition {
        /// Number; colour textures and normal maps share one numbering. Defined once.
        id: u32,
        /// For messages.
        name: String,
        /// Use, and with it the channels.
        kind: TextureKind,
        /// Wrap and filter.
        sampler: Sampler,
        /// Width of level 0 \[texels\], 1..=16384.
        #[schemars(range(min = 1, max = MAX_SIDE))]
        width: u32,
        /// Height of level 0 \[texels\], 1..=16384.
        #[schemars(range(min = 1, max = MAX_SIDE))]
        height: u32,
        /// Number of levels, from 1 up to the one of 1 x 1 texel.
        #[schemars(range(min = 1, max = 15))]
        levels: u32,
        /// Texels ahead of it in its memory, each level padded to whole 4 x 4 blocks: a multiple of 16 below 2^40.
        offset: u64,
        /// Digest of the texels' bytes.
        sha256: Digest,
    } optional {
        /// The texels.
        data: Option<Texels>,
        /// File that holds the texels, by a relative path with `/` between its parts.
        file: Option<String>,
    }
}

impl TextureDefinition {
    /// Width and height of each level, finest first.
    pub fn level_sizes(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (width, height) = (self.width, self.height);
        (0..self.levels).map(move |k| {
            let side = |side: u32| side.checked_shr(k).unwrap_or(0).max(1);
            (side(width), side(height))
        })
    }

    /// Texels of all levels.
    pub fn texel_count(&self) -> u64 {
        self.level_sizes().map(|(width, height)| u64::from(width) * u64::from(height)).sum()
    }
}

fields! {
    /// Defines a material.
    pub struct MaterialDefinition {
        /// Number. Defined once.
        id: u32,
        /// For messages.
        name: String,
        /// RGBA factor.
        base_color: [f32; 4],
        /// Multiplies x and y of the tangent-space normal.
        normal_scale: f32,
        /// Lighting coefficients.
        lighting: Lighting,
    } optional {
        /// Number of a colour texture defined before.
        color_texture: Option<u32>,
        /// Number of a normal map defined before.
        normal_map: Option<u32>,
        /// Back faces are drawn too.
        double_sided: bool,
    }
}
