//! Frame buffer (126), inside the graphics-data memory (124), and the video output that reads it.
//!
//! ```text
//!  graphics processor (104) --> (z-test) --> frame buffer (126) --> video output
//!                                                 |                      |
//!                                                 +-- graphics-data memory (124)
//! ```

pub mod config;
pub mod pixel_buffer;
pub mod state;
pub mod unit;
pub mod video_out;

pub use config::{FrameBufferConfig, PixelBufferConfig, VideoOutConfig};
pub use pixel_buffer::{PixelBuffer, PixelBufferCounters, PixelBufferState};
pub use state::{FinishedFrame, FrameBufferCounters, FrameBufferState};
pub use unit::{FrameBuffer, FrameDone};
pub use video_out::{VideoOut, VideoOutCounters, VideoOutState};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
