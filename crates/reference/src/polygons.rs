//! The reference image of a display list.

use crate::pyramid::PyramidCache;
use crate::raster::{WindowCorner, doubled_area};
use crate::renderer::BatchRenderer;
use crate::surface::{LightTerms, LitSurface, PixelAttributes, face_normal};
use crate::{RenderStyle, RgbPicture};
use basrelief_signals::{Frame, Material, ObjectInfo, Polygon, Vertex};
use glam::{DMat4, DVec2, DVec3, DVec4};
use std::sync::Arc;

/// Renderer of window-space polygons in a stream. Its memory does not grow with their number.
///
/// Polygons are already clipped and culled, and are drawn with either winding. Counter-clockwise on the screen is the front for
/// [`two_sided_lighting`](crate::RenderOptions::two_sided_lighting). Bump flag, LOD, vertex brightness and arrival concern the machines
/// and are ignored. A triangle with coordinates that are not finite is left out.
#[derive(Clone, Debug)]
pub struct PolygonRenderer {
    size: [u32; 2],
    style: RenderStyle,
    frame: Option<Arc<Frame>>,
    /// Transform from window coordinates to world space.
    unproject: DMat4,
    centre: [f32; 3],
    material: Option<Arc<Material>>,
    pyramids: PyramidCache,
    renderer: BatchRenderer,
}

impl PolygonRenderer {
    /// Creates a renderer of pictures of `width` x `height` pixels.
    pub fn new(width: u32, height: u32, style: impl Into<RenderStyle>) -> Self {
        Self {
            size: [width, height],
            style: style.into(),
            frame: None,
            unproject: DMat4::IDENTITY,
            centre: [0.0; 3],
            material: None,
            pyramids: PyramidCache::default(),
            renderer: BatchRenderer::new(width, height),
        }
    }

    /// Sets view and lights of the following polygons. Polygons before the first frame are not drawn. Call
    /// [`PolygonRenderer::finish`] between the frames of a sequence.
    pub fn frame(&mut self, frame: &Frame) {
        self.unproject = unproject(frame);
        self.frame = Some(Arc::new(frame.clone()));
        self.material = None;
    }

    /// Sets the object of the following polygons. Point lights are evaluated at its centre.
    pub fn object(&mut self, object: &ObjectInfo) {
        self.centre = object.centre;
        self.material = None;
    }

    /// Draws a polygon, as a fan around its first vertex.
    pub fn polygon(&mut self, polygon: &Polygon) {
        if !self.material.as_ref().is_some_and(|current| Arc::ptr_eq(current, &polygon.material)) {
            let Some(frame) = &self.frame else { return };
            let surface = LitSurface::new(self.style, frame, &polygon.material, self.centre, &mut self.pyramids);
            self.renderer.surface(surface);
            self.material = Some(polygon.material.clone());
        }
        let mut corners: Vec<_> = polygon.vertices.iter().map(corner).collect();
        let place = |c: &WindowCorner| self.unproject.project_point3(c.window.extend(c.depth));
        let face = |corners: &[WindowCorner]| face_normal(&corners.iter().map(place).collect::<Vec<_>>());
        let back = clockwise(&corners);
        self.renderer.light(&mut corners, face, back);
        let Some((first, rest)) = corners.split_first() else { return };
        for pair in rest.windows(2) {
            self.renderer.triangle([*first, pair[0], pair[1]], false, false);
        }
    }

    /// Returns the picture so far. The renderer starts the next one, with the same frame and object.
    pub fn finish(&mut self) -> RgbPicture {
        let [width, height] = self.size;
        self.material = None;
        std::mem::replace(&mut self.renderer, BatchRenderer::new(width, height)).finish()
    }
}

/// Returns the transform from window coordinates and depth to world space.
fn unproject(frame: &Frame) -> DMat4 {
    let to_clip = DMat4::from_cols(
        DVec4::X * (2.0 / f64::from(frame.width)),
        DVec4::Y * (-2.0 / f64::from(frame.height)),
        DVec4::Z * 2.0,
        DVec4::new(-1.0, 1.0, -1.0, 1.0),
    );
    DMat4::from_cols_array(&frame.camera.view_projection).transpose().inverse() * to_clip
}

/// Returns true if a polygon runs clockwise on the screen.
fn clockwise(corners: &[WindowCorner]) -> bool {
    let area = |pair: &[WindowCorner]| doubled_area([corners[0].window, pair[0].window, pair[1].window]);
    corners.windows(2).skip(1).map(area).sum::<f64>() > 0.0
}

fn corner(vertex: &Vertex) -> WindowCorner {
    let [x, y, depth, inverse_w] = vertex.position.map(f64::from);
    let [tx, ty, tz, handedness] = vertex.tangent.map(f64::from);
    let [r, g, b, _] = vertex.color.map(f64::from);
    WindowCorner {
        window: DVec2::new(x, y),
        depth,
        inverse_w,
        attributes: PixelAttributes {
            normal: DVec3::from(vertex.normal.map(f64::from)),
            tangent: DVec3::new(tx, ty, tz),
            handedness,
            uv: DVec2::from(vertex.uv.map(f64::from)),
            uv_normal: DVec2::from(vertex.uv_normal.map(f64::from)),
            color: DVec3::new(r, g, b),
            lit: LightTerms::default(),
        },
    }
}
