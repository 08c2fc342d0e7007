//! Reference images, and metrics that compare the machines' pictures with them.
//!
//! All arithmetic is in `f64`, per pixel, without quantization, and shares no code with the units under test. The loss by a
//! machine's tables, indexes and narrow data paths appears as a difference from this picture.
//!
//! There are two entries and one pixel pipeline:
//! - [`draw_scene`] starts from meshes in object space: it transforms, clips, culls and projects by itself;
//! - [`PolygonRenderer`] starts from the window-space polygons of a display list.
//!
//! Both draw in any [`RenderStyle`]: with light per pixel, per vertex or per polygon.
//!
//! # Definition of a pixel
//! - It is covered if its centre lies in the triangle, with window coordinates snapped to 1/256 pixel, top-left rule. Mesa's
//!   llvmpipe snaps in the same way: over five models of 512 x 512 pixels the coverage of no pixel differs from it. With steps of
//!   1/65536 it differs for 10 pixels, with 1/16 for 68 (on an open half of one of the models, 1 pixel differs). Attributes are
//!   interpolated perspective-correctly from the coordinates before snapping.
//! - It is visible if its depth is less than the depth drawn there before. The buffer starts at 1, the far plane.
//! - Its normal in [`ShadingModel::NormalMap`] is `normalize(T * x * scale + B * y * scale + N * z)` with `B = cross(N, T) * w` and N,
//!   T interpolated unnormalised (as MikkTSpace requires), or `normalize(N)` if the material has no normal map. The bump flag of
//!   a polygon has no effect: the reference image is that of the material. In [`ShadingModel::Phong`] the normal is always
//!   `normalize(N)`.
//! - Its light is `ka + kd * sum(i * max(N.L, 0))` and `ks * sum(i * max(N.H, 0)^n)` over the lights of intensity i, `H =
//!   normalize(L + V)`, viewer at infinity. The specular term is not cut off for `N.L <= 0`.
//! - Its colour is the base (factor * vertex colour * texture, texels as stored) lit by these two terms as [`BrightnessComponents`]
//!   selects, saturated once, rounded half up to 8 bits.
//! - In [`ShadingModel::Texture`] there is no light: the colour is the base.
//! - If light is computed at vertices or once per polygon ([`ShadingModel`]), the two terms replace those of the pixel. They are
//!   unsaturated and already multiplied by the vertex colour. Factor and texture are the pixel's. The vertices are those of the
//!   triangle before clipping, or of the polygon in the display list: a clipped polygon has light computed at its new vertices.
//!
//! # Rules shared with the machines
//! Point lights are evaluated at the *centre of the object*: the centre of the axis-aligned box of all its positions in world
//! space, computed in `f64`, rounded to `f32` ([`object_centre`]).

mod clip;
mod light;
pub mod metrics;
mod options;
mod picture;
mod polygons;
mod pyramid;
mod raster;
mod renderer;
mod scene;
mod surface;
mod texture;

pub use metrics::{QualityMetrics, SizeMismatch};
pub use options::{
    BrightnessComponents, LevelRule, PyramidLevels, RenderOptions, RenderStyle, ShadingModel, TexelCentre, TextureFilter,
};
pub use picture::RgbPicture;
pub use polygons::PolygonRenderer;
pub use scene::{draw_scene, draw_scene_with_depth, object_centre};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
