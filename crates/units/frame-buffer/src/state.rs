//! State of the frame buffer (126) between steps.

use basrelief_signals::{GatheredLines, LineFlags};
use serde::{Deserialize, Serialize};

/// A finished picture.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FinishedFrame {
    /// Number of the frame.
    pub index: u32,
    /// Number of the picture within the frame, from 0. A frame can be shown in several pictures, each better than the previous
    /// one.
    pub round: u32,
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Colours, top row first. Pixels without fragments are black.
    pub rgb: Vec<[u8; 3]>,
    /// True for each drawn pixel.
    pub covered: Vec<bool>,
}

/// Counters of the frame buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameBufferCounters {
    /// Frames finished.
    pub frames: u64,
    /// Pixels written.
    pub pixels: u64,
    /// Lines written to memory.
    pub lines_written: u64,
    /// Lines of background among them.
    pub lines_cleared: u64,
}

/// State of the frame buffer between steps.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameBufferState {
    /// Picture being drawn, if a frame has begun.
    pub picture: Option<FinishedFrame>,
    /// Lines that gather writes.
    pub lines: GatheredLines,
    /// Lines that nothing is drawn into.
    pub flags: LineFlags,
    /// True if the frame end has arrived, and the frame is not finished.
    pub ending: bool,
    /// Pictures not fetched yet, in order.
    pub finished: Vec<FinishedFrame>,
    /// Counters.
    pub counters: FrameBufferCounters,
}
