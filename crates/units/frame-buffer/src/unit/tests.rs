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
    FrameBuffer::new(FrameBufferConfig { write_lines, ..FrameBufferConfig::default() }, &DisplayConfig::default())
}

/// Returns address and size of the writes of a step, and the address of its flip.
fn step(unit: &mut FrameBuffer, token: Option<Flow<Stamp<Pixel>>>) -> (Vec<(u64, u32)>, Option<u64>) {
    assert_eq!(unit.demand(), if token.is_some() { Demand::All } else { Demand::Nothing });
    let mut traffic = MemoryPorts::default();
    let step = unit.step(token, &mut traffic);
    let of = |client| traffic.requests().iter().filter(move |r| r.client == client);
    assert!((0..2).all(|client| of(client).count() as u32 <= unit.largest_step(client as usize)));
    assert!(traffic.requests().iter().all(|r| r.write && r.client < 2));
    let flip = of(1).map(|r| r.address).next();
    assert_eq!(step.marked, flip.is_some());
    (of(0).map(|r| (r.address, r.bytes)).collect(), flip)
}

/// Returns the writes from the end token on, at most one per step, and the flip of the last step.
fn end(unit: &mut FrameBuffer) -> (Vec<(u64, u32)>, Option<u64>) {
    let (mut all, mut flip) = step(unit, Some(END));
    while !unit.is_empty() {
        assert!(flip.is_none() && all.len() < 64);
        let (writes, flipped) = step(unit, None);
        assert!(writes.len() == 1 || flipped.is_some());
        all.extend(writes);
        flip = flipped;
    }
    (all, flip)
}

/// Returns the lines that memory holds in the buffer at `base`, by their last write.
fn lines_at(writes: &[(u64, u32)], base: u64) -> BTreeSet<u64> {
    writes
        .iter()
        .filter_map(|(address, _)| address.checked_sub(base))
        .map(|offset| offset / 64)
        .filter(|line| *line < 99)
        .collect()
}

#[test]
fn last_pixel_stays_and_rest_is_black_and_uncovered() {
    let mut unit = unit(8);
    for token in [frame(3, 5, 2), pixel(4, 1, [1, 2, 3]), pixel(4, 1, [7, 8, 9]), pixel(5, 0, [9; 3]), pixel(0, 2, [9; 3])] {
        step(&mut unit, Some(token));
    }
    // One line is drawn, and the other is cleared.
    assert_eq!(end(&mut unit), (vec![(64, 64), (0, 64)], Some(0)));
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
        assert_eq!(end(&mut unit).0[0], (base + 5 * 64, 64));
    }
    assert_eq!(unit.state.counters, FrameBufferCounters { frames: 3, pixels: 12, lines_written: 24, lines_cleared: 15 });
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
        let (last, flip) = end(&mut unit);
        assert_eq!(last, [0, 3, 4, 5, 6, 7].map(|line| (base + line * 64, 64)), "lines 5 to 7 are background");
        assert_eq!(flip, Some(base));
    }
}

// Claim: images, memory: When a frame ends, memory holds its picture. Lines that nothing is drawn into are cleared by writes.
#[test]
fn frame_without_pixels_is_cleared_by_writes() {
    let lines = |config: FrameBufferConfig, buffers| {
        let mut unit: FrameBuffer = FrameBuffer::new(config, &DisplayConfig { buffers, ..DisplayConfig::default() });
        let mut steps = vec![];
        for number in 0..u64::from(buffers) {
            let mut all = step(&mut unit, Some(frame(0, 16, 8))).0;
            while unit.demand() == Demand::Nothing {
                all.extend(step(&mut unit, None).0);
            }
            steps.push(all.len());
            let (rest, flip) = end(&mut unit);
            assert_eq!(flip, Some(layout::color_buffer(number)));
            all.extend(rest);
            assert_eq!(lines_at(&all, layout::color_buffer(number)), (0..8).collect());
            assert_eq!(all.len(), 8);
        }
        assert_eq!(unit.state.counters.lines_cleared, 8 * u64::from(buffers));
        steps
    };
    let config = FrameBufferConfig::default;
    assert_eq!(lines(config(), 3), [0, 0, 0], "flags: at the end");
    assert_eq!(lines(FrameBufferConfig { clear_flags: false, ..config() }, 2), [8, 8], "no flags: at the beginning");
    assert_eq!(lines(FrameBufferConfig { flags: 5, ..config() }, 2), [3, 3]);
}

#[test]
fn flags_take_cycles_at_both_ends_of_a_frame() {
    let mut unit = FrameBuffer::<Stamp<Pixel>>::new(
        FrameBufferConfig { flags_per_cycle: 2, write_lines: 64, ..FrameBufferConfig::default() },
        &DisplayConfig::default(),
    );
    let mut occupied = |token| unit.step(token, &mut MemoryPorts::default()).occupancy;
    assert_eq!(occupied(Some(frame(0, 16, 8))), 4, "8 flags");
    let lines = (0..7).map(|line: u16| occupied(Some(pixel(4 * (line % 4), 4 * (line / 4), [1; 3]))));
    assert_eq!(lines.collect::<Vec<_>>(), [1; 7]);
    occupied(Some(END));
    (1..7).for_each(|_| assert_eq!(occupied(None), 1));
    assert_eq!(occupied(None), 3, "flags 0 to 7 are examined for line 7");
}

#[test]
fn flags_examined_in_a_cycle_are_searched_at_once() {
    let words = |flags_per_cycle| {
        let config = FrameBufferConfig { flags_per_cycle, ..FrameBufferConfig::default() };
        let mut stats = UnitStats::default();
        FrameBuffer::<Stamp<Pixel>>::new(config, &DisplayConfig::default()).report_stats(&mut stats);
        let piece = stats.all_hardware().iter().find(|piece| piece.about == "flags of clear lines").unwrap();
        (piece.count, piece.entries, piece.finds_first)
    };
    assert_eq!([64, 65_536].map(words), [(2048, 64, true), (2, 65_536, true)]);
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
        let (mut ahead, mut drawn) = (BTreeSet::new(), BTreeSet::new());
        for (x, y) in places {
            let line = u64::from(y / 4 * 5 + x / 4);
            for (address, bytes) in step(&mut unit, Some(pixel(x, y, [1; 3]))).0 {
                prop_assert!(bytes == 64 && address / 64 != line && ahead.remove(&(address / 64)));
            }
            ahead.insert(line);
            drawn.insert(line);
            prop_assert!(ahead.len() <= write_lines as usize);
        }
        let (last, _) = end(&mut unit);
        let (gathered, cleared) = last.split_at(ahead.len());
        prop_assert_eq!(lines_at(gathered, 0), ahead);
        // 5 x 3 lines.
        prop_assert_eq!(lines_at(cleared, 0), (0..15).filter(|line| !drawn.contains(line)).collect::<BTreeSet<u64>>());
    }

    #[test]
    fn one_gathered_line_writes_on_every_line_change(places in prop::collection::vec((0u16..20, 0u16..11), 0..50)) {
        let mut unit = unit(1);
        step(&mut unit, Some(frame(0, 20, 11)));
        let mut written = Vec::new();
        for &(x, y) in &places {
            written.extend(step(&mut unit, Some(pixel(x, y, [1; 3]))).0);
        }
        let cleared = unit.state.flags.count() as usize - places.iter().map(|(x, y)| y / 4 * 5 + x / 4).collect::<BTreeSet<_>>().len();
        written.extend(end(&mut unit).0);
        written.truncate(written.len() - cleared);
        let mut expected: Vec<u64> = places.iter().map(|(x, y)| u64::from(y / 4 * 5 + x / 4)).collect();
        expected.dedup();
        prop_assert_eq!(written.iter().map(|(address, _)| address / 64).collect::<Vec<_>>(), expected);
    }
}
