use super::*;
use basrelief_signals::{Fragment, Stamp};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

type Early = DepthTest<Stamp<Fragment>>;

/// Width and height of the frame.
const SIZE: [u32; 2] = [16, 8];
/// Configuration without flags, and with one gathered line.
const PLAIN: DepthConfig =
    DepthConfig { write_lines: 1, clear_flags: false, flags: 131_072, flags_per_cycle: 64, flag_latency: 0 };

fn frame(width: u32, height: u32) -> Control {
    Control::Frame(Arc::new(Frame { width, height, ..Frame::default() }))
}

fn configured(config: DepthConfig, z_bits: u32, line_bytes: u32) -> Early {
    let mut unit = DepthTest::new(config, &Operators::default(), z_bits, line_bytes);
    begin(&mut unit);
    unit
}

/// Begins a frame. Returns the occupancy of its first step, and the numbers of the lines that are cleared by writes.
fn begin(unit: &mut Early) -> (u64, Vec<u64>) {
    let occupancy = unit.step(Some(Flow::Control(frame(SIZE[0], SIZE[1]))), &mut MemoryPorts::default()).occupancy;
    let mut cleared = Vec::new();
    while unit.demand() == Demand::Nothing {
        let mut traffic = MemoryPorts::default();
        assert!(unit.step(None, &mut traffic).out.is_none());
        let line = u64::from(unit.z_line_bytes());
        cleared.extend(traffic.requests().iter().filter(|r| r.client == 1).map(|r| (r.address - layout::Z_BUFFER) / line));
    }
    (occupancy, cleared)
}

// Claim: images, memory: Depth is cleared by flags or by writes, and both take time.
#[test]
fn lines_without_flags_are_cleared_by_writes() {
    let cleared = |config| begin(&mut DepthTest::new(config, &Operators::default(), 24, 64));
    let flags = |flags, flags_per_cycle| DepthConfig { flags, flags_per_cycle, ..DepthConfig::default() };
    assert_eq!(cleared(flags(8, 64)), (1, vec![]));
    assert_eq!(cleared(flags(8, 3)), (3, vec![]));
    assert_eq!(cleared(flags(6, 64)), (1, vec![6, 7]));
    assert_eq!(cleared(PLAIN), (1, (0..8).collect()), "all 8 lines");
}

#[test]
fn look_up_of_a_flag_delays_the_depth_value() {
    let delays = |clear_flags, flag_latency| {
        let mut unit = configured(DepthConfig { clear_flags, flag_latency, ..DepthConfig::default() }, 24, 64);
        let step = unit.step(Some(fragment(3, 1, 5)), &mut MemoryPorts::default());
        (step.latency, step.after_data)
    };
    assert_eq!([delays(true, 0), delays(true, 3), delays(false, 3)], [(1, 1), (4, 4), (1, 1)]);
}

#[test]
fn whole_depth_buffer_is_cleared_without_flags() {
    let mut unit = Early::new(PLAIN, &Operators::default(), 24, 64);
    unit.step(Some(Flow::Control(frame(640, 480))), &mut MemoryPorts::default());
    let mut bytes = 0;
    while unit.demand() == Demand::Nothing {
        let mut traffic = MemoryPorts::default();
        unit.step(None, &mut traffic);
        bytes += traffic.requests().iter().map(|r| r.bytes).sum::<u32>();
    }
    assert_eq!(bytes, 1_228_800);
    assert_eq!(unit.state.counters.lines_cleared, 19_200);
}

fn unit(z_bits: u32) -> Early {
    configured(DepthConfig::default(), z_bits, 64)
}

fn fragment(x: u16, y: u16, z: u32) -> Flow<Stamp<Fragment>> {
    Flow::Item(Stamp::from_iter([Fragment { x, y, z, ..Fragment::default() }]))
}

const END: Flow<Stamp<Fragment>> = Flow::Control(Control::FrameEnd);

/// Result of a step: its output, numbers of the lines written, addresses and bytes looked up, relative to the z-buffer.
struct Stepped {
    out: Option<Flow<Stamp<Fragment>>>,
    written: Vec<u64>,
    looked_up: Vec<(u64, u32)>,
}

/// Makes a step with z values of 4 bytes.
fn step(unit: &mut Early, input: Option<Flow<Stamp<Fragment>>>) -> Stepped {
    assert_eq!(unit.demand(), if input.is_some() { Demand::All } else { Demand::Nothing });
    let mut traffic = MemoryPorts::default();
    let out = unit.step(input, &mut traffic).out;
    assert!(traffic.requests().iter().all(|r| (r.client, r.write, r.bytes) == (1, true, 64)));
    assert!(traffic.requests().len() <= unit.largest_step(1) as usize);
    assert!(traffic.look_ups().iter().all(|r| r.client == 0));
    let written = traffic.requests().iter().map(|r| (r.address - layout::Z_BUFFER) / 64).collect();
    let looked_up = traffic.look_ups().iter().map(|r| (r.address - layout::Z_BUFFER, r.bytes)).collect();
    Stepped { out, written, looked_up }
}

/// Returns the lines written from the end token on, one per step. The token travels on with the last.
fn end(unit: &mut Early) -> Vec<u64> {
    let mut all = Vec::new();
    let mut input = Some(END);
    loop {
        let Stepped { out, written, .. } = step(unit, input.take());
        all.extend(written);
        assert_eq!(out.is_none(), !unit.is_empty());
        if let Some(token) = out {
            assert!(matches!(token, END));
            return all;
        }
    }
}

#[test]
fn nearer_depth_passes_and_equal_depth_fails() {
    let mut unit = unit(24);
    let mut passes = |z| step(&mut unit, Some(fragment(3, 2, z))).out.is_some();
    assert_eq!([50, 50, 60, 49, 0, 0].map(&mut passes), [true, false, false, true, true, false]);
    assert_eq!((unit.state.counters.tested, unit.state.counters.passed), (6, 3));
    step(&mut unit, Some(Flow::Control(frame(16, 8))));
    assert!(step(&mut unit, Some(fragment(3, 2, 60))).out.is_some());
}

#[test]
fn far_plane_fails_against_clear_buffer() {
    for bits in [16, 24, 32] {
        let far = u32::MAX >> (32 - bits);
        let mut unit = unit(bits);
        assert!(step(&mut unit, Some(fragment(0, 0, far))).out.is_none());
        assert!(step(&mut unit, Some(fragment(0, 0, far - 1))).out.is_some());
    }
}

#[test]
fn one_gathered_line_is_written_on_leaving_and_at_end() {
    let mut unit = configured(PLAIN, 24, 64);
    let mut writes = |x, y, z| step(&mut unit, Some(fragment(x, y, z))).written;
    assert!(writes(0, 0, 5).is_empty());
    assert!(writes(3, 3, 5).is_empty());
    assert_eq!(writes(4, 0, 5), [0]);
    assert!(writes(0, 0, 9).is_empty(), "hidden");
    assert_eq!(writes(0, 4, 5), [1]);
    assert_eq!(end(&mut unit), [4]);
    assert!(end(&mut unit).is_empty(), "nothing is gathered");
    // 8 lines were cleared.
    assert_eq!(unit.state.counters.lines_written, 8 + 3);
}

#[test]
fn eviction_is_lru_and_frame_end_writes_all() {
    let mut unit = configured(DepthConfig { write_lines: 3, ..DepthConfig::default() }, 24, 64);
    let mut writes = |line: u16, z| step(&mut unit, Some(fragment(4 * (line % 4), 4 * (line / 4), z))).written;
    for line in [0, 1, 2] {
        assert!(writes(line, 50).is_empty());
    }
    assert!(writes(0, 40).is_empty(), "it is gathered still, and the most recently written now");
    assert!(writes(3, 60).len() == 1 && writes(1, 50).is_empty(), "hidden, and so not written");
    assert_eq!(writes(4, 50), [2]);
    assert_eq!(end(&mut unit), [0, 3, 4]);
}

#[test]
fn z_is_looked_up_unless_line_is_clear_or_gathered() {
    for (bits, bytes) in [(16, 2), (24, 4), (32, 4)] {
        for clear_flags in [false, true] {
            let mut unit = configured(DepthConfig { clear_flags, write_lines: 1, ..PLAIN }, bits, 64);
            let mut looked_up = |x, z| {
                let mut traffic = MemoryPorts::default();
                unit.step(Some(fragment(x, 1, z)), &mut traffic);
                let from = |r: &basrelief_kernel::Request| (r.address - layout::Z_BUFFER, r.bytes);
                traffic.look_ups().iter().map(from).collect::<Vec<_>>()
            };
            // Pixel 5 of line 1, and pixel 4 of line 0.
            let (line_1, line_0) = ([(16 * u64::from(bytes), 16 * bytes)], [(4 * u64::from(bytes), bytes)]);
            assert_eq!(looked_up(5, u32::MAX).is_empty(), clear_flags, "hidden by the far plane");
            let first = looked_up(5, 9);
            assert!(if clear_flags { first.is_empty() } else { first == line_1 });
            assert!(looked_up(5, 8).is_empty() && looked_up(6, 10).is_empty(), "gathered");
            assert_eq!(looked_up(0, 5), if clear_flags { vec![] } else { vec![(0, 16 * bytes)] });
            assert_eq!(looked_up(5, 7), line_1, "it was written, and nobody gathers it");
            assert_eq!(looked_up(0, 6), line_0, "of a hidden one, no more than its own");
            let c = unit.state.counters;
            assert_eq!((c.tested, c.clear, c.gathered), (7, if clear_flags { 3 } else { 0 }, 2));
            assert_eq!(c.most_flags, if clear_flags { 8 } else { 0 });
        }
    }
}

#[test]
fn new_gathered_line_is_read_whole() {
    for line_bytes in [4, 16, 32, 64, 256] {
        let mut unit = configured(PLAIN, 24, line_bytes);
        let stamp = |z: [u32; 4]| {
            let at = |(x, z): (u16, u32)| Fragment { x, y: 3, z, ..Fragment::default() };
            Some(Flow::Item(Stamp::from_iter((0..).zip(z).map(at))))
        };
        let lines = |stepped: Stepped| -> BTreeSet<u64> {
            let of = |&(from, bytes): &(u64, u32)| {
                from / u64::from(line_bytes)..(from + u64::from(bytes)).div_ceil(u64::from(line_bytes))
            };
            stepped.looked_up.iter().flat_map(of).collect()
        };
        let hidden = lines(step(&mut unit, stamp([u32::MAX; 4])));
        assert_eq!(hidden.len() as u32, 16_u32.div_ceil(line_bytes), "four pixels of a row");
        let written = lines(step(&mut unit, stamp([u32::MAX, 7, u32::MAX, 6])));
        assert_eq!(written.len() as u32, 64_u32.div_ceil(line_bytes));
        assert_eq!(written.len() as u32, unit.largest_step(0));
        assert!(lines(step(&mut unit, stamp([5; 4]))).is_empty());
    }
}

#[test]
fn fragment_outside_frame_fails() {
    let mut unit = unit(24);
    for (x, y) in [(16, 0), (0, 8), (u16::MAX, u16::MAX)] {
        assert!(step(&mut unit, Some(fragment(x, y, 0))).out.is_none());
    }
    step(&mut unit, Some(Flow::Control(frame(u32::MAX, u32::MAX))));
    assert!(step(&mut unit, Some(fragment(0, 0, 0))).out.is_none());
}

/// Stamps: the block, and its pixels with their depth.
type Stamps = Vec<([u16; 2], Vec<(u16, u32)>)>;

fn stamps() -> impl Strategy<Value = Stamps> {
    let pixels = prop::collection::vec((0u16..16, 0u32..9), 1..=4);
    prop::collection::vec(([0u16..4, 0u16..2], pixels), 0..80)
}

fn tokens(stamps: &Stamps) -> impl Iterator<Item = Stamp<Fragment>> {
    stamps.iter().map(|([column, row], pixels)| {
        let at = |&(i, z)| Fragment { x: 4 * column + i % 4, y: 4 * row + i / 4, z, ..Fragment::default() };
        pixels.iter().map(at).collect()
    })
}

fn line(f: &Fragment) -> u64 {
    line_of::<Stamp<Fragment>>(SIZE[0], [f.x.into(), f.y.into()])
}

#[test]
fn comparison_of_integers_begins_with_the_stored_depth() {
    let operators = Operators {
        add: basrelief_kernel::OperatorConfig::new(9, 1),
        integer_add: basrelief_kernel::OperatorConfig::new(5, 1),
        ..Operators::default()
    };
    let mut unit: Early = DepthTest::new(PLAIN, &operators, 24, 64);
    unit.step(Some(Flow::Control(frame(16, 8))), &mut MemoryPorts::default());
    let step = unit.step(Some(fragment(1, 1, 7)), &mut MemoryPorts::default());
    assert_eq!((step.after_data, step.latency), (5, 5));
}

proptest! {
    #[test]
    fn last_passing_fragment_is_first_of_the_nearest(depths in prop::collection::vec((0u16..4, 0u32..6), 1..60)) {
        let mut unit = unit(16);
        let mut last = [None; 4];
        for (i, &(x, z)) in depths.iter().enumerate() {
            if unit.step(Some(fragment(x, 0, z)), &mut MemoryPorts::default()).out.is_some() {
                last[usize::from(x)] = Some(i);
            }
        }
        for x in 0..4u16 {
            let here = depths.iter().enumerate().filter(|(_, d)| d.0 == x);
            prop_assert_eq!(last[usize::from(x)], here.min_by_key(|(i, d)| (d.1, *i)).map(|(i, _)| i));
        }
    }

    #[test]
    fn lines_are_read_if_stale_and_written_after_last_write(
        stamps in stamps(), write_lines in 1u32..10, clear_flags: bool,
    ) {
        let mut plain = configured(PLAIN, 24, 64);
        let mut unit = configured(DepthConfig { write_lines, clear_flags, ..PLAIN }, 24, 64);
        // Lines with data newer than memory, and lines that were ever written.
        let (mut ahead, mut touched) = (BTreeSet::new(), BTreeSet::new());
        for stamp in tokens(&stamps) {
            let of_stamp = line(&stamp[0]);
            let known = ahead.contains(&of_stamp) || clear_flags && !touched.contains(&of_stamp);
            let Stepped { out, written, looked_up } = step(&mut unit, Some(Flow::Item(stamp.clone())));
            prop_assert_eq!(looked_up.is_empty(), known);
            prop_assert!(looked_up.iter().all(|(from, _)| from / 64 == of_stamp));
            prop_assert_eq!(&out, &step(&mut plain, Some(Flow::Item(stamp))).out, "what passes");
            if out.is_some() {
                ahead.insert(of_stamp);
                touched.insert(of_stamp);
            }
            prop_assert!(written.iter().all(|gone| *gone != of_stamp && ahead.remove(gone)));
            prop_assert!(ahead.len() <= write_lines as usize);
        }
        prop_assert_eq!(BTreeSet::from_iter(end(&mut unit)), ahead);
        end(&mut plain);
        let drawn = |unit: &Early| unit.state.counters.lines_written - unit.state.counters.lines_cleared;
        prop_assert!(drawn(&unit) <= drawn(&plain));
    }

    #[test]
    fn one_gathered_line_writes_on_every_line_change(stamps in stamps()) {
        let mut unit = configured(PLAIN, 24, 64);
        let (mut written, mut expected) = (Vec::new(), Vec::new());
        for stamp in tokens(&stamps) {
            let of_stamp = line(&stamp[0]);
            let stepped = step(&mut unit, Some(Flow::Item(stamp)));
            written.extend(stepped.written);
            expected.extend(stepped.out.map(|_| of_stamp));
        }
        expected.dedup();
        written.extend(end(&mut unit));
        prop_assert_eq!(written, expected);
    }
}

#[test]
fn lines_beyond_last_flag_are_read() {
    // 16 x 8 pixels are 8 lines.
    let read = |flags| {
        let mut unit = configured(DepthConfig { flags, ..DepthConfig::default() }, 24, 64);
        let looked_up = |y| !step(&mut unit, Some(fragment(15, y, 9))).looked_up.is_empty();
        [0, 7].map(looked_up)
    };
    assert_eq!([read(8), read(7), read(3)], [[false, false], [false, true], [true, true]]);
}

#[test]
fn unit_reports_comparator_gathered_lines_and_flags() {
    use basrelief_kernel::HardwareKind::{Adder, Table};
    let told = |config| {
        let mut facts = UnitStats::default();
        Early::new(config, &Operators::default(), 24, 64).report_stats(&mut facts);
        facts.all_hardware().iter().map(|h| (h.kind, h.count, h.width, h.ports)).collect::<Vec<_>>()
    };
    let (comparison, lines, search) = ((Adder, 1, 24, 1), (Table, 8, 16 * 25 + 20, 1), (Adder, 8, 20, 1));
    assert_eq!(told(DepthConfig::default()), [comparison, lines, search, (Table, 131_072 / 64, 64, 2)]);
    assert_eq!(told(DepthConfig { clear_flags: false, ..DepthConfig::default() }), [comparison, lines, search]);
}
