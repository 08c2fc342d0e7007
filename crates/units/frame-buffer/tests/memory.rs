//! Memory holds each finished picture: the picture is read back from the writes of a run.

use basrelief_frame_buffer::{DisplayConfig, FinishedFrame, FrameBuffer, FrameBufferConfig, PixelBuffer, PixelBufferConfig};
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_signals::{
    ColorToken, Control, Flow, Frame, LINE_PIXELS, PACKET_PIXELS, Packet, PictureFlow, Pixel, PixelBlock, PixelPacket, Stamp,
    line_of,
};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Width and height of the pictures.
const SIZE: [u32; 2] = [37, 11];
/// Colour of memory that nothing was written to.
const GARBAGE: [u8; 3] = [7, 77, 177];

/// A place and its colour, for each pixel of a frame in the order of drawing.
type Drawn = Vec<((u16, u16), [u8; 3])>;

fn frames() -> impl Strategy<Value = Vec<Drawn>> {
    let pixel = ((0..SIZE[0] as u16, 0..SIZE[1] as u16), any::<[u8; 3]>());
    prop::collection::vec(prop::collection::vec(pixel, 0..60), 1..6)
}

/// Memory of colours: by buffer and position in the picture.
#[derive(Default)]
struct ColorMemory(BTreeMap<(u64, [u32; 2]), [u8; 3]>);

impl ColorMemory {
    /// Stores the pixels of a line at the time of its write. `line_at` returns the line of a position.
    fn write(&mut self, base: u64, line: u64, picture: &FinishedFrame, line_at: impl Fn([u32; 2]) -> u64) {
        for (place, color) in picture.rgb.iter().enumerate() {
            let at = [place as u32 % picture.width, place as u32 / picture.width];
            if line_at(at) == line {
                self.0.insert((base, at), *color);
            }
        }
    }

    /// Returns the picture in a buffer.
    fn read(&self, base: u64) -> Vec<[u8; 3]> {
        let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
        places.map(|at| self.0.get(&(base, at)).copied().unwrap_or(GARBAGE)).collect()
    }
}

fn frame() -> Arc<Frame> {
    Arc::new(Frame { width: SIZE[0], height: SIZE[1], ..Frame::default() })
}

/// Splits an address into the start of its buffer and the number of its line.
fn split(address: u64, line_bytes: u64) -> (u64, u64) {
    let buffer = address >> 27 << 27;
    (buffer, (address - buffer) / line_bytes)
}

/// Draws the frames, and asserts that each buffer holds its picture when the display flips to it.
fn check<T: ColorToken>(frames: &[Drawn], config: FrameBufferConfig, buffers: u32, token: impl Fn((u16, u16), [u8; 3]) -> T) {
    let display = DisplayConfig { buffers, ..DisplayConfig::default() };
    let mut unit = FrameBuffer::<T>::new(config, &display);
    let mut memory = ColorMemory::default();
    for drawn in frames {
        let pixels = drawn.iter().map(|&(at, color)| Flow::Item(token(at, color)));
        let mut tokens =
            [Flow::Control(Control::Frame(frame()))].into_iter().chain(pixels).chain([Flow::Control(Control::FrameEnd)]);
        loop {
            let input = if unit.demand() == Demand::Nothing { None } else { tokens.next() };
            if input.is_none() && unit.demand() != Demand::Nothing {
                break;
            }
            let before = unit.state.picture.clone();
            let mut traffic = MemoryPorts::default();
            unit.step(input, &mut traffic);
            let picture = unit.state.picture.clone().or(before).or_else(|| unit.state.finished.last().cloned());
            for request in traffic.requests() {
                if request.client == 0 {
                    let (base, line) = split(request.address, u64::from(LINE_PIXELS * 4));
                    memory.write(base, line, picture.as_ref().unwrap(), |at| line_of::<T>(SIZE[0], at));
                } else {
                    assert!(memory.read(request.address) == unit.state.finished.last().unwrap().rgb);
                }
            }
        }
    }
    assert_eq!(unit.state.finished.len(), frames.len());
}

proptest! {
    // Claim: as frame_without_pixels_is_cleared_by_writes.
    #[test]
    fn picture_is_read_back_from_recorded_writes(
        frames in frames(), write_lines in 1u32..6, clear_flags: bool, flags in 1u32..40, buffers in 2u32..4,
    ) {
        let config = FrameBufferConfig { write_lines, clear_flags, flags, ..FrameBufferConfig::default() };
        check(&frames, config.clone(), buffers, |(x, y), rgb| Stamp::from_iter([Pixel { x, y, z: 0, rgb }]));
        check(&frames, config, buffers, |(x, y), color| {
            let mut rgb = [[0; 3]; PACKET_PIXELS];
            rgb[usize::from(x % 16)] = color;
            PixelPacket { packet: Packet { x: x / 16 * 16, y, mask: 1 << (x % 16) }, rgb }
        });
    }

    #[test]
    fn picture_of_blocks_is_read_back_from_recorded_writes(frames in frames(), rounds in 1u32..5, buffers in 2u32..4, shared: bool) {
        let display = DisplayConfig { buffers, ..DisplayConfig::default() };
        let mut unit = PixelBuffer::new(PixelBufferConfig::default(), &display, shared);
        let mut memory = ColorMemory::default();
        for drawn in &frames {
            if shared {
                memory.0.clear();
            }
            let colors: BTreeMap<(u16, u16), [u8; 3]> = drawn.iter().copied().collect();
            let mut tokens = vec![PictureFlow::Frame(frame())];
            for round in 1..=rounds {
                let dim = |color: [u8; 3]| color.map(|c| c / (rounds + 1 - round) as u8);
                for (by, bx) in (0..3).flat_map(|by| (0..10).map(move |bx| (by, bx))) {
                    let mut block = PixelBlock { at: [bx, by], mask: 0, rgb: [[0; 3]; 16] };
                    for i in 0..16_u16 {
                        if let Some(color) = colors.get(&(4 * bx + i % 4, 4 * by + i / 4)) {
                            block.mask |= 1 << i;
                            block.rgb[usize::from(i)] = dim(*color);
                        }
                    }
                    tokens.push(PictureFlow::Pixels(block));
                }
                tokens.push(PictureFlow::Show { last: round == rounds });
            }
            for token in tokens {
                let mut traffic = MemoryPorts::default();
                let is_last = matches!(token, PictureFlow::Show { last: true });
                unit.step(Some(token), &mut traffic);
                for request in traffic.requests() {
                    let base = if shared { basrelief_signals::layout::Z_BUFFER } else { request.address >> 27 << 27 };
                    if request.client == 0 {
                        let line = (request.address - base) / 64;
                        let picture = unit.state.picture.as_ref().unwrap();
                        memory.write(base, line, picture, |[x, y]| u64::from(y / 4 * SIZE[0].div_ceil(4) + x / 4));
                    } else {
                        let shown = if is_last { &unit.state.finished } else { &unit.state.rounds };
                        prop_assert!(memory.read(base) == shown.last().unwrap().rgb);
                    }
                }
            }
            if unit.demand() == Demand::Nothing {
                unit.step(None, &mut MemoryPorts::default());
            }
        }
    }
}
