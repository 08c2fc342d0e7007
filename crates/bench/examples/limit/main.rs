//! Time per fragment of W1: the picture without any architecture, with eight fragments at a time, and the machine in turn.
//!
//! `cargo run --release -p basrelief-bench --example limit` prints medians of seven rounds. The limit draws the same picture from the
//! same polygons, bit for bit. It keeps no state of a unit, counts nothing, and has no memories.

#[cfg(target_arch = "x86_64")]
mod avx2;

#[cfg(target_arch = "x86_64")]
fn main() -> Result<(), String> {
    avx2::run()
}

#[cfg(not(target_arch = "x86_64"))]
fn main() -> Result<(), String> {
    Err("the limit is written for AVX2 of x86-64".into())
}
