//! Functions shared by the targets.

use basrelief_scene::{SceneError, ViewOptions};
use basrelief_signals::Scene;

/// A PNG of 4 x 4 texels.
pub const PICTURE: &[u8] = include_bytes!("../../tests/models/checks.png");

/// Returns a small view.
pub fn view() -> ViewOptions {
    ViewOptions { size: [8, 8], ..ViewOptions::default() }
}

/// Checks a loaded scene or an error. A scene can be drawn: it has triangles, and their corners exist. An error has a reason and
/// a file.
pub fn check(result: Result<Scene, SceneError>) {
    match result {
        Ok(scene) => {
            assert!(scene.objects.iter().any(|o| o.mesh.indices.len() >= 3), "a scene without a triangle");
            for object in &scene.objects {
                let corners = object.mesh.positions.len();
                assert!(object.mesh.indices.iter().all(|i| (*i as usize) < corners), "a corner that does not exist");
            }
        }
        Err(error) => assert!(!error.what.is_empty() && !error.file.is_empty(), "{error}"),
    }
}
