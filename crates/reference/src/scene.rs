//! The reference image of a scene.

use crate::clip::{ClipVertex, clipped, inside};
use crate::pyramid::PyramidCache;
use crate::raster::WindowCorner;
use crate::renderer::BatchRenderer;
use crate::surface::{LightTerms, LitSurface, PixelAttributes, face_normal};
use crate::{RenderStyle, RgbPicture};
use basrelief_signals::{Frame, Mesh, Object, Scene};
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// Draws the objects of a scene under one of its frames (or any other frame).
///
/// Vertex normals and tangents are transformed to world space and normalised there, then interpolated unnormalised. Under a
/// mirroring world transform, front faces stay front faces. The handedness of tangents is used as stored, as in glTF viewers.
/// Triangles with invalid indices or coordinates are left out.
pub fn draw_scene(scene: &Scene, frame: &Frame, style: &(impl Into<RenderStyle> + Copy)) -> RgbPicture {
    draw_scene_with_depth(scene, frame, style).0
}

/// Draws as [`draw_scene`] does. Also returns the depth of each pixel, 0..=1, in the same order; background has depth 1.
pub fn draw_scene_with_depth(scene: &Scene, frame: &Frame, style: &(impl Into<RenderStyle> + Copy)) -> (RgbPicture, Vec<f64>) {
    let style = (*style).into();
    let mut renderer = BatchRenderer::new(frame.width, frame.height);
    let mut pyramids = PyramidCache::default();
    for object in &scene.objects {
        let surface = LitSurface::new(style, frame, &object.material, object_centre(object), &mut pyramids);
        renderer.surface(surface);
        draw_object(&mut renderer, object, frame);
    }
    renderer.finish_with_depth()
}

/// Returns the centre of an object: that of the axis-aligned box of its positions in world space, or the origin if it has none.
pub fn object_centre(object: &Object) -> [f32; 3] {
    let world = row_major(&object.world);
    let mut corners = object.mesh.positions.iter().map(|&p| world.transform_point3(wide(p)));
    let Some(first) = corners.next() else { return [0.0; 3] };
    let (low, high) = corners.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
    ((low + high) * 0.5).as_vec3().to_array()
}

/// Draws the triangles of an object in the current surface.
fn draw_object(renderer: &mut BatchRenderer, object: &Object, frame: &Frame) {
    let world = row_major(&object.world);
    let mirrored = DMat3::from_mat4(world).determinant() < 0.0;
    let cull = !object.material.double_sided;
    let mesh = &object.mesh;
    let vertices = transformed(mesh, world, row_major(&frame.camera.view_projection));
    let size = DVec2::new(f64::from(frame.width), f64::from(frame.height));
    for indices in mesh.indices.as_chunks::<3>().0 {
        let [Some(a), Some(b), Some(c)] = indices.map(|i| vertices.get(i as usize)) else { continue };
        let mut triangle = [*a, *b, *c];
        let face = |_: &[_]| face_normal(&indices.map(|i| world.transform_point3(wide(mesh.positions[i as usize]))));
        let back = clockwise(&triangle) != mirrored;
        renderer.light(&mut triangle, face, back);
        if triangle.iter().all(inside) {
            renderer.triangle(triangle.map(|v| projected(&v, size)), mirrored, cull);
            continue;
        }
        let polygon: Vec<_> = clipped(triangle).iter().map(|v| projected(v, size)).collect();
        for pair in polygon.windows(2).skip(1) {
            renderer.triangle([polygon[0], pair[0], pair[1]], mirrored, cull);
        }
    }
}

/// Returns true if the visible part of a triangle, possibly clipped, has its vertices clockwise on the screen.
fn clockwise(triangle: &[ClipVertex; 3]) -> bool {
    let [a, b, c] = triangle.each_ref().map(|v| DVec3::new(v.position.x, v.position.y, v.position.w));
    a.dot(b.cross(c)) < 0.0
}

fn transformed(mesh: &Mesh, world: DMat4, view_projection: DMat4) -> Vec<ClipVertex> {
    let linear = DMat3::from_mat4(world);
    let cofactors = cofactors(linear);
    let vertex = |(i, &position): (usize, &[f32; 3])| {
        let [r, g, b, _] = mesh.colors.get(i).map_or([1.0; 4], |color| color.map(f64::from));
        let [tx, ty, tz, handedness] = mesh.tangents.get(i).map_or([0.0; 4], |tangent| tangent.map(f64::from));
        ClipVertex {
            position: view_projection * world.transform_point3(wide(position)).extend(1.0),
            attributes: PixelAttributes {
                normal: (cofactors * mesh.normals.get(i).map_or(DVec3::ZERO, |&n| wide(n))).normalize_or_zero(),
                tangent: (linear * DVec3::new(tx, ty, tz)).normalize_or_zero(),
                handedness,
                uv: mesh.uv.get(i).map_or(DVec2::ZERO, |uv| DVec2::from(uv.map(f64::from))),
                uv_normal: mesh.uv_normal.get(i).map_or(DVec2::ZERO, |uv| DVec2::from(uv.map(f64::from))),
                color: DVec3::new(r, g, b),
                lit: LightTerms::default(),
            },
        }
    };
    mesh.positions.iter().enumerate().map(vertex).collect()
}

/// Returns the matrix of cofactors with the sign of the determinant: the inverse transpose up to a positive factor. It is also
/// defined for singular matrices (an object flattened into a plane keeps its normals).
fn cofactors(linear: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}

fn projected(vertex: &ClipVertex, size: DVec2) -> WindowCorner {
    let DVec4 { x, y, z, w } = vertex.position;
    WindowCorner {
        window: DVec2::new(0.5 + 0.5 * x / w, 0.5 - 0.5 * y / w) * size,
        depth: 0.5 + 0.5 * z / w,
        inverse_w: 1.0 / w,
        attributes: vertex.attributes,
    }
}

fn row_major(values: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(values).transpose()
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
