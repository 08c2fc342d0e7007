//! Memory parts: data sheets of memories, in cycles of the device's clock.
//!
//! A part sets the numbers of law 4 that belong to the chips: times, burst, banks, rows, and commands per cycle. It also sets the
//! `window` of a controller of its time. The other numbers of the board - `channels`, `channel_bytes`, `cap`, `issue`,
//! `outstanding` - stay unchanged, except with [`MemoryPart::Ideal`], and `channel_bytes` grows if a burst is larger.
//!
//! Minimum times are rounded up to whole cycles, and the refresh interval is rounded down. A part keeps its own burst if that
//! takes a whole number of cycles within 5 %. Otherwise the burst is chosen among all multiples of four bytes, up to
//! `MOST_BURST_BYTES`, that come within 5 % of the part's rate: the one that moves aligned lines of 64 bytes in the least time.
//! So DDR2-667 and GDDR3-1400 have bursts of 28 bytes at 200 MHz. (Rejected: only powers of two. GDDR3-1400 would then need
//! bursts of 256 bytes there, and a line would take 9 cycles in place of 2.3; with 28 bytes it takes 3.1.)

mod part;

#[cfg(feature = "config")]
mod burst;
#[cfg(feature = "config")]
mod numbers;
#[cfg(feature = "config")]
mod sheet;
#[cfg(feature = "config")]
mod sheets;

#[cfg(feature = "config")]
pub use burst::MOST_BURST_BYTES;
#[cfg(feature = "config")]
pub use numbers::{PartError, PartNumber};
pub use part::MemoryPart;
