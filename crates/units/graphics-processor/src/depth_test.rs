//! Z-test, with the z-buffer in the graphics-data memory (124).

use crate::config::DepthConfig;
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::{Control, DepthToken, Flow, Frame, LINE_PIXELS, layout, line_of};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

/// What the z-test has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DepthTestCounters {
    /// Fragments tested.
    pub tested: u64,
    /// Fragments that were in front.
    pub passed: u64,
    /// Lines written.
    pub lines_written: u64,
}

/// Everything the z-test remembers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DepthTestState {
    /// Width of the frame \[pixels\].
    pub width: u32,
    /// The z-buffer, row by row.
    pub z: Vec<u32>,
    /// Number of the line that gathers writes.
    pub line: Option<u64>,
    /// What it has counted.
    pub counters: DepthTestCounters,
}

/// Emits what lies in front of everything before it (less-than test, in order), and keeps the z-buffer.
///
/// It owns the z values: it tests *and* updates them, wherever it stands - behind the rasterizer (early z) or in front
/// of the frame buffer (law 6). Client 0 is the z-cache, client 1 takes posted writes of whole lines of 16 pixels,
/// gathered while fragments stay in one line. A frame begins with a clear that moves no data (fast clear, assumed).
#[derive(Clone, Debug, Default)]
pub struct DepthTest<T> {
    /// Parameters.
    pub config: DepthConfig,
    /// Width of a z value \[bits\]; kept in 2 bytes up to 16 bits, else in 4.
    pub z_bits: u32,
    /// A line of the z-cache \[bytes\].
    pub line_bytes: u32,
    /// Everything it remembers.
    pub state: DepthTestState,
    token: PhantomData<fn(T) -> T>,
}

impl<T: DepthToken> DepthTest<T> {
    /// A z-test at power-on; `z_bits` (1..=32) is the rasterizer's, `line_bytes` the z-cache's.
    pub fn new(config: DepthConfig, z_bits: u32, line_bytes: u32) -> Self {
        Self { config, z_bits, line_bytes, state: DepthTestState::default(), token: PhantomData }
    }

    fn z_bytes(&self) -> u32 {
        if self.z_bits <= 16 { 2 } else { 4 }
    }

    fn begin(&mut self, frame: &Frame) {
        // A picture without room is the frame buffer's to report.
        let room = if layout::fits(frame.width, frame.height) { [frame.width, frame.height] } else { [0, 0] };
        self.state.width = room[0];
        self.state.line = None;
        self.state.z.clear();
        self.state.z.resize(room[0] as usize * room[1] as usize, u32::MAX >> (32 - self.z_bits.clamp(1, 32)));
    }

    /// Writes the gathered line, if any, and gathers `next`.
    #[inline]
    fn gather(&mut self, next: Option<u64>, traffic: &mut Traffic) {
        if self.state.line == next {
            return;
        }
        if let Some(line) = std::mem::replace(&mut self.state.line, next) {
            let bytes = LINE_PIXELS * self.z_bytes();
            traffic.write(1, layout::Z_BUFFER + line * u64::from(bytes), bytes);
            self.state.counters.lines_written += 1;
        }
    }

    #[inline(always)]
    fn passes(&mut self, (x, y, z): (u16, u16, u32), traffic: &mut Traffic) -> bool {
        let (x, y, bytes) = (u32::from(x), u32::from(y), self.z_bytes());
        if x >= self.state.width {
            return false;
        }
        let Some(nearest) = self.state.z.get_mut(y as usize * self.state.width as usize + x as usize) else {
            return false;
        };
        let line = line_of::<T>(self.state.width, [x, y]);
        let [columns, rows] = T::LINE;
        let offset = line * u64::from(LINE_PIXELS) + u64::from(y % rows * columns + x % columns);
        traffic.look_up(0, layout::Z_BUFFER + offset * u64::from(bytes), bytes);
        self.state.counters.tested += 1;
        if z >= *nearest {
            return false;
        }
        *nearest = z;
        self.state.counters.passed += 1;
        self.gather(Some(line), traffic);
        true
    }
}

impl<T: DepthToken> Unit for DepthTest<T> {
    basrelief_kernel::role!("z-test: removes hidden surfaces; owns the depth values");
    type In = Option<Flow<T>>;
    type Out = Option<Flow<T>>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(mut token)) => {
                let tested = token.pixels();
                let any = token.retain(|x, y, z| self.passes((x, y, z), traffic));
                Step::over(tested, 1, latency, (any || T::KEPT_WHEN_EMPTY).then_some(Flow::Item(token)))
            }
            Some(Flow::Control(control)) => {
                match &control {
                    Control::Frame(frame) => self.begin(frame),
                    Control::FrameEnd => self.gather(None, traffic),
                    Control::Object(_) | Control::Polygon(_) | Control::CodeBook(_) => {}
                }
                Step::after(latency, Some(Flow::Control(control)))
            }
            None => Step::after(latency, None),
        }
    }

    /// Lines of the z-cache that the pixels of a token can lie in; one write of the line gathered before.
    fn largest_step(&self, client: usize) -> u32 {
        match client {
            0 => (LINE_PIXELS * self.z_bytes()).div_ceil(self.line_bytes.max(1)).min(T::MOST_PIXELS),
            1 => 1,
            _ => 0,
        }
    }

    fn tell(&self, facts: &mut Facts) {
        facts.rate(0, self.config.latency, 1_u64);
        let c = &self.state.counters;
        facts.figure("z_tested", c.tested, "fragments", "Fragments tested for depth");
        facts.figure("z_passed", c.passed, "fragments", "Those in front");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{Camera, Fragment, Stamp};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn frame(width: u32, height: u32) -> Control {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0; 3], to_viewer: [0.0; 3] };
        Control::Frame(Arc::new(Frame { index: 0, width, height, camera, lights: Vec::new(), textures: Vec::new() }))
    }

    fn unit(z_bits: u32) -> DepthTest<Stamp<Fragment>> {
        let mut unit = DepthTest::new(DepthConfig::default(), z_bits, 64);
        unit.step(Some(Flow::Control(frame(16, 8))), &mut Traffic::default());
        unit
    }

    fn fragment(x: u16, y: u16, z: u32) -> Flow<Stamp<Fragment>> {
        Flow::Item(Stamp::from_iter([Fragment { x, y, z, ..Fragment::default() }]))
    }

    #[test]
    fn only_the_nearer_passes_and_equal_depth_does_not() {
        let mut unit = unit(24);
        let mut passes = |z| unit.step(Some(fragment(3, 2, z)), &mut Traffic::default()).out.is_some();
        assert_eq!([50, 50, 60, 49, 0, 0].map(&mut passes), [true, false, false, true, true, false]);
        assert_eq!((unit.state.counters.tested, unit.state.counters.passed), (6, 3));
        unit.step(Some(Flow::Control(frame(16, 8))), &mut Traffic::default());
        assert!(unit.step(Some(fragment(3, 2, 60)), &mut Traffic::default()).out.is_some());
    }

    #[test]
    fn the_far_plane_is_not_in_front_of_a_clear_buffer() {
        for bits in [16, 24, 32] {
            let far = u32::MAX >> (32 - bits);
            let mut unit = unit(bits);
            assert!(unit.step(Some(fragment(0, 0, far)), &mut Traffic::default()).out.is_none());
            assert!(unit.step(Some(fragment(0, 0, far - 1)), &mut Traffic::default()).out.is_some());
        }
    }

    #[test]
    fn a_line_is_written_once_it_is_left_and_at_the_end() {
        let mut unit = unit(24);
        let mut writes = |token| {
            let mut traffic = Traffic::default();
            unit.step(Some(token), &mut traffic);
            traffic.requests().iter().map(|r| (r.client, r.write, r.address - layout::Z_BUFFER, r.bytes)).collect::<Vec<_>>()
        };
        assert!(writes(fragment(0, 0, 5)).is_empty());
        assert!(writes(fragment(3, 3, 5)).is_empty());
        assert_eq!(writes(fragment(4, 0, 5)), [(1, true, 0, 64)]);
        assert!(writes(fragment(0, 0, 9)).is_empty(), "hidden");
        assert_eq!(writes(fragment(0, 4, 5)), [(1, true, 64, 64)]);
        assert_eq!(writes(Flow::Control(Control::FrameEnd)), [(1, true, 4 * 64, 64)]);
        assert!(writes(Flow::Control(Control::FrameEnd)).is_empty());
    }

    #[test]
    fn the_z_value_is_looked_up_whether_or_not_it_passes() {
        for (bits, bytes) in [(16, 2), (24, 4), (32, 4)] {
            let mut unit = unit(bits);
            for z in [9, 10] {
                let mut traffic = Traffic::default();
                unit.step(Some(fragment(5, 1, z)), &mut traffic);
                let all: Vec<_> = traffic.look_ups().iter().map(|r| (r.client, r.address, r.bytes)).collect();
                assert_eq!(all, [(0, layout::Z_BUFFER + (16 + 5) * u64::from(bytes), bytes)]);
            }
        }
    }

    #[test]
    fn outside_the_frame_nothing_passes() {
        let mut unit = unit(24);
        for (x, y) in [(16, 0), (0, 8), (u16::MAX, u16::MAX)] {
            assert!(unit.step(Some(fragment(x, y, 0)), &mut Traffic::default()).out.is_none());
        }
        unit.step(Some(Flow::Control(frame(u32::MAX, u32::MAX))), &mut Traffic::default());
        assert!(unit.step(Some(fragment(0, 0, 0)), &mut Traffic::default()).out.is_none());
    }

    proptest! {
        #[test]
        fn what_passes_last_at_a_pixel_is_the_first_of_the_nearest(depths in prop::collection::vec((0u16..4, 0u32..6), 1..60)) {
            let mut unit = unit(16);
            let mut last = [None; 4];
            for (i, &(x, z)) in depths.iter().enumerate() {
                if unit.step(Some(fragment(x, 0, z)), &mut Traffic::default()).out.is_some() {
                    last[usize::from(x)] = Some(i);
                }
            }
            for x in 0..4u16 {
                let here = depths.iter().enumerate().filter(|(_, d)| d.0 == x);
                prop_assert_eq!(last[usize::from(x)], here.min_by_key(|(i, d)| (d.1, *i)).map(|(i, _)| i));
            }
        }
    }
}
