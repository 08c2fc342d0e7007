//! Z-test, with the z-buffer in the graphics-data memory (124).

use crate::config::DepthConfig;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, OperatorCounts, Operators, Step, Unit, UnitTable};
use basrelief_signals::{
    Control, DepthToken, Flow, Frame, GatheredLines, LINE_NUMBER, LINE_PIXELS, LineFlags, layout, line_of, lines,
};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

/// Arithmetic of a fragment: one comparison of whole numbers with the z-buffer, one fragment per cycle.
const COMPARISON: OperatorCounts = OperatorCounts { integer_add: 1, ..OperatorCounts::NONE };

/// Counters of the z-test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DepthTestCounters {
    /// Fragments tested.
    pub tested: u64,
    /// Fragments that passed.
    pub passed: u64,
    /// Fragments tested in a clear line, whose z values were not read.
    pub clear: u64,
    /// Fragments tested in a gathered line, whose z values were not read.
    pub gathered: u64,
    /// Lines written.
    pub lines_written: u64,
    /// Cleared lines among them.
    pub lines_cleared: u64,
    /// Maximum number of flags in use in any frame.
    pub most_flags: u64,
}

/// State of the z-test between steps.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DepthTestState {
    /// Width of the frame \[pixels\].
    pub width: u32,
    /// The z-buffer, row by row.
    pub z: Vec<u32>,
    /// Clear flags: set for a line that was not written since the fast clear.
    pub flags: LineFlags,
    /// Lines that gather writes.
    pub lines: GatheredLines,
    /// True if the frame end has arrived. It travels on when all gathered lines are written.
    pub ending: bool,
    /// Counters.
    pub counters: DepthTestCounters,
}

/// Z-test: emits the fragments in front of all earlier ones (less-than test, in order), and maintains the z-buffer.
///
/// It owns the z values: it tests *and* updates them, at both positions: behind the rasterizer (early z) or in front of the frame
/// buffer (law 6). Client 0 is the z-cache, client 1 makes posted writes of whole lines of 16 pixels. Two structures of its own
/// save reads (all assumed):
///
/// - *Gathered lines*: some lines gather writes (`depth.write_lines`). Such a line holds all its z values, so none is looked up:
///   values not written to it were read with the line, or are clear. On eviction it is written to memory, and to the z-cache on a
///   hit.
/// - *Clear flags*: a frame begins with a clear that moves no data (fast clear). It sets a flag for each line
///   (`depth.clear_flags`, as many as `depth.flags`). The first write to the line resets the flag, and until then the line is not
///   looked up. Lines without a flag are cleared by writes at the beginning of the frame, one per step.
///
/// If pixels replace the z values, the beginning of a frame waits until the display has read the picture before it. Client 2 makes this
/// request, which moves no data.
#[derive(Clone, Debug, Default)]
pub struct DepthTest<T> {
    /// Parameters.
    pub config: DepthConfig,
    /// Width of a z value \[bits\]. Values of up to 16 bits take 2 bytes, others 4.
    pub z_bits: u32,
    /// Line of the z-cache \[bytes\].
    pub line_bytes: u32,
    /// Latency of the look-up of a flag and of a comparison \[cycles\].
    latency: u64,
    /// True if the picture of the display lies where the z values are.
    shared: bool,
    /// State between steps.
    pub state: DepthTestState,
    token: PhantomData<fn(T) -> T>,
}

impl<T: DepthToken> DepthTest<T> {
    /// Creates a z-test in its power-on state. `z_bits` (1..=32) is the rasterizer's, `line_bytes` the z-cache's.
    pub fn new(config: DepthConfig, operators: &Operators, z_bits: u32, line_bytes: u32) -> Self {
        let flag = if config.clear_flags { config.flag_latency } else { 0 };
        let latency = u64::from(flag) + operators.latency(COMPARISON);
        Self { config, z_bits, line_bytes, latency, shared: false, state: DepthTestState::default(), token: PhantomData }
    }

    /// Makes each frame wait for the display if the pixels of the picture before it are `shared` with the z values.
    #[must_use]
    pub fn in_memory_of_display(self, shared: bool) -> Self {
        Self { shared, ..self }
    }

    fn z_bytes(&self) -> u32 {
        if self.z_bits <= 16 { 2 } else { 4 }
    }

    /// Begins a frame. Returns the cycles that its flags take.
    fn begin(&mut self, frame: &Frame) -> u64 {
        // The frame buffer reports a picture that is too large.
        let room = if layout::fits(frame.width, frame.height) { [frame.width, frame.height] } else { [0, 0] };
        self.state.width = room[0];
        self.state.lines = GatheredLines::default();
        let flags = if self.config.clear_flags { self.config.flags } else { 0 };
        let cycles = self.state.flags.begin(lines::<T>(room[0], room[1]), flags, self.config.flags_per_cycle);
        self.state.counters.most_flags = self.state.counters.most_flags.max(self.state.flags.count());
        self.state.z.clear();
        self.state.z.resize(room[0] as usize * room[1] as usize, u32::MAX >> (32 - self.z_bits.clamp(1, 32)));
        cycles
    }

    fn tell_hardware(&self, stats: &mut UnitStats) {
        stats.operators("depth", COMPARISON, self.z_bits);
        // Depth values, and a mask of written pixels.
        stats.gathered_lines(self.config.write_lines, LINE_PIXELS * (self.z_bits + 1), LINE_NUMBER);
        let flags = if self.config.clear_flags { self.config.flags } else { 0 };
        stats.flags("flags of clear lines", flags, self.config.flags_per_cycle);
    }

    /// Returns the size of a line of the z-buffer \[bytes\].
    fn z_line_bytes(&self) -> u32 {
        LINE_PIXELS * self.z_bytes()
    }

    /// Looks up a z value unless its line is gathered or clear. A value that will be written needs the whole line, which is more
    /// than one look-up if lines of the z-cache are small.
    #[inline]
    fn look_up(&mut self, line: u64, within: u32, whole: bool, traffic: &mut MemoryPorts) {
        if self.state.lines.contains(line) {
            self.state.counters.gathered += 1;
        } else if self.state.flags.is_clear(line) {
            self.state.counters.clear += 1;
        } else {
            let (z, of_line) = (self.z_bytes(), self.z_line_bytes());
            let start = layout::Z_BUFFER + line * u64::from(of_line);
            let (address, bytes) = if whole { (start, of_line) } else { (start + u64::from(within * z), z) };
            traffic.look_up(0, address, bytes);
        }
    }

    /// Gathers a line, and writes the evicted one, if any.
    #[inline]
    fn gather(&mut self, line: u64, traffic: &mut MemoryPorts) {
        self.state.flags.draw(line);
        if let Some(gone) = self.state.lines.touch(line, self.config.write_lines) {
            self.write(gone, traffic);
        }
    }

    fn write(&mut self, line: u64, traffic: &mut MemoryPorts) {
        let bytes = self.z_line_bytes();
        traffic.write(1, layout::Z_BUFFER + line * u64::from(bytes), bytes);
        self.state.counters.lines_written += 1;
    }

    /// Clears a line without a flag.
    fn clear(&mut self, traffic: &mut MemoryPorts) {
        if let Some(line) = self.state.flags.take_unflagged() {
            self.write(line, traffic);
            self.state.counters.lines_cleared += 1;
        }
    }

    /// Tests a pixel of a token. `is_open` is true if the line of the token is known to be the most recently written one, so that
    /// no other work is left.
    #[inline(always)]
    fn passes(&mut self, [x, y]: [u16; 2], z: u32, is_open: &mut bool, traffic: &mut MemoryPorts) -> bool {
        let (x, y) = (u32::from(x), u32::from(y));
        if x >= self.state.width {
            return false;
        }
        let Some(nearest) = self.state.z.get_mut(y as usize * self.state.width as usize + x as usize) else {
            return false;
        };
        let passes = z < *nearest;
        *nearest = z.min(*nearest);
        self.state.counters.tested += 1;
        self.state.counters.passed += u64::from(passes);
        if !*is_open {
            let line = line_of::<T>(self.state.width, [x, y]);
            if !self.state.lines.is_newest(line) {
                *is_open = passes;
                self.test_in_another(line, [x, y], passes, traffic);
                return passes;
            }
            *is_open = true;
        }
        self.state.counters.gathered += 1;
        passes
    }

    /// Looks up a z value in a line that is not the most recently written one, and gathers the line if `passes` is true. (Not
    /// inlined: few pixels come here. Inlined, the body of the loop over the pixels became a call per pixel.)
    #[inline(never)]
    fn test_in_another(&mut self, line: u64, [x, y]: [u32; 2], passes: bool, traffic: &mut MemoryPorts) {
        let [columns, rows] = T::LINE;
        self.look_up(line, y % rows * columns + x % columns, passes, traffic);
        if passes {
            self.gather(line, traffic);
        }
    }

    /// Writes a gathered line, one per step. The frame end travels on with the last of them.
    fn end(&mut self, traffic: &mut MemoryPorts) -> Option<Flow<T>> {
        if let Some(line) = self.state.lines.take() {
            self.write(line, traffic);
        }
        self.state.ending = !self.state.lines.is_empty();
        (!self.state.ending).then_some(Flow::Control(Control::FrameEnd))
    }
}

impl<T: DepthToken> Unit for DepthTest<T> {
    basrelief_kernel::unit_info!("z-test: removes hidden surfaces; owns the depth values");
    type In = Option<Flow<T>>;
    type Out = Option<Flow<T>>;

    #[inline]
    fn demand(&self) -> Demand {
        if self.is_empty() { Demand::All } else { Demand::Nothing }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = self.latency;
        match input {
            Some(Flow::Item(mut token)) => {
                let tested = token.pixels();
                let mut is_open = false;
                let any = token.retain(|x, y, z| self.passes([x, y], z, &mut is_open, traffic));
                let out = (any || T::KEPT_WHEN_EMPTY).then_some(Flow::Item(token));
                // The comparison needs the stored depth, which is requested after the look-up of the flag.
                Step::over(tested, 1, latency, out).after_data(latency as u32)
            }
            Some(Flow::Control(Control::FrameEnd)) => Step::after(latency, self.end(traffic)),
            Some(Flow::Control(control)) => {
                let Control::Frame(frame) = &control else { return Step::after(latency, Some(Flow::Control(control))) };
                let cycles = self.begin(frame);
                let step = Step::after(latency, Some(Flow::Control(control))).busy(cycles);
                if !self.shared {
                    return step;
                }
                traffic.read(2, layout::Z_BUFFER, 1);
                step.blocking()
            }
            None if self.state.ending => Step::after(latency, self.end(traffic)),
            None => {
                self.clear(traffic);
                Step::after(latency, None)
            }
        }
    }

    /// Returns the lines of the z-cache in one line of the z-buffer, which holds all pixels of a token, and one write, of the
    /// evicted line or of a line at the beginning or end of a frame, and one wait for the display.
    fn largest_step(&self, client: usize) -> u32 {
        match client {
            0 => self.z_line_bytes().div_ceil(self.line_bytes.max(1)),
            1 => 1,
            2 => u32::from(self.shared),
            _ => 0,
        }
    }

    fn is_empty(&self) -> bool {
        !self.state.ending && !self.state.flags.has_unflagged()
    }

    fn twin_tables(&self) -> Vec<UnitTable> {
        vec![UnitTable::number("latency", self.latency)]
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.latency, 1_u64);
        self.tell_hardware(stats);
        let c = &self.state.counters;
        stats.figure("z_tested", c.tested, "fragments", "Fragments tested for depth");
        stats.figure("z_passed", c.passed, "fragments", "Fragments in front");
        stats.figure("z_clear", c.clear, "fragments", "Fragments tested without reading z, as their line was clear");
        stats.figure(
            "z_gathered",
            c.gathered,
            "fragments",
            "Fragments tested without reading z, as their line was being gathered",
        );
        stats.figure("z_lines_written", c.lines_written, "lines", "Lines of z values written");
        stats.figure("z_lines_cleared", c.lines_cleared, "lines", "Lines with clear values only");
        stats.figure("z_clear_flags", c.most_flags, "bits", "Flags of lines that are clear, a bit each");
    }
}

#[cfg(test)]
mod tests;
