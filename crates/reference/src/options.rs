//! Options that the reference image shares with the machine under test.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Filter of textures and normal maps. It applies to every texture and overrides the texture's own `sampler.filter`, because the
/// picture is exact in one stated sense. Mesa gets the same filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextureFilter {
    /// No textures, including normal maps. The factor of the material times the vertex colour is left.
    None,
    /// The texel of level 0 that holds the sample point.
    Nearest,
    /// Four texels of level 0, weighted.
    Bilinear,
    /// Four texels each of the two levels next to the level of detail of the pixel, weighted. The level of detail is log2 of the
    /// longer of the two footprint axes \[texels of level 0 per pixel\].
    #[default]
    Trilinear,
    /// The texel of the level nearest to the level of detail. A tie selects the finer level, as in OpenGL.
    NearestMipNearest,
    /// Four texels of that level, weighted.
    BilinearMipNearest,
    /// One texel each of the two levels next to the level of detail, weighted.
    NearestMipLinear,
}

/// Change of the texture coordinates that decides the level of detail of a pixel \[texels of level 0 per pixel\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LevelRule {
    /// The longer of the two footprint axes: log2 of the larger length of d(u, v)/dx and d(u, v)/dy.
    #[default]
    LongerAxis,
    /// The larger component along the scan line: log2(max(|du/dx|, |dv/dx|)), the rule of the MIP-map selector (320) of the texel
    /// value generator.
    AlongScanLine,
}

/// Levels of a colour texture, and the positions of their texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PyramidLevels {
    /// The given levels. A coordinate spans all levels equally: texel u * width of each.
    #[default]
    Given,
    /// Levels of the rate-limited renderer, computed from the finest one. Each halves the sides and rounds up. An odd edge repeats its
    /// last texel, and a texel is `(sum of 4 + 2) >> 2`. The last level fits in one tile. Texel u * width of the finest
    /// level is texel u * width / 2^k of level k.
    Tiled {
        /// Columns and rows of a tile \[texels\].
        tile: [u32; 2],
        /// Position of texel centres.
        centre: TexelCentre,
    },
}

/// Position of the centre of texel 0, in texels of its level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TexelCentre {
    /// At 0.5.
    #[default]
    Half,
    /// At 0: coarse levels are shifted by 0.5, 1.5, 3.5 ... finest texels.
    Integer,
}

/// Colour of the highlight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BrightnessComponents {
    /// base * (diffuse + specular): one brightness, as in the patent.
    #[default]
    Combined,
    /// base * diffuse + specular.
    Separate,
}

/// Source of a pixel's normal, and stage of lighting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShadingModel {
    /// Per pixel: the interpolated normal, tilted by the normal map if the material has one.
    #[default]
    NormalMap,
    /// Per pixel: the interpolated normal, renormalised (Phong). Normal maps are ignored.
    Phong,
    /// At the vertices: the two terms times the vertex colour are interpolated perspective-correctly (Gouraud).
    Gouraud,
    /// Once per polygon, with its geometric normal in world space, vertices counter-clockwise around it, as OpenGL programs draw
    /// flat shading. The normal of a mirrored object points inwards.
    Face,
    /// Once per polygon: the mean over its vertices (constant shading of the shading device).
    Mean,
    /// No light: the base colour alone.
    Texture,
}

/// Options of a reference image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RenderOptions {
    /// Texture filter, for colour textures and normal maps.
    pub filter: TextureFilter,
    /// Rule for the level of detail of a pixel.
    pub level: LevelRule,
    /// Levels of colour textures.
    pub pyramid: PyramidLevels,
    /// Colour of the highlight.
    pub components: BrightnessComponents,
    /// Reverses the normals of back faces, as glTF requires for double-sided materials. False by default, because neither the
    /// machines nor the Mesa tool used for checks do it.
    pub two_sided_lighting: bool,
}

/// All inputs of a reference image besides the scene. [`RenderOptions`] alone imply shading by normal maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RenderStyle {
    /// Stage of lighting.
    pub shading: ShadingModel,
    /// Options of a pixel.
    pub options: RenderOptions,
}

impl From<RenderOptions> for RenderStyle {
    fn from(options: RenderOptions) -> Self {
        Self { options, ..Self::default() }
    }
}
