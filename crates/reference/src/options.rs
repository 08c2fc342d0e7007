//! Choices that the exact picture shares with the machine it judges.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How textures and normal maps are filtered. It decides for every texture, whatever the texture's own
/// `sampler.filter` says: the picture is to be exact in one stated sense, and Mesa is asked the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextureFilter {
    /// No texture at all, normal maps included: the factor of the material times the vertex colour is left.
    None,
    /// The texel of level 0 that holds the sample point.
    Nearest,
    /// Four texels of level 0, weighted.
    Bilinear,
    /// Four texels each of the two levels next to the level of detail of the pixel, weighted; the level of detail is
    /// log2 of the longer of the two footprint axes \[texels of level 0 per pixel\].
    #[default]
    Trilinear,
    /// The texel of the level nearest to the level of detail; half way, of the finer one, as in OpenGL.
    NearestMipNearest,
    /// Four texels of that level, weighted.
    BilinearMipNearest,
    /// One texel each of the two levels next to the level of detail, weighted.
    NearestMipLinear,
}

/// Which change of the texture coordinates decides the level of detail of a pixel \[texels of level 0 per pixel\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LevelRule {
    /// The longer of the two footprint axes: log2 of the larger length of d(u, v)/dx and d(u, v)/dy.
    #[default]
    LongerAxis,
    /// The larger component along the scan line: log2(max(|du/dx|, |dv/dx|)), the rule of the MIP-map selector (320) of
    /// the texel value generator.
    AlongScanLine,
}

/// Which levels a colour texture has, and where its texels lie in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pyramid {
    /// Those that it is given with. A coordinate spans all levels alike: texel u * width of each.
    #[default]
    Given,
    /// Those of the rate-limited renderer, made of the finest one: sides halved and rounded up, an odd edge repeating
    /// its last texel, means `(sum of 4 + 2) >> 2`, down to the first level that fits in one tile. Texel u * width of
    /// the finest level is texel u * width / 2^k of level k.
    Tiled {
        /// Columns and rows of a tile \[texels\].
        tile: [u32; 2],
        /// Where the middle of a texel is.
        centre: TexelCentre,
    },
}

/// Where the middle of texel 0 is, in texels of its level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TexelCentre {
    /// At 0.5.
    #[default]
    Half,
    /// At 0: coarse levels are shifted by 0.5, 1.5, 3.5 ... finest texels.
    Integer,
}

/// What the highlight is coloured with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Components {
    /// base * (diffuse + specular): one brightness, as in the patent.
    #[default]
    Combined,
    /// base * diffuse + specular.
    Separate,
}

/// How the normal of a pixel comes about, and where light is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shading {
    /// Per pixel: the interpolated normal, tilted by the normal map where the material has one.
    #[default]
    NormalMap,
    /// Per pixel: the interpolated normal, renormalised (Phong). Normal maps are not looked at.
    Phong,
    /// At the vertices; what the two terms make of the vertex colour is interpolated perspective-correctly (Gouraud).
    Gouraud,
    /// Once per polygon: with its geometric normal in world space, its vertices counter-clockwise around it, as OpenGL
    /// programs draw flat shading. That of a mirrored object points inwards.
    Face,
    /// Once per polygon: the mean over its vertices (constant shading of the shading device).
    Mean,
    /// No light: the base colour alone.
    Texture,
}

/// Options of an exact picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Texture filter, for colour textures and normal maps.
    pub filter: TextureFilter,
    /// Which level of detail a pixel has.
    pub level: LevelRule,
    /// Levels of colour textures.
    pub pyramid: Pyramid,
    /// Colour of the highlight.
    pub components: Components,
    /// Reverses the normals of back faces, as glTF asks of double-sided materials. Off by default: neither the
    /// machines nor the Mesa tool that these pictures are checked against do it.
    pub two_sided_lighting: bool,
}

/// All that an exact picture depends on, beside what is drawn. [`Options`] alone stand for shading by normal maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Where light is computed.
    pub shading: Shading,
    /// What is done at a pixel.
    pub options: Options,
}

impl From<Options> for Style {
    fn from(options: Options) -> Self {
        Self { options, ..Self::default() }
    }
}
