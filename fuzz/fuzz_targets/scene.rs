//! Transmitted scenes: any input is a scene that can be viewed, or an error.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_scene::{SceneSubject, ViewOptions};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok((subject, _held)) = SceneSubject::from_bytes(bytes, "scene", &MemoryPool::new(64 << 20)) {
        // A view of it may be rejected.
        let _ = subject.seen(&ViewOptions { size: [16, 12], ..ViewOptions::default() });
    }
});
