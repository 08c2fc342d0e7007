//! One LOD for all polygons of an object (stated: bump mapping may be switched for "a larger unit" than the polygon).
//!
//! rho, in texels of level 0 per pixel, is taken at the centre of the object. It is the mean texel density of the object's
//! surface, known at modelling time, divided by the pixels of a unit of length at that point.

use basrelief_kernel::OperatorCounts;
use basrelief_shading::lod;
use basrelief_signals::{Frame, Object};
use glam::{DMat4, DVec3, DVec4};

/// Arithmetic of one object in a frame: clip-space w of its centre, its square, the quotient by it, the ratio to the density, and
/// its exponent as for a polygon.
pub(crate) const WORK: OperatorCounts = OperatorCounts { multiply: 3 + 2, add: 3 + 4, divide: 2, ..OperatorCounts::NONE };

/// Returns the LOD of an object, computed for the same map as the LOD of its polygons. Returns 0 if it has no map, or if its
/// centre lies behind the viewer.
pub(crate) fn object_lod(object: &Object, centre: [f32; 3], frame: &Frame) -> u8 {
    let (mesh, material) = (&object.mesh, &object.material);
    let (texture, uv) = match (&material.normal_map, &material.color_texture) {
        (Some(map), _) => (map, &mesh.uv_normal),
        (None, Some(texture)) => (texture, &mesh.uv),
        (None, None) => return 0,
    };
    let Some(level) = texture.levels.first() else { return 0 };
    let texels = f64::from(level.width) * f64::from(level.height);
    let (surface, chart) = areas(object, uv);
    lod((texels * chart) as f32, (surface * pixels_per_area(centre, frame)) as f32)
}

/// Returns the area of an object in the world, and its area in its texture.
fn areas(object: &Object, uv: &[[f32; 2]]) -> (f64, f64) {
    let world = DMat4::from_cols_array(&object.world).transpose();
    let position = |i: u32| object.mesh.positions.get(i as usize).map(|p| world.transform_vector3(DVec3::from(p.map(f64::from))));
    let place = |i: u32| uv.get(i as usize).map(|[u, v]| [f64::from(*u), f64::from(*v)]);
    let mut sum = (0.0, 0.0);
    for corner in object.mesh.indices.as_chunks::<3>().0 {
        if let [Some(a), Some(b), Some(c)] = corner.map(position)
            && let [Some(s), Some(t), Some(r)] = corner.map(place)
        {
            sum.0 += (b - a).cross(c - a).length();
            sum.1 += ((t[0] - s[0]) * (r[1] - s[1]) - (t[1] - s[1]) * (r[0] - s[0])).abs();
        }
    }
    sum
}

/// Returns the pixels of a unit of area across the line of sight at a point, or 0 behind the viewer.
fn pixels_per_area(at: [f32; 3], frame: &Frame) -> f64 {
    let rows = &frame.camera.view_projection;
    let row = |i: usize| DVec4::new(rows[4 * i], rows[4 * i + 1], rows[4 * i + 2], rows[4 * i + 3]);
    let w = row(3).dot(DVec3::from(at.map(f64::from)).extend(1.0));
    let across = |i: usize, pixels: u32| 0.5 * f64::from(pixels) * row(i).truncate().length() / w;
    if w > 0.0 { across(0, frame.width) * across(1, frame.height) } else { 0.0 }
}
