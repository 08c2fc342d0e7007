use super::*;
use crate::FrameBufferCounters;
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

fn frame(index: u32, width: u32, height: u32) -> Flow<Stamp<Pixel>> {
    Flow::Control(Control::Frame(Arc::new(Frame { index, width, height, ..Frame::default() })))
}

fn pixel(x: u16, y: u16, rgb: [u8; 3]) -> Flow<Stamp<Pixel>> {
    Flow::Item(Stamp::from_iter([Pixel { x, y, z: 0, rgb }]))
}

const END: Flow<Stamp<Pixel>> = Flow::Control(Control::FrameEnd);

fn unit(write_lines: u32) -> FrameBuffer {
    FrameBuffer::new(FrameBufferConfig { write_lines, ..FrameBufferConfig::default() })
}

/// Returns address and size of the writes of a step, and its output.
fn step(unit: &mut FrameBuffer, token: Option<Flow<Stamp<Pixel>>>) -> (Vec<(u64, u32)>, Option<FrameDone>) {
    assert_eq!(unit.demand(), if token.is_some() { Demand::All } else { Demand::Nothing });
    let mut traffic = MemoryPorts::default();
    let step = unit.step(token, &mut traffic);
    assert_eq!(step.marked, step.out.is_some());
    assert!(traffic.requests().len() as u32 <= unit.largest_step(0));
    assert!(traffic.requests().iter().all(|r| r.write && r.client == 0));
    (traffic.requests().iter().map(|r| (r.address, r.bytes)).collect(), step.out)
}

/// Returns the writes from the end token on, one per step. The last step finishes the frame.
fn end(unit: &mut FrameBuffer) -> (Vec<(u64, u32)>, Option<FrameDone>) {
    let (mut all, mut done) = step(unit, Some(END));
    while !unit.is_empty() {
        assert!(done.is_none() && all.len() < 64);
        let (writes, out) = step(unit, None);
        assert_eq!(writes.len(), 1);
        all.extend(writes);
        done = out;
    }
    (all, done)
}

#[test]
fn last_pixel_stays_and_rest_is_black_and_uncovered() {
    let mut unit = unit(8);
    for token in [frame(3, 5, 2), pixel(4, 1, [1, 2, 3]), pixel(4, 1, [7, 8, 9]), pixel(5, 0, [9; 3]), pixel(0, 2, [9; 3])] {
        step(&mut unit, Some(token));
    }
    let (_, done) = end(&mut unit);
    assert_eq!(done, Some(FrameDone { index: 3, width: 5, height: 2, address: 0, bytes: 2 * 64 }));
    let finished = &unit.state.finished;
    assert_eq!(finished.len(), 1);
    assert_eq!(finished[0].rgb.iter().filter(|c| **c != [0; 3]).collect::<Vec<_>>(), [&[7, 8, 9]]);
    assert_eq!(finished[0].covered.iter().position(|c| *c), Some(9));
    assert_eq!(end(&mut unit), (vec![], None), "no frame has begun");
}

#[test]
fn one_gathered_line_is_written_on_leaving_it() {
    let mut unit = unit(1);
    for base in [0, layout::COLOR_BUFFER_STRIDE, 0] {
        step(&mut unit, Some(frame(0, 16, 8)));
        let mut writes = |x, y| step(&mut unit, Some(pixel(x, y, [1; 3]))).0;
        assert!(writes(1, 1).is_empty());
        assert!(writes(2, 3).is_empty());
        assert_eq!(writes(4, 3), [(base, 64)]);
        assert_eq!(writes(4, 4), [(base + 64, 64)]);
        assert_eq!(end(&mut unit).0, [(base + 5 * 64, 64)]);
    }
    assert_eq!(unit.state.counters, FrameBufferCounters { frames: 3, pixels: 12, lines_written: 9 });
}

#[test]
fn frame_end_writes_all_gathered_lines_to_its_buffer() {
    let mut unit = unit(3);
    for base in [0, layout::COLOR_BUFFER_STRIDE] {
        step(&mut unit, Some(frame(0, 16, 8)));
        let mut writes = |line: u16| step(&mut unit, Some(pixel(4 * (line % 4), 4 * (line / 4), [1; 3]))).0;
        for line in [0, 1, 2, 0] {
            assert!(writes(line).is_empty());
        }
        assert_eq!(writes(3), [(base + 64, 64)]);
        assert_eq!(writes(4), [(base + 2 * 64, 64)]);
        let (last, done) = end(&mut unit);
        assert_eq!(last, [0, 3, 4].map(|line| (base + line * 64, 64)));
        assert_eq!(done.map(|d| d.address), Some(base));
    }
}

#[test]
fn oversized_picture_is_a_fault_without_memory() {
    let mut unit = unit(8);
    let mut traffic = MemoryPorts::default();
    unit.step(Some(frame(7, u32::MAX, 2)), &mut traffic);
    assert!(format!("{traffic:?}").contains("frame 7 is 4294967295 x 2 pixels"));
    assert_eq!(step(&mut unit, Some(pixel(0, 0, [1; 3]))), (vec![], None));
}

proptest! {
    #[test]
    fn drawn_line_is_written_after_its_last_pixel(
        places in prop::collection::vec((0u16..20, 0u16..11), 0..80), write_lines in 1u32..10,
    ) {
        let mut unit = unit(write_lines);
        step(&mut unit, Some(frame(0, 20, 11)));
        // Lines with data newer than memory.
        let mut ahead = BTreeSet::new();
        for (x, y) in places {
            let line = u64::from(y / 4 * 5 + x / 4);
            for (address, bytes) in step(&mut unit, Some(pixel(x, y, [1; 3]))).0 {
                prop_assert!(bytes == 64 && address / 64 != line && ahead.remove(&(address / 64)));
            }
            ahead.insert(line);
            prop_assert!(ahead.len() <= write_lines as usize);
        }
        let (last, done) = end(&mut unit);
        prop_assert!(last.iter().all(|(address, bytes)| address + u64::from(*bytes) <= done.unwrap_or_default().bytes));
        prop_assert_eq!(BTreeSet::from_iter(last.iter().map(|(address, _)| address / 64)), ahead);
    }

    #[test]
    fn one_gathered_line_writes_on_every_line_change(places in prop::collection::vec((0u16..20, 0u16..11), 0..50)) {
        let mut unit = unit(1);
        step(&mut unit, Some(frame(0, 20, 11)));
        let mut written = Vec::new();
        for &(x, y) in &places {
            written.extend(step(&mut unit, Some(pixel(x, y, [1; 3]))).0);
        }
        written.extend(end(&mut unit).0);
        let mut expected: Vec<u64> = places.iter().map(|(x, y)| u64::from(y / 4 * 5 + x / 4)).collect();
        expected.dedup();
        prop_assert_eq!(written.iter().map(|(address, _)| address / 64).collect::<Vec<_>>(), expected);
    }
}
