//! The unit and its step.

use crate::config::FrameBufferConfig;
use crate::state::{FinishedFrame, FrameBufferState};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use basrelief_signals::width::{BitWidth, COLOR, CONTROL, SignalWidths};
use basrelief_signals::{
    ColorToken, Control, Flow, Frame, GatheredLines, LINE_NUMBER, LINE_PIXELS, Pixel, Stamp, layout, line_of, lines,
};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

/// Token from the frame buffer to the video output: a frame is complete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameDone {
    /// Number of the frame.
    pub index: u32,
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Start of the picture in the graphics-data memory (124).
    pub address: u64,
    /// Size of the picture there, sides rounded up to whole blocks \[bytes\].
    pub bytes: u64,
}

/// Address, size and number.
impl BitWidth for FrameDone {
    fn bits(_: &SignalWidths) -> u32 {
        CONTROL
    }
}

/// Frame buffer (126): takes pixels in order, and the last one at a position stays. Client 0 makes posted writes of lines: the 16
/// pixels around a token (4 x 4 for stamps, 16 x 1 for packets). A frame begins with a clear that moves no data (fast clear,
/// assumed).
///
/// Some lines gather writes (`frame_buffer.write_lines`): all pixels drawn into a line before its eviction are written at once. A
/// line is written as a whole transfer, however few pixels of it were drawn. The other pixels keep their value (byte enables,
/// assumed), so nothing is ever read.
#[derive(Clone, Debug)]
pub struct FrameBuffer<T = Stamp<Pixel>> {
    /// Parameters.
    pub config: FrameBufferConfig,
    /// State between steps.
    pub state: FrameBufferState,
    token: PhantomData<fn(T)>,
}

impl<T: ColorToken> Default for FrameBuffer<T> {
    fn default() -> Self {
        Self::new(FrameBufferConfig::default())
    }
}

impl<T: ColorToken> FrameBuffer<T> {
    /// Creates a frame buffer in its power-on state.
    pub fn new(config: FrameBufferConfig) -> Self {
        Self { config, state: FrameBufferState::default(), token: PhantomData }
    }

    fn begin(&mut self, frame: &Frame, traffic: &mut MemoryPorts) {
        let (index, width, height) = (frame.index, frame.width, frame.height);
        self.state.lines = GatheredLines::default();
        self.state.picture = None;
        if !layout::fits(width, height) {
            return traffic.fault(format!(
                "frame buffer: frame {index} is {width} x {height} pixels; there is room for {} per side and {} in all, use a smaller size",
                layout::MAX_SIDE,
                layout::MAX_PIXELS
            ));
        }
        let pixels = width as usize * height as usize;
        let (rgb, covered) = (vec![[0; 3]; pixels], vec![false; pixels]);
        self.state.picture = Some(FinishedFrame { index, round: 0, width, height, rgb, covered });
    }

    /// Returns the base address. Frames alternate between the two buffers.
    fn base(&self) -> u64 {
        layout::COLOR_BUFFERS + self.state.counters.frames % 2 * layout::COLOR_BUFFER_STRIDE
    }

    /// Writes a pixel of a token. `is_open` is true if the line of the token is the most recently written one, which holds after
    /// its first pixel.
    #[inline(always)]
    fn write(&mut self, [x, y]: [u16; 2], color: [u8; 3], is_open: &mut bool, traffic: &mut MemoryPorts) {
        let Some(picture) = &mut self.state.picture else { return };
        let (x, y, width) = (u32::from(x), u32::from(y), picture.width);
        let place = y as usize * width as usize + x as usize;
        let (Some(rgb), Some(covered)) = (picture.rgb.get_mut(place), picture.covered.get_mut(place)) else { return };
        if x >= width {
            return;
        }
        *rgb = color;
        *covered = true;
        self.state.counters.pixels += 1;
        if !*is_open {
            *is_open = true;
            let line = line_of::<T>(width, [x, y]);
            if !self.state.lines.is_newest(line) {
                self.gather(line, traffic);
            }
        }
    }

    /// Gathers a line, and writes the evicted one, if any. (Not inlined: at most once per token.)
    #[inline(never)]
    fn gather(&mut self, line: u64, traffic: &mut MemoryPorts) {
        if let Some(gone) = self.state.lines.touch(line, self.config.write_lines) {
            self.write_line(gone, traffic);
        }
    }

    fn write_line(&mut self, line: u64, traffic: &mut MemoryPorts) {
        let bytes = LINE_PIXELS * self.config.pixel_bytes;
        traffic.write(0, self.base() + line * u64::from(bytes), bytes);
        self.state.counters.lines_written += 1;
    }

    /// Writes a gathered line, one per step. The last of them sends the end token if a frame has begun.
    fn end(&mut self, traffic: &mut MemoryPorts) -> Step<Option<FrameDone>> {
        if let Some(line) = self.state.lines.take() {
            self.write_line(line, traffic);
        }
        self.state.ending = !self.state.lines.is_empty();
        let done = if self.state.ending { None } else { self.finish() };
        let step = Step::after(self.config.latency.into(), done);
        if done.is_some() { step.marked() } else { step }
    }

    /// Returns the end token. Returns `None` if no frame has begun.
    fn finish(&mut self) -> Option<FrameDone> {
        let picture = self.state.picture.take()?;
        let FinishedFrame { index, width, height, .. } = picture;
        let bytes = lines::<T>(width, height) * u64::from(LINE_PIXELS * self.config.pixel_bytes);
        let done = FrameDone { index, width, height, address: self.base(), bytes };
        self.state.finished.push(picture);
        self.state.counters.frames += 1;
        Some(done)
    }
}

impl<T: ColorToken> Unit for FrameBuffer<T> {
    basrelief_kernel::unit_info!("keeps the picture");
    type In = Option<Flow<T>>;
    type Out = Option<FrameDone>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.ending { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(token)) => {
                let mut is_open = false;
                token.each(|x, y, rgb| self.write([x, y], rgb, &mut is_open, traffic));
                return Step::over(token.pixels(), 1, latency, None);
            }
            Some(Flow::Control(Control::Frame(frame))) => self.begin(&frame, traffic),
            Some(Flow::Control(Control::FrameEnd)) => return self.end(traffic),
            None if self.state.ending => return self.end(traffic),
            Some(Flow::Control(_)) | None => {}
        }
        Step::after(latency, None)
    }

    /// Returns one write: of the evicted line, or of a line at the frame end.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }

    fn is_empty(&self) -> bool {
        !self.state.ending
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        // Colours, mask of written pixels, number of the line in the picture.
        let line = LINE_PIXELS * (COLOR + 1) + LINE_NUMBER;
        stats.hardware(HardwareKind::Table, "gathered lines", self.config.write_lines, line);
        let c = &self.state.counters;
        stats.figure("pixels", c.pixels, "pixels", "Pixels written");
        stats.figure("frames", c.frames, "frames", "Frames finished");
        stats.figure("pixel_lines_written", c.lines_written, "lines", "Lines of pixels written");
    }
}

#[cfg(test)]
mod tests;
