//! OBJ with MTL: no input may panic, hang or allocate out of proportion. A loaded scene can be drawn.
//!
//! Input: an OBJ text, then optionally a zero byte and the text of its library, `a.mtl`. `a.png` is a picture.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_fuzz::{PICTURE, check, view};
use basrelief_scene::{MemoryFiles, load};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let split = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (object, library) = bytes.split_at(split);
    let files = MemoryFiles::default().with("a.mtl", library.get(1..).unwrap_or_default()).with("a.png", PICTURE);
    check(load(object, "fuzz.obj", &files, &view(), &MemoryPool::default()).map(|(scene, _)| scene));
});
