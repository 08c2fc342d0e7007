//! Frame buffer (126), inside the graphics-data memory (124), and the display that reads it.
//!
//! ```text
//!  graphics processor (104) --> (z-test) --> frame buffer (126)
//!                                                 | pixels, flips
//!                                                 +-- graphics-data memory (124) -- display
//! ```

pub mod config;
pub mod display;
pub mod pixel_buffer;
pub mod state;
pub mod unit;

pub use config::{DisplayConfig, DisplayMode, FrameBufferConfig, PixelBufferConfig};
pub use display::ScanOut;
pub use pixel_buffer::{PixelBuffer, PixelBufferCounters, PixelBufferState};
pub use state::{FinishedFrame, FrameBufferCounters, FrameBufferState};
pub use unit::FrameBuffer;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
