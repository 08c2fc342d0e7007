//! A scene on the path: compressed, and what is made of it counted before it is believed.

use basrelief_input::{Budget, Growing, Held};
use basrelief_scene::Subject;
use std::io::{self, Read as _};

/// Meshes lose another tenth at 19, in a hundred times the time.
const LEVEL: i32 = 9;
/// Binary logarithm of the largest window \[bytes\]: 8 MiB, what compressors take unless they are told to.
const WINDOW: u32 = 23;

/// A scene as it travels.
///
/// # Errors
/// A sentence, where it is too large.
pub fn pack(scene: &[u8]) -> Result<Vec<u8>, String> {
    zstd::encode_all(scene, LEVEL).map_err(|e| format!("cannot be compressed: {e}"))
}

/// A scene that has come from `name`, and what it takes.
///
/// # Errors
/// A sentence that begins with `name`: what is wrong, and where; what is over the budget.
pub fn unpack(packed: &[u8], name: &str, budget: &Budget) -> Result<(Subject, Held), String> {
    let failed = |e: io::Error| format!("{name}: no scene: {e}; is `basrelief serve` running there?");
    let _window =
        budget.take(1 << WINDOW, "the window that its compression looks back into").map_err(|e| format!("{name}: {e}"))?;
    let mut unpacked = Growing::new(budget, "a scene");
    let mut decoder = zstd::Decoder::new(packed).map_err(failed)?;
    decoder.window_log_max(WINDOW).map_err(failed)?;
    io::copy(&mut decoder.by_ref(), &mut unpacked).map_err(failed)?;
    let (bytes, _held) = unpacked.into_parts();
    Subject::from_bytes(&bytes, name, budget).map_err(|e| e.to_string())
}
