//! Result of an import.

use crate::camera::{Viewpoint, WorldBounds};
use crate::error::ImportWarnings;
use crate::view::LightSource;
use basrelief_signals::{Object, ShadingSettings};
use glam::{DMat4, DVec3};
use std::sync::Arc;

/// A model without view options.
pub(crate) struct ImportedModel {
    /// In drawing order.
    pub objects: Vec<Arc<Object>>,
    /// Around all vertices, in the world.
    pub bounds: WorldBounds,
    /// The file's camera.
    pub camera: Option<Viewpoint>,
    /// Width of that camera's view in heights, if the file states it.
    pub camera_ratio: Option<f64>,
    /// The file's lights.
    pub lamps: Vec<(LightSource, f64)>,
    /// How the figure shading device shades its frames.
    pub shading: ShadingSettings,
}

/// Width of the image for which `warn_of_far_vertices` estimates the error \[pixels\].
const IMAGE_WIDTH: f64 = 640.0;

/// Smallest error of a vertex that is worth a warning \[pixels\]. The PSNR of a checkered square falls by more than 30 dB there.
const LEAST_ERROR: f64 = 1.0 / 16.0;

impl ImportedModel {
    /// Warns if single precision moves vertices visibly, because they are far from the origin of their mesh.
    ///
    /// The machines multiply a vertex by a matrix of single precision. The world matrix of a node is part of that matrix, in
    /// double precision, so only the place within the mesh counts. The elements of the matrix and its products have a relative
    /// error of 2^-24 each. A vertex at distance d from the origin of its mesh so moves by up to about d * 2^-23. An image that
    /// shows the whole model has `IMAGE_WIDTH` pixels per size of the model.
    pub(crate) fn warn_of_far_vertices(&self, warnings: &mut ImportWarnings) {
        let size = self.bounds.size();
        let farthest = self.objects.iter().map(|object| farthest_vertex(object)).fold(0.0, f64::max);
        let error = farthest / size * IMAGE_WIDTH * f64::from(f32::EPSILON);
        if error > LEAST_ERROR {
            warnings.add(format!(
                "vertices are {:.0} times the model's size away from the origin of their mesh, and single precision moves them by \
                 about {error:.2} pixels in an image of {IMAGE_WIDTH} pixels; move the mesh to the origin, and give its place to a node",
                farthest / size
            ));
        }
    }
}

/// Returns the largest distance of a vertex from the origin of its mesh, in the scale of the world.
fn farthest_vertex(object: &Object) -> f64 {
    let world = DMat4::from_cols_array(&object.world).transpose();
    let place = |p: &[f32; 3]| world.transform_vector3(DVec3::from_array(p.map(f64::from)));
    object.mesh.positions.iter().map(|p| place(p).length_squared()).fold(0.0, f64::max).sqrt()
}

/// Box around all vertices in the world.
pub(crate) fn bounds(objects: &[Arc<Object>]) -> WorldBounds {
    WorldBounds::around(objects.iter().flat_map(|object| {
        let world = DMat4::from_cols_array(&object.world).transpose();
        object.mesh.positions.iter().map(move |p| world.transform_point3(DVec3::from_array(p.map(f64::from))))
    }))
}
