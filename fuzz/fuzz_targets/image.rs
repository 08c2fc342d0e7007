//! PNG and JPEG as a model's normal map: no input may panic, hang or allocate out of proportion.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_fuzz::view;
use basrelief_scene::{MemoryFiles, load};
use libfuzzer_sys::fuzz_target;

const OBJECT: &[u8] = b"mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

fuzz_target!(|bytes: &[u8]| {
    let files = MemoryFiles::default().with("a.mtl", &b"newmtl a\nnorm a.png\n"[..]).with("a.png", bytes);
    if let Err(error) = load(OBJECT, "fuzz.obj", &files, &view(), &MemoryPool::default()) {
        assert!(error.to_string().contains("a.png"), "{error}");
    }
});
