//! glTF and GLB: no input may panic, hang or allocate out of proportion. A loaded scene can be drawn.
//!
//! Input: a GLB file, or glTF as JSON. Two files lie beside it: `a.bin`, 1,024 bytes, and `a.png`, a picture.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_fuzz::{PICTURE, check, view};
use basrelief_scene::{MemoryFiles, load};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let files = MemoryFiles::default().with("a.bin", vec![0x3f; 1024]).with("a.png", PICTURE);
    let name = if bytes.starts_with(b"glTF") { "fuzz.glb" } else { "fuzz.gltf" };
    check(load(bytes, name, &files, &view(), &MemoryPool::default()).map(|(scene, _)| scene));
});
