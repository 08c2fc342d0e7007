//! Demos and the observer of tests that read recordings.

use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::Scene;
use basrelief_sim::Observer;
use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Returns a demo. Each is built once: the textures of `gallery` take longer than its small pictures.
pub fn demo_scene(name: &str, options: &ViewOptions) -> Arc<Scene> {
    static BUILT: LazyLock<Mutex<BTreeMap<String, Arc<Scene>>>> = LazyLock::new(Mutex::default);
    let built = || Arc::new(demo(name, options).unwrap());
    let mut all = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    all.entry(format!("{name} {options:?}")).or_insert_with(built).clone()
}

/// Collects the bytes of a recording.
#[derive(Default)]
pub struct CollectedRecording(pub Vec<u8>);

impl Observer for CollectedRecording {
    fn recording(&mut self, bytes: &[u8], _: bool) -> Result<(), String> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }
}
