//! Result of an import.

use crate::camera::{Viewpoint, WorldBounds};
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

/// Box around all vertices in the world.
pub(crate) fn bounds(objects: &[Arc<Object>]) -> WorldBounds {
    WorldBounds::around(objects.iter().flat_map(|object| {
        let world = DMat4::from_cols_array(&object.world).transpose();
        object.mesh.positions.iter().map(move |p| world.transform_point3(DVec3::from_array(p.map(f64::from))))
    }))
}
