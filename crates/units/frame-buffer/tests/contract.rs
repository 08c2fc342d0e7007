//! Frame buffer (126) and pixel buffer (124) keep the unit contract.

use basrelief_frame_buffer::{DisplayConfig, FrameBuffer, FrameBufferConfig, PixelBuffer, PixelBufferConfig};
use basrelief_kernel_conformance::unit_contract;
use basrelief_signals::{Control, Flow, Frame, PictureFlow, Pixel, PixelBlock, Stamp};
use std::sync::Arc;

fn frame(index: u32, width: u32, height: u32) -> Arc<Frame> {
    Arc::new(Frame { index, width, height, ..Frame::default() })
}

/// Returns three frames of different sizes, one of them empty, with pixels outside, and an end without a frame.
fn pixels() -> Vec<Flow<Stamp<Pixel>>> {
    let mut all = Vec::new();
    for (index, (width, height, count)) in (0..).zip([(21, 9, 150), (4, 4, 0), (16, 17, 99)]) {
        all.push(Flow::Control(Control::Frame(frame(index, width, height))));
        let pixel = |i: u16| Pixel { x: i * 11 % 23, y: i / 9 % 19, z: 0, rgb: [i as u8, 2, 3] };
        all.extend((0..count).map(|i| Flow::Item(Stamp::from_iter([pixel(i)]))));
        all.push(Flow::Control(Control::FrameEnd));
    }
    all.push(Flow::Control(Control::FrameEnd));
    all
}

unit_contract! {
    name: frame_buffer,
    unit: FrameBuffer::new(FrameBufferConfig { pixel_bytes: 3, latency: 4, ..FrameBufferConfig::default() }, &DisplayConfig::default()),
    inputs: pixels(),
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

unit_contract! {
    name: frame_buffer_of_one_gathered_line,
    unit: FrameBuffer::new(FrameBufferConfig { write_lines: 1, flags: 3, ..FrameBufferConfig::default() }, &DisplayConfig::default()),
    inputs: pixels(),
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}

/// Returns two frames, the first in two pictures, with blocks at the edge and beside it, and a picture without a frame.
fn blocks() -> Vec<PictureFlow> {
    let block = |i: u16| PictureFlow::Pixels(PixelBlock { at: [i % 7, i / 7], mask: 0x8421 << (i % 3), rgb: [[i as u8; 3]; 16] });
    let picture = |blocks: std::ops::Range<u16>, last| blocks.map(block).chain([PictureFlow::Show { last }]);
    let begun = |index, width| std::iter::once(PictureFlow::Frame(frame(index, width, 9)));
    begun(0, 21)
        .chain(picture(0..12, false))
        .chain(picture(4..21, true))
        .chain(begun(1, 5))
        .chain(picture(0..2, true))
        .chain([PictureFlow::Show { last: true }])
        .collect()
}

unit_contract! {
    name: pixel_buffer,
    unit: PixelBuffer::new(PixelBufferConfig { pixel_bytes: 3, latency: 4 }, &DisplayConfig::default(), true),
    inputs: blocks(),
    clients: [ClientKind::Port, ClientKind::Port],
    state,
}
