//! Combiner (350): the old value from the buffer (360), and the time of its read.

use crate::figures::frame;
use basrelief_kernel::{MemoryPorts, Operators, Unit};
use basrelief_signals::{Flow, GatheredLines};
use basrelief_texel_value_generator::signals::{IlluminancePacket, TexturePacket};
use basrelief_texel_value_generator::{CombineMode, Combiner, CombinerConfig, PixelValueBuffer};
use proptest::prelude::*;
use std::collections::VecDeque;

/// Illuminance 1.
const ONE: u16 = 1 << 14;
/// No flags of clear lines.
const NO_FLAGS: PixelValueBuffer = PixelValueBuffer { buffers: 2, pixel_bytes: 4, flags: 0, per_cycle: 64 };

fn combiner(mode: CombineMode, lines: u32, buffer: PixelValueBuffer) -> Combiner {
    let mut unit = Combiner::new(CombinerConfig { mode, ..CombinerConfig::default() }, lines, buffer, Operators::default());
    unit.step((Some(Flow::Control(frame(40, 3))), Some(Flow::Control(frame(40, 3)))), &mut MemoryPorts::default());
    unit
}

/// Combines a packet of one pixel. Returns its colour, and the addresses read.
fn combine(unit: &mut Combiner, [x, y]: [u16; 2], [value, alpha]: [u16; 2]) -> ([u8; 3], Vec<u64>) {
    let (mut texture, mut light) = (TexturePacket::default(), IlluminancePacket::default());
    (texture.packet.x, texture.packet.y, texture.packet.mask) = (x, y, 0b1000);
    texture.rgba[3] = [value << 8, value << 8, value << 8, alpha << 8];
    light.rgba[3] = [ONE, ONE / 2, 0, ONE];
    let mut traffic = MemoryPorts::default();
    let out = unit.step((Some(Flow::Item(texture)), Some(Flow::Item(light))), &mut traffic).out;
    let Some(Flow::Item(packet)) = out else { panic!() };
    assert!(traffic.requests().iter().all(|r| !r.write && r.bytes == 64));
    (packet.rgb[3], traffic.requests().iter().map(|r| r.address).collect())
}

// Claim: as claims_4_and_7_intermediate_texel_modifies_pixel_value.
#[test]
fn combiner_replaces_modulates_and_blends() {
    let drawn = |mode| {
        let mut unit = combiner(mode, 4, NO_FLAGS);
        [[200, 255], [100, 51]].map(|value| combine(&mut unit, [16, 2], value))
    };
    let line = vec![(2 * 3 + 1) * 64];
    assert_eq!(drawn(CombineMode::Replace), [([200, 100, 0], vec![]), ([100, 50, 0], vec![])]);
    assert_eq!(drawn(CombineMode::Modulate), [([0; 3], line.clone()), ([0; 3], vec![])], "the buffer begins black");
    // A fifth of the new value, four fifths of the old one.
    assert_eq!(drawn(CombineMode::Blend), [([200, 100, 0], line), ([180, 90, 0], vec![])]);
}

// Claim: as line_is_read_only_after_its_write_is_done.
#[test]
fn held_line_is_not_read_and_evicted_line_is() {
    let mut unit = combiner(CombineMode::Blend, 2, NO_FLAGS);
    let mut read = |place| combine(&mut unit, place, [9, 9]).1.len();
    assert_eq!([[0, 0], [16, 0], [0, 0], [32, 0], [0, 0], [16, 0]].map(&mut read), [1, 1, 0, 1, 0, 1]);
    assert_eq!((unit.state.counters.lines_read, unit.state.counters.forwarded, unit.state.counters.read_back), (4, 2, 6));
}

#[test]
fn clear_line_is_not_read() {
    let mut unit = combiner(CombineMode::Blend, 1, PixelValueBuffer { flags: 8, per_cycle: 2, ..NO_FLAGS });
    let mut read = |place| combine(&mut unit, place, [9, 9]).1;
    // 40 x 3 pixels are 9 lines; the last has no flag.
    assert_eq!([[0, 0], [16, 0], [0, 0], [32, 2]].map(&mut read), [vec![], vec![], vec![0], vec![8 * 64]]);
    assert_eq!((unit.state.counters.lines_read, unit.state.counters.clear), (2, 2));
    let begun = (Some(Flow::Control(frame(40, 3))), Some(Flow::Control(frame(40, 3))));
    assert_eq!(unit.step(begun, &mut MemoryPorts::default()).occupancy, 4, "8 flags, 2 in a cycle");
    assert!(combine(&mut unit, [0, 0], [9, 9]).1.is_empty());
}

#[test]
fn blending_begins_with_the_old_value() {
    for (latency, after) in [(3, 2), (9, 2), (1, 1)] {
        let config = CombinerConfig { mode: CombineMode::Blend, latency, ..CombinerConfig::default() };
        let mut unit = Combiner::new(config, 4, PixelValueBuffer { per_cycle: 1, ..NO_FLAGS }, Operators::default());
        let mut texture = TexturePacket::default();
        texture.packet.mask = 1;
        let input = (Some(Flow::Item(texture)), Some(Flow::Item(IlluminancePacket::default())));
        let step = unit.step(input, &mut MemoryPorts::default());
        assert_eq!((step.after_data, step.latency), (after, latency.into()));
    }
}

#[test]
fn look_up_of_a_flag_delays_the_old_value() {
    for (mode, flags, delay) in [(CombineMode::Blend, 8, 5), (CombineMode::Blend, 0, 0), (CombineMode::Replace, 8, 0)] {
        let config = CombinerConfig { mode, flag_latency: 5, ..CombinerConfig::default() };
        let mut unit = Combiner::new(config, 4, PixelValueBuffer { flags, per_cycle: 1, ..NO_FLAGS }, Operators::default());
        let mut texture = TexturePacket::default();
        texture.packet.mask = 1;
        let input = (Some(Flow::Item(texture)), Some(Flow::Item(IlluminancePacket::default())));
        let step = unit.step(input, &mut MemoryPorts::default());
        assert_eq!((step.latency, step.after_data), (3 + u64::from(delay), 2 + delay));
    }
}

proptest! {
    /// The buffer (360) behind a FIFO of `depth` packets takes each packet as late as possible. It gathers `gathering` lines, and
    /// the last `posted` writes are not done yet.
    // Claim: texel, read-back: Old values are read through the port. Lines that may not be in memory yet are held and not read.
    #[test]
    fn line_is_read_only_after_its_write_is_done(
        places in prop::collection::vec((0u16..3, 0u16..3), 1..200), depth in 1usize..5, gathering in 1u32..4, posted in 1usize..4,
    ) {
        let mut unit = combiner(CombineMode::Blend, 1 + depth as u32 + gathering + posted as u32, NO_FLAGS);
        let (mut fifo, mut lines, mut writes) = (VecDeque::new(), GatheredLines::default(), VecDeque::new());
        for (column, y) in places {
            let line = u64::from(y * 3 + column);
            for address in combine(&mut unit, [16 * column, y], [9, 9]).1 {
                prop_assert_eq!(address, 64 * line);
                prop_assert!(!fifo.contains(&line) && !lines.contains(line) && !writes.contains(&line), "{}", line);
            }
            fifo.push_back(line);
            if fifo.len() > depth {
                writes.extend(fifo.pop_front().and_then(|line| lines.touch(line, gathering)));
            }
            if writes.len() > posted {
                writes.pop_front();
            }
        }
    }
}
