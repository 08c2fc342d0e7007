//! State dumps of OpenGL draw calls: no input may panic, hang or allocate out of proportion. An imported scene can be loaded.
//!
//! Input: dumps of one frame, separated by NUL bytes.

#![no_main]

use basrelief_fuzz::{check, view};
use basrelief_input::MemoryPool;
use basrelief_opengl::{DumpFile, Mapping, compare, import};
use basrelief_scene::{MemoryFiles, ViewOptions, load};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let budget = MemoryPool::default();
    let dumps: Vec<_> = bytes.split(|byte| *byte == 0).map(|bytes| DumpFile { name: "fuzz.json", bytes }).collect();
    let frame = match import(&dumps, &Mapping::default(), &budget) {
        Ok(frame) => frame,
        Err(error) => return assert!(!error.what.is_empty() && !error.file.is_empty(), "{error}"),
    };
    let [width, height] = frame.size;
    let is_small = u64::from(width) * u64::from(height) <= 1 << 16;
    let size = if is_small { frame.size } else { view().size };
    let options = ViewOptions { size, camera: Some(frame.camera), ..view() };
    let loaded = load(frame.gltf.as_bytes(), "fuzz.gltf", &MemoryFiles::default(), &options, &budget).map(|(scene, _)| scene);
    if let (Ok(scene), Some(application), true) = (&loaded, &frame.application, is_small) {
        compare(scene, &scene.frames[0], frame.filter, application).expect("equal sizes");
    }
    check(loaded);
});
