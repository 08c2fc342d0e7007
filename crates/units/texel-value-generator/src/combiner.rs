//! Combiner (350).

use crate::config::{CombineMode, CombinerConfig};
use crate::join_streams::{PairedInput, pair};
use crate::log::DisplacementMap;
use crate::pixel_pace::PixelPace;
use crate::signals::{IlluminancePacket, TexturePacket};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, OperatorCounts, Operators, Step, Unit};
use basrelief_signals::width::COLOR;
use basrelief_signals::{
    Control, Flow, GatheredLines, LINE_PIXELS, LineFlags, PACKET_PIXELS, PixelPacket, layout, line_of, lines,
};
use serde::{Deserialize, Serialize};

/// Counters of the combiner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CombinerCounters {
    /// Frames begun.
    pub frames: u64,
    /// Pixels combined.
    pub pixels: u64,
    /// Pixels combined with their old value.
    pub read_back: u64,
    /// Lines read for old values.
    pub lines_read: u64,
    /// Packets whose line was held.
    pub forwarded: u64,
    /// Packets whose line was clear, so that its old value is the background.
    pub clear: u64,
}

/// Parameters of the pixel value buffer (360), which the combiner reads back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelValueBuffer {
    /// Buffers of the swap chain, >= 1.
    pub buffers: u32,
    /// Size of a pixel \[bytes\].
    pub pixel_bytes: u32,
    /// Number of flags of clear lines.
    pub flags: u32,
    /// Flags that are set in a cycle, >= 1.
    pub per_cycle: u32,
}

/// State of the combiner between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CombinerState {
    /// Width and height of the frame \[pixels\].
    pub size: [u32; 2],
    /// Value last written to each pixel, which read-back returns. Empty if the mode never reads back.
    pub old: Vec<[u8; 3]>,
    /// Lines whose last values may not be in memory yet.
    pub held: GatheredLines,
    /// Lines that nothing is drawn into.
    pub flags: LineFlags,
    /// Displacements of the frame, if requested.
    pub map: Option<DisplacementMap>,
    /// Displacements of complete frames, not fetched yet.
    pub finished: Vec<DisplacementMap>,
    /// Counters.
    pub counters: CombinerCounters,
}

/// Combiner (350): multiplies texture value and illuminance, and combines the product with the old pixel value from the buffer
/// (360) if the mode requires it (claims 4, 7). Client 0 reads old values, a line at a time.
///
/// Order: between the combiner and memory there are pixels on their way to the buffer (360), lines that gather there, and posted
/// writes. A read would overtake them and return an older value. So the combiner holds the last lines that it wrote, as many as
/// can be in flight, and takes old values from them. A held line is not read. When a line is no longer held, so many others were
/// written since that its own write is done. (Waiting for the write instead would need less memory, but it would cost a round
/// trip for every line that two polygons share.)
///
/// A line that nothing was drawn into in this frame has a flag, as in the buffer (360). It is not read: its old value is the background.
///
/// Memories provide timing, never data (law 6). The combiner is the only unit that writes pixels, so it knows the value that it
/// would read.
#[derive(Clone, Debug, Default)]
pub struct Combiner {
    /// Parameters.
    pub config: CombinerConfig,
    /// Lines held: at least as many as can be in flight from here to memory.
    pub lines: u32,
    buffer: PixelValueBuffer,
    operators: Operators,
    /// State between steps.
    pub state: CombinerState,
}

impl Combiner {
    /// Creates a combiner in its power-on state, with up to `lines` lines in flight to memory.
    pub fn new(config: CombinerConfig, lines: u32, buffer: PixelValueBuffer, operators: Operators) -> Self {
        Self { config, lines, buffer, operators, state: CombinerState::default() }
    }

    /// Starts to record a map of displacements.
    pub fn keep_log(&mut self) {
        self.state.map = Some(DisplacementMap::default());
    }

    /// Takes a control token. Returns the cycles that the flags take.
    fn take(&mut self, control: &Control) -> u64 {
        let mut cycles = 1;
        let state = &mut self.state;
        match control {
            Control::Frame(frame) => {
                // The frame buffer reports a picture that is too large.
                let fits = layout::fits(frame.width, frame.height);
                state.size = if fits { [frame.width, frame.height] } else { [0, 0] };
                let pixels = state.size[0] as usize * state.size[1] as usize;
                state.held = GatheredLines::default();
                if self.config.mode != CombineMode::Replace {
                    let lines = lines::<PixelPacket>(state.size[0], state.size[1]);
                    cycles = state.flags.begin(lines, self.buffer.flags, self.buffer.per_cycle);
                }
                state.old.clear();
                state.old.resize(if self.config.mode == CombineMode::Replace { 0 } else { pixels }, [0; 3]);
                if let Some(map) = &mut state.map {
                    *map = DisplacementMap::new(state.size[0], state.size[1]);
                }
            }
            Control::FrameEnd => {
                state.counters.frames += 1;
                if let Some(map) = &mut state.map {
                    state.finished.push(std::mem::take(map));
                }
            }
            Control::Object(_) | Control::Polygon(_) | Control::CodeBook(_) | Control::Criterion(_) => {}
        }
        cycles
    }

    /// Reads the line of a packet unless it is held or clear. Frames go through the buffers in turn.
    fn read_back(&mut self, packet: &TexturePacket, traffic: &mut MemoryPorts) {
        let line = line_of::<PixelPacket>(self.state.size[0], [u32::from(packet.packet.x), u32::from(packet.packet.y)]);
        let state = &mut self.state;
        state.counters.read_back += packet.packet.pixels() as u64;
        if state.held.contains(line) {
            state.counters.forwarded += 1;
        } else if state.flags.is_clear(line) {
            state.counters.clear += 1;
        } else {
            let bytes = LINE_PIXELS * self.buffer.pixel_bytes;
            let base = layout::color_buffer(state.counters.frames % u64::from(self.buffer.buffers.max(1)));
            traffic.read(0, base + line * u64::from(bytes), bytes);
            state.counters.lines_read += 1;
        }
        state.flags.draw(line);
        state.held.touch(line, self.lines);
    }

    #[inline(always)]
    fn combine(&mut self, texture: &TexturePacket, light: &IlluminancePacket, traffic: &mut MemoryPorts) -> PixelPacket {
        let packet = texture.packet;
        let mut out = PixelPacket { packet, rgb: [[0; 3]; PACKET_PIXELS] };
        for i in packet.positions() {
            let rgba: [u8; 4] = std::array::from_fn(|c| product(texture.rgba[i][c], light.rgba[i][c]));
            out.rgb[i] = [rgba[0], rgba[1], rgba[2]];
            if self.config.mode != CombineMode::Replace {
                self.with_old(&mut out.rgb[i], rgba[3], [packet.x + i as u16, packet.y]);
            }
        }
        if self.config.mode != CombineMode::Replace {
            self.read_back(texture, traffic);
        }
        if let (Some(map), Some(displacement)) = (&mut self.state.map, &texture.displacement) {
            for i in packet.positions() {
                map.note(packet.x + i as u16, packet.y, displacement[i], texture.points & 1 << i != 0);
            }
        }
        self.state.counters.pixels += packet.pixels() as u64;
        out
    }

    /// Combines a new value with the old one of a pixel, and stores the result as its old value.
    fn with_old(&mut self, new: &mut [u8; 3], alpha: u8, [x, y]: [u16; 2]) {
        let place = usize::from(y) * self.state.size[0] as usize + usize::from(x);
        let Some(old) = self.state.old.get_mut(place) else { return };
        let alpha = u32::from(alpha);
        *old = std::array::from_fn(|c| {
            let (new, old) = (u32::from(new[c]), u32::from(old[c]));
            let of_255 = if self.config.mode == CombineMode::Modulate { new * old } else { alpha * new + (255 - alpha) * old };
            ((of_255 + 127) / 255) as u8
        });
        *new = *old;
    }
}

/// Arithmetic of a pixel without its old value: texture by illuminance, of each component.
const PRODUCTS: OperatorCounts = OperatorCounts { multiply: 4, ..OperatorCounts::NONE };
/// Arithmetic of a pixel with its old value, if the product is written.
const MODULATION: OperatorCounts = OperatorCounts { multiply: 3, ..OperatorCounts::NONE };
/// Arithmetic of a pixel with its old value, if both are weighted by alpha.
const BLENDING: OperatorCounts = OperatorCounts { multiply: 6, add: 3, ..OperatorCounts::NONE };
/// Width of a texture value or an illuminance \[bits\].
const FACTOR_BITS: u32 = 16;
/// Width of a component of a pixel, or of its weight \[bits\].
const PIXEL_BITS: u32 = 8;
/// Width of a line number and its position in the order of writes \[bits\].
const LINE_TAG_BITS: u32 = 32;

impl Combiner {
    /// Returns the latency of a pixel, and the part of it that follows the old value \[cycles\]. The request of an old value follows the
    /// look-up of its flag.
    fn latencies(&self) -> [u32; 2] {
        let CombinerConfig { mode, latency, blend_latency, flag_latency, .. } = self.config;
        let flag = if mode == CombineMode::Replace || self.buffer.flags == 0 { 0 } else { flag_latency };
        [latency, blend_latency.min(latency)].map(|cycles| cycles + flag)
    }

    fn tell_hardware(&self, stats: &mut UnitStats) {
        let pace = PixelPace { operators: &self.operators, interval: self.config.initiation_interval };
        pace.tell("texture by illuminance", PRODUCTS, FACTOR_BITS, stats);
        let with_old = match self.config.mode {
            CombineMode::Replace => return,
            CombineMode::Modulate => MODULATION,
            CombineMode::Blend => BLENDING,
        };
        pace.tell("with the old value", with_old, PIXEL_BITS, stats);
        stats.hardware(HardwareKind::Table, "lines on their way to memory", self.lines, LINE_PIXELS * COLOR);
        stats.hardware(HardwareKind::Adder, "whether a line is held", self.lines, LINE_TAG_BITS);
        stats.flags("flags of clear lines", self.buffer.flags, self.buffer.per_cycle);
        stats.hardware(HardwareKind::Registers, "which lines are held", self.lines, LINE_TAG_BITS);
    }
}

/// Multiplies a texture value (255 * 2^8 means 1) and an illuminance (2^14 means 1) to 8 bits. Values saturate and halves round
/// up.
#[inline(always)]
fn product(texture: u16, illuminance: u16) -> u8 {
    ((u32::from(texture) * u32::from(illuminance) + (1 << 21)) >> 22).min(255) as u8
}

impl Unit for Combiner {
    basrelief_kernel::unit_info!("combines texture, illuminance and, in some modes, the old value");
    type In = (Option<Flow<TexturePacket>>, Option<Flow<IlluminancePacket>>);
    type Out = Option<Flow<PixelPacket>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let [latency, behind_data] = self.latencies();
        match pair("combiner", input, traffic) {
            // All pixels are hidden.
            PairedInput::Items(texture, _) if texture.packet.mask == 0 => Step::after(latency.into(), None),
            PairedInput::Items(texture, light) => {
                let out = self.combine(&texture, &light, traffic);
                let pixels = out.packet.pixels();
                Step::over(pixels, u64::from(self.config.initiation_interval), latency.into(), Some(Flow::Item(out)))
                    .after_data(behind_data)
            }
            PairedInput::Control(control) => {
                let cycles = self.take(&control);
                Step::after(latency.into(), Some(Flow::Control(control))).busy(cycles)
            }
            PairedInput::Nothing => Step::after(latency.into(), None),
        }
    }

    /// Returns one read of a line.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0 && self.config.mode != CombineMode::Replace)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(0, self.latencies()[0], 1_u64);
        stats.figure("pixels_read_back", self.state.counters.read_back, "pixels", "Pixels combined with their old value");
        let c = &self.state.counters;
        stats.figure("pixel_lines_read", c.lines_read, "lines", "Lines of pixels read for that");
        stats.figure(
            "pixel_lines_forwarded",
            c.forwarded,
            "packets",
            "Packets whose line was still on its way to memory, and was not read",
        );
        stats.figure("pixel_lines_clear", c.clear, "packets", "Packets whose line was clear, and was not read");
        self.tell_hardware(stats);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slower_pixels_share_operators() {
        let counts = |initiation_interval| {
            let config = CombinerConfig { mode: CombineMode::Blend, initiation_interval, ..CombinerConfig::default() };
            let mut stats = UnitStats::default();
            Combiner::new(config, 0, PixelValueBuffer::default(), Operators::default()).report_stats(&mut stats);
            stats.all_hardware().iter().map(|piece| (piece.count, piece.turns)).collect::<Vec<_>>()
        };
        assert_eq!(counts(1), [(4, 1), (6, 1), (3, 1)]);
        assert_eq!(counts(2), [(2, 2), (3, 2), (2, 2)]);
        assert_eq!(counts(16), [(1, 4), (1, 6), (1, 3)]);
    }

    #[test]
    fn product_of_ones_is_one_and_halves_round_up() {
        let one = 1 << 14;
        for value in 0..=255u16 {
            assert_eq!(product(value << 8, one), value as u8);
            assert_eq!(product(value << 8, 3 * one), (3 * value).min(255) as u8);
        }
        assert_eq!(product(255 << 8, one / 2), 128);
        assert_eq!(product(255 << 8, u16::MAX), 255);
    }
}
