//! Exact pictures, and the metrics that hold the machines' pictures against them.
//!
//! Everything is computed in `f64`, per pixel, without quantization, and shares no code with the units it judges: what
//! a machine loses by tables, indexes and narrow data paths shows as a difference from this picture.
//!
//! Two entries, one pixel pipeline:
//! - [`draw_scene`] starts from meshes in object space: it transforms, clips, culls and projects by itself;
//! - [`PolygonRenderer`] starts from the window-space polygons of a display list.
//!
//! Both draw in any [`Style`]: with light per pixel, per vertex or per polygon.
//!
//! # What a pixel is
//! - Covered if its centre lies in the triangle, window coordinates snapped to 1/256 pixel, top-left rule. Mesa's
//!   llvmpipe snaps alike: over five models of 512 x 512 pixels the coverage of no pixel differs from it, where 10 do
//!   with steps of 1/65536 and 68 with 1/16 (on an open half of one of them, 1 differs). Attributes are interpolated
//!   from the coordinates as they were before snapping, perspective-correctly.
//! - Visible if its depth is less than what was drawn there before; the buffer starts at 1, the far plane.
//! - Its normal in [`Shading::NormalMap`] is `normalize(T * x * scale + B * y * scale + N * z)` with `B = cross(N, T) * w` and N, T interpolated
//!   unnormalised (as MikkTSpace asks for); `normalize(N)` where the material has no normal map. Whether a polygon is a
//!   bump target decides nothing here: the exact picture is that of the material. In [`Shading::Phong`] it is always `normalize(N)`.
//! - Its light is `ka + kd * sum(i * max(N.L, 0))` and `ks * sum(i * max(N.H, 0)^n)` over the lights of intensity i,
//!   `H = normalize(L + V)`, viewer at infinity. The specular term is not cut off where `N.L <= 0`.
//! - Its colour is the base (factor * vertex colour * texture, texels as stored) lit by these two terms as
//!   [`Components`] says, saturated once, rounded half up to 8 bits.
//! - In [`Shading::Texture`] there is no light: the colour is the base.
//! - Where light is computed at vertices or once per polygon ([`Shading`]), the two terms, already multiplied by the
//!   vertex colour where they will be, stand for them unsaturated; factor and texture are the pixel's. The vertices are
//!   those of the triangle ahead of clipping, or of the polygon as the display list has it: one that was clipped there
//!   has light computed at its new vertices.
//!
//! # Rules that others follow
//! Point lights are evaluated at the *centre of the object*: the centre of the axis-aligned box of all its positions
//! in world space, computed in `f64`, rounded to `f32` ([`object_centre`]).

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

pub use metrics::{Quality, SizeMismatch};
pub use options::{Components, LevelRule, Options, Pyramid, Shading, Style, TexelCentre, TextureFilter};
pub use picture::Picture;
pub use polygons::PolygonRenderer;
pub use scene::{draw_scene, object_centre};
