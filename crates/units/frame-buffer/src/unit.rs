//! The unit and its step.

use crate::config::{DisplayConfig, FrameBufferConfig};
use crate::state::{FinishedFrame, FrameBufferState};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::width::COLOR;
use basrelief_signals::{
    ColorToken, Control, Flow, Frame, GatheredLines, LINE_NUMBER, LINE_PIXELS, Pixel, Stamp, layout, line_of, lines,
};
use std::marker::PhantomData;

/// Frame buffer (126): takes pixels in order, and the last one at a position stays. Client 0 makes posted writes of lines: the 16
/// pixels around a token (4 x 4 for stamps, 16 x 1 for packets). Client 1 flips the display to the finished frame. Its credits are the free
/// buffers of the swap chain, so the next frame waits for a free buffer.
///
/// Some lines gather writes (`frame_buffer.write_lines`): all pixels drawn into a line before its eviction are written at once. A
/// line is written as a whole transfer, however few pixels of it were drawn. The other pixels keep their value (byte enables,
/// assumed), so nothing is ever read.
///
/// When a frame ends, memory holds the whole picture. Each line has a flag while nothing is drawn into it
/// (`frame_buffer.clear_flags`). The first write of such a line also writes its background, and the end of the frame writes the lines
/// that are still flagged. Lines without a flag are written at the beginning of the frame.
#[derive(Clone, Debug)]
pub struct FrameBuffer<T = Stamp<Pixel>> {
    /// Parameters.
    pub config: FrameBufferConfig,
    /// Buffers of the swap chain.
    buffers: u64,
    /// State between steps.
    pub state: FrameBufferState,
    token: PhantomData<fn(T)>,
}

impl<T: ColorToken> Default for FrameBuffer<T> {
    fn default() -> Self {
        Self::new(FrameBufferConfig::default(), &DisplayConfig::default())
    }
}

impl<T: ColorToken> FrameBuffer<T> {
    /// Creates a frame buffer in its power-on state, with the swap chain of a display.
    pub fn new(config: FrameBufferConfig, display: &DisplayConfig) -> Self {
        Self { config, buffers: display.buffers.into(), state: FrameBufferState::default(), token: PhantomData }
    }

    /// Begins a frame. Returns the cycles that its flags take.
    fn begin(&mut self, frame: &Frame, traffic: &mut MemoryPorts) -> u64 {
        let (index, width, height) = (frame.index, frame.width, frame.height);
        self.state.lines = GatheredLines::default();
        self.state.picture = None;
        if !layout::fits(width, height) {
            traffic.fault(format!(
                "frame buffer: frame {index} is {width} x {height} pixels; there is room for {} per side and {} in all, use a smaller size",
                layout::MAX_SIDE,
                layout::MAX_PIXELS
            ));
            return 1;
        }
        let pixels = width as usize * height as usize;
        let (rgb, covered) = (vec![[0; 3]; pixels], vec![false; pixels]);
        self.state.picture = Some(FinishedFrame { index, round: 0, width, height, rgb, covered });
        let flags = if self.config.clear_flags { self.config.flags } else { 0 };
        self.state.flags.begin(lines::<T>(width, height), flags, self.config.flags_per_cycle)
    }

    /// Returns the base address. Frames go through the buffers of the swap chain in turn.
    fn base(&self) -> u64 {
        layout::color_buffer(self.state.counters.frames % self.buffers.max(1))
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
        self.state.flags.draw(line);
        if let Some(gone) = self.state.lines.touch(line, self.config.write_lines) {
            self.write_line(gone, traffic);
        }
    }

    fn write_line(&mut self, line: u64, traffic: &mut MemoryPorts) {
        let bytes = LINE_PIXELS * self.config.pixel_bytes;
        traffic.write(0, self.base() + line * u64::from(bytes), bytes);
        self.state.counters.lines_written += 1;
    }

    /// Writes a line of background.
    fn clear_line(&mut self, line: u64, traffic: &mut MemoryPorts) {
        self.write_line(line, traffic);
        self.state.counters.lines_cleared += 1;
    }

    /// Writes a gathered line, or a line of background, one per step. The step after the last of them finishes the frame.
    fn end(&mut self, traffic: &mut MemoryPorts) -> Step<()> {
        let step = Step::after(self.config.latency.into(), ());
        if self.state.picture.is_none() {
            return step;
        }
        self.state.ending = true;
        if let Some(line) = self.state.lines.take() {
            self.write_line(line, traffic);
            return step;
        }
        let (clear, cycles) = self.state.flags.take_clear(self.config.flags_per_cycle);
        match clear {
            Some(line) => self.clear_line(line, traffic),
            None => return self.finish(step.busy(cycles), traffic),
        }
        step.busy(cycles)
    }

    /// Finishes the frame: the display flips to it.
    fn finish(&mut self, step: Step<()>, traffic: &mut MemoryPorts) -> Step<()> {
        traffic.write(1, self.base(), 1);
        self.state.ending = false;
        self.state.finished.extend(self.state.picture.take());
        self.state.counters.frames += 1;
        step.marked()
    }
}

impl<T: ColorToken> Unit for FrameBuffer<T> {
    basrelief_kernel::unit_info!("stores the image");
    type In = Option<Flow<T>>;
    type Out = ();

    #[inline]
    fn demand(&self) -> Demand {
        if self.is_empty() { Demand::All } else { Demand::Nothing }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(token)) => {
                let mut is_open = false;
                token.each(|x, y, rgb| self.write([x, y], rgb, &mut is_open, traffic));
                return Step::over(token.pixels(), 1, latency, ());
            }
            Some(Flow::Control(Control::Frame(frame))) => return Step::after(latency, ()).busy(self.begin(&frame, traffic)),
            Some(Flow::Control(Control::FrameEnd)) => return self.end(traffic),
            None if self.state.ending => return self.end(traffic),
            Some(Flow::Control(_)) => {}
            None => {
                if let Some(line) = self.state.flags.take_unflagged() {
                    self.clear_line(line, traffic);
                }
            }
        }
        Step::after(latency, ())
    }

    /// Returns one write, of the evicted line or of a line at the beginning or end of a frame, and one flip.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client < 2)
    }

    fn is_empty(&self) -> bool {
        !self.state.ending && !self.state.flags.has_unflagged()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        // Colours, and a mask of written pixels.
        stats.gathered_lines(self.config.write_lines, LINE_PIXELS * (COLOR + 1), LINE_NUMBER);
        let flags = if self.config.clear_flags { self.config.flags } else { 0 };
        stats.searched_flags("flags of clear lines", flags, self.config.flags_per_cycle);
        let c = &self.state.counters;
        stats.figure("pixels", c.pixels, "pixels", "Pixels written");
        stats.figure("frames", c.frames, "frames", "Frames finished");
        stats.figure("pixel_lines_written", c.lines_written, "lines", "Lines of pixels written");
        stats.figure("pixel_lines_cleared", c.lines_cleared, "lines", "Lines with background only");
    }
}

#[cfg(test)]
mod tests;
