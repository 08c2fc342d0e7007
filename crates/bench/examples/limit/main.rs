//! Time per fragment of W1: the picture without any architecture, with eight fragments at a time, and the machine in turn.
//!
//! `cargo run --release -p basrelief-bench --example limit` prints medians of seven rounds. The limit draws the same picture from the
//! same polygons, bit for bit. It keeps no state of a unit, counts nothing, and has no memories.

#[cfg(target_arch = "x86_64")]
mod block;
#[cfg(target_arch = "x86_64")]
mod columns;
#[cfg(target_arch = "x86_64")]
mod drawing;
#[cfg(target_arch = "x86_64")]
mod lanes;
#[cfg(target_arch = "x86_64")]
mod raster;
#[cfg(target_arch = "x86_64")]
mod rounds;
#[cfg(target_arch = "x86_64")]
mod search;
#[cfg(target_arch = "x86_64")]
mod shade;
#[cfg(target_arch = "x86_64")]
mod triangle;

#[cfg(target_arch = "x86_64")]
fn main() -> Result<(), String> {
    rounds::run()
}

#[cfg(not(target_arch = "x86_64"))]
fn main() -> Result<(), String> {
    Err("the limit is written for AVX2 of x86-64".into())
}
