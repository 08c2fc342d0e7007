//! Camera files: no input may panic. A camera that is read is finite, and is the same when written and read again.

#![no_main]

use basrelief_scene::{read_camera, write_camera};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(camera) = read_camera(text, "camera.json") else { return };
    let directions = camera.to_light.iter().chain(&camera.to_viewer);
    assert!(camera.view_projection.iter().chain(directions).all(|x| x.is_finite()));
    assert_eq!(read_camera(&write_camera(&camera), "again").expect("what was written is read"), camera);
});
