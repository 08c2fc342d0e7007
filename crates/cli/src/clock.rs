//! Clock of the program, for the figures of the host.

use std::sync::OnceLock;
use std::time::Instant;

/// Returns the seconds since the first call, which `main` makes.
pub fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
