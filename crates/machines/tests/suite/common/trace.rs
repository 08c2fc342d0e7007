//! Commands of small traces.

use basrelief_signals::{Camera, Control, Frame, Light, LightKind, ObjectInfo};
use std::sync::Arc;

/// Returns a directional light.
pub fn sun(to_light: [f32; 3], intensity: f32) -> Light {
    Light { kind: LightKind::Directional { to_light }, intensity }
}

/// Returns the beginning of a frame.
pub fn frame(index: u32, [width, height]: [u32; 2], lights: Vec<Light>) -> Control {
    let camera = Camera { view_projection: [0.0; 16], to_light: [0.0, 0.0, 1.0], to_viewer: [0.0, 0.0, 1.0] };
    let (textures, shading) = (Vec::new(), Default::default());
    Control::Frame(Arc::new(Frame { index, width, height, camera, lights, textures, shading }))
}

/// Returns the beginning of an object.
pub fn object(id: u32) -> Control {
    Control::Object(Arc::new(ObjectInfo {
        id,
        name: format!("object {id}"),
        centre: [id as f32, 0.0, 0.0],
        entries: None,
        bias: None,
        shading: Default::default(),
        mesh: None,
    }))
}
