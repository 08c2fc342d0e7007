//! Frame buffer (126), inside the graphics-data memory (124), and the video output that reads it.
//!
//! ```text
//!  graphics processor (104) --> (z-test) --> frame buffer (126) --> video output
//!                                                 |                      |
//!                                                 +-- graphics-data memory (124)
//! ```

pub mod config;
pub mod frame_buffer;
pub mod pixel_buffer;
pub mod video_out;

pub use config::{FrameBufferConfig, VideoOutConfig};
pub use frame_buffer::{FinishedFrame, FrameBuffer, FrameBufferCounters, FrameBufferState, FrameDone};
pub use pixel_buffer::{PixelBuffer, PixelBufferCounters, ShownPicture};
pub use video_out::{VideoOut, VideoOutState};
