//! What the frame buffer (126) keeps between steps.

use basrelief_signals::GatheredLines;
use serde::{Deserialize, Serialize};

/// A finished picture.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FinishedFrame {
    /// Number of the frame.
    pub index: u32,
    /// Its number within the frame, from 0: a frame may be shown in several pictures, each better than the one before.
    pub round: u32,
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Colours, top row first; black where nothing was drawn.
    pub rgb: Vec<[u8; 3]>,
    /// Whether anything was drawn, per pixel.
    pub covered: Vec<bool>,
}

/// What the frame buffer has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameBufferCounters {
    /// Frames finished.
    pub frames: u64,
    /// Pixels written.
    pub pixels: u64,
    /// Lines written to memory.
    pub lines_written: u64,
}

/// Everything the frame buffer remembers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameBufferState {
    /// The picture that is being drawn, if a frame has begun.
    pub picture: Option<FinishedFrame>,
    /// The lines that gather writes.
    pub lines: GatheredLines,
    /// The end of the frame has come, and goes on when all gathered lines are written.
    pub ending: bool,
    /// Pictures that nobody has fetched yet, in order.
    pub finished: Vec<FinishedFrame>,
    /// What it has counted.
    pub counters: FrameBufferCounters,
}
