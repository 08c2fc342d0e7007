//! Ctrl-C: finish what is being done, leave nothing half-written, exit with 130.

use std::io::{self, Read};
use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Starts to listen.
pub fn listen() {
    // Where no handler can be installed, the default action ends the process: nothing is published then either.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Whether the user asked to stop.
pub fn asked() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// A reader that ends with an error once the user asked to stop.
#[derive(Debug)]
pub struct Interruptible<R>(pub R);

impl<R: Read> Read for Interruptible<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if asked() { Err(io::Error::other("interrupted")) } else { self.0.read(buffer) }
    }
}
