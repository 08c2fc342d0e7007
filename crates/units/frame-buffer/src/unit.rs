//! The unit and its step.

use crate::config::FrameBufferConfig;
use crate::state::{FinishedFrame, FrameBufferState};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use basrelief_signals::{ColorToken, Control, Flow, Frame, LINE_PIXELS, Pixel, Stamp, layout, line_of, lines};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

/// A frame is complete: frame buffer to video output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameDone {
    /// Number of the frame.
    pub index: u32,
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Where it starts in the graphics-data memory (124).
    pub address: u64,
    /// What it takes there, sides rounded up to whole blocks \[bytes\].
    pub bytes: u64,
}

/// Frame buffer (126): takes pixels in order, the last one stays. Client 0 takes posted writes of whole lines: the 16
/// pixels that a token of its kind lies in (4 x 4 for stamps, 16 x 1 for packets), gathered while pixels stay in one line. A frame begins with a clear that moves no data (fast clear, assumed).
#[derive(Clone, Debug)]
pub struct FrameBuffer<T = Stamp<Pixel>> {
    /// Parameters.
    pub config: FrameBufferConfig,
    /// Everything it remembers.
    pub state: FrameBufferState,
    token: PhantomData<fn(T)>,
}

impl<T: ColorToken> Default for FrameBuffer<T> {
    fn default() -> Self {
        Self::new(FrameBufferConfig::default())
    }
}

impl<T: ColorToken> FrameBuffer<T> {
    /// A frame buffer at power-on.
    pub fn new(config: FrameBufferConfig) -> Self {
        Self { config, state: FrameBufferState::default(), token: PhantomData }
    }

    fn begin(&mut self, frame: &Frame, traffic: &mut Traffic) {
        let (index, width, height) = (frame.index, frame.width, frame.height);
        self.state.line = None;
        self.state.picture = None;
        if !layout::fits(width, height) {
            return traffic.fault(format!(
                "frame buffer: frame {index} is {width} x {height} pixels; there is room for {} per side and {} in all, use a smaller size",
                layout::MAX_SIDE,
                layout::MAX_PIXELS
            ));
        }
        let pixels = width as usize * height as usize;
        let (rgb, covered) = (vec![[0; 3]; pixels], vec![false; pixels]);
        self.state.picture = Some(FinishedFrame { index, round: 0, width, height, rgb, covered });
    }

    /// Frames take the two buffers in turn.
    fn base(&self) -> u64 {
        layout::COLOR_BUFFERS + self.state.counters.frames % 2 * layout::COLOR_BUFFER_STRIDE
    }

    #[inline(always)]
    fn write(&mut self, (x, y, color): (u16, u16, [u8; 3]), traffic: &mut Traffic) {
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
        self.gather(Some(line_of::<T>(width, [x, y])), traffic);
    }

    /// Writes the gathered line, if any, and gathers `next`.
    #[inline]
    fn gather(&mut self, next: Option<u64>, traffic: &mut Traffic) {
        if self.state.line == next {
            return;
        }
        if let Some(line) = std::mem::replace(&mut self.state.line, next) {
            let bytes = LINE_PIXELS * self.config.pixel_bytes;
            traffic.write(0, self.base() + line * u64::from(bytes), bytes);
            self.state.counters.lines_written += 1;
        }
    }

    /// The end token; none where no frame has begun.
    fn finish(&mut self, traffic: &mut Traffic) -> Option<FrameDone> {
        self.gather(None, traffic);
        let picture = self.state.picture.take()?;
        let FinishedFrame { index, width, height, .. } = picture;
        let bytes = lines::<T>(width, height) * u64::from(LINE_PIXELS * self.config.pixel_bytes);
        let done = FrameDone { index, width, height, address: self.base(), bytes };
        self.state.finished.push(picture);
        self.state.counters.frames += 1;
        Some(done)
    }
}

impl<T: ColorToken> Unit for FrameBuffer<T> {
    basrelief_kernel::role!("keeps the picture");
    type In = Option<Flow<T>>;
    type Out = Option<FrameDone>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(Flow::Item(token)) => {
                token.each(|x, y, rgb| self.write((x, y, rgb), traffic));
                return Step::over(token.pixels(), 1, latency, None);
            }
            Some(Flow::Control(Control::Frame(frame))) => self.begin(&frame, traffic),
            Some(Flow::Control(Control::FrameEnd)) => {
                let done = self.finish(traffic);
                let step = Step::after(latency, done);
                return if done.is_some() { step.marked() } else { step };
            }
            Some(Flow::Control(_)) | None => {}
        }
        Step::after(latency, None)
    }

    /// One write of a gathered line.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }

    fn tell(&self, facts: &mut Facts) {
        let c = &self.state.counters;
        facts.figure("pixels", c.pixels, "pixels", "Pixels written");
        facts.figure("frames", c.frames, "frames", "Frames finished");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FrameBufferCounters;
    use basrelief_signals::Camera;
    use proptest::prelude::*;
    use std::sync::Arc;

    fn frame(index: u32, width: u32, height: u32) -> Flow<Stamp<Pixel>> {
        let camera = Camera { view_projection: [0.0; 16], to_light: [0.0; 3], to_viewer: [0.0; 3] };
        Flow::Control(Control::Frame(Arc::new(Frame { index, width, height, camera, lights: Vec::new(), textures: Vec::new() })))
    }

    fn pixel(x: u16, y: u16, rgb: [u8; 3]) -> Flow<Stamp<Pixel>> {
        Flow::Item(Stamp::from_iter([Pixel { x, y, z: 0, rgb }]))
    }

    const END: Flow<Stamp<Pixel>> = Flow::Control(Control::FrameEnd);

    /// Address and size of the writes of a step, and what it delivers.
    fn step(unit: &mut FrameBuffer, token: Flow<Stamp<Pixel>>) -> (Vec<(u64, u32)>, Option<FrameDone>) {
        let mut traffic = Traffic::default();
        let step = unit.step(Some(token), &mut traffic);
        assert_eq!(step.marked, step.out.is_some());
        assert!(traffic.requests().len() as u32 <= unit.largest_step(0));
        assert!(traffic.requests().iter().all(|r| r.write && r.client == 0));
        (traffic.requests().iter().map(|r| (r.address, r.bytes)).collect(), step.out)
    }

    #[test]
    fn the_last_pixel_stays_and_the_rest_is_black_and_uncovered() {
        let mut unit = FrameBuffer::<Stamp<Pixel>>::default();
        for token in [frame(3, 5, 2), pixel(4, 1, [1, 2, 3]), pixel(4, 1, [7, 8, 9]), pixel(5, 0, [9; 3]), pixel(0, 2, [9; 3])] {
            step(&mut unit, token);
        }
        let (_, done) = step(&mut unit, END);
        assert_eq!(done, Some(FrameDone { index: 3, width: 5, height: 2, address: 0, bytes: 2 * 64 }));
        let finished = &unit.state.finished;
        assert_eq!(finished.len(), 1);
        assert_eq!(finished[0].rgb.iter().filter(|c| **c != [0; 3]).collect::<Vec<_>>(), [&[7, 8, 9]]);
        assert_eq!(finished[0].covered.iter().position(|c| *c), Some(9));
        assert_eq!(step(&mut unit, END), (vec![], None), "no frame has begun");
    }

    #[test]
    fn a_line_is_written_when_it_is_left_and_frames_take_the_buffers_in_turn() {
        let mut unit = FrameBuffer::<Stamp<Pixel>>::default();
        for base in [0, layout::COLOR_BUFFER_STRIDE, 0] {
            step(&mut unit, frame(0, 16, 8));
            let mut writes = |token| step(&mut unit, token).0;
            assert!(writes(pixel(1, 1, [1; 3])).is_empty());
            assert!(writes(pixel(2, 3, [1; 3])).is_empty());
            assert_eq!(writes(pixel(4, 3, [1; 3])), [(base, 64)]);
            assert_eq!(writes(pixel(4, 4, [1; 3])), [(base + 64, 64)]);
            assert_eq!(writes(END), [(base + 5 * 64, 64)]);
        }
        assert_eq!(unit.state.counters, FrameBufferCounters { frames: 3, pixels: 12, lines_written: 9 });
    }

    #[test]
    fn a_picture_without_room_is_a_fault_and_takes_no_memory() {
        let mut unit = FrameBuffer::<Stamp<Pixel>>::default();
        let mut traffic = Traffic::default();
        unit.step(Some(frame(7, u32::MAX, 2)), &mut traffic);
        assert!(format!("{traffic:?}").contains("frame 7 is 4294967295 x 2 pixels"));
        assert_eq!(step(&mut unit, pixel(0, 0, [1; 3])), (vec![], None));
    }

    proptest! {
        #[test]
        fn every_written_line_holds_a_pixel_and_every_pixel_is_written(
            places in prop::collection::vec((0u16..20, 0u16..11), 0..50),
        ) {
            let mut unit = FrameBuffer::<Stamp<Pixel>>::default();
            step(&mut unit, frame(0, 20, 11));
            let mut written = Vec::new();
            for &(x, y) in &places {
                written.extend(step(&mut unit, pixel(x, y, [1; 3])).0);
            }
            let (last, done) = step(&mut unit, END);
            written.extend(last);
            prop_assert!(written.iter().all(|(a, n)| a + u64::from(*n) <= done.unwrap_or_default().bytes));
            let mut lines: Vec<u64> = written.iter().map(|(a, _)| a / 64).collect();
            let mut expected: Vec<u64> = places.iter().map(|(x, y)| u64::from(y / 4 * 5 + x / 4)).collect();
            expected.dedup();
            prop_assert_eq!(&lines, &expected);
            lines.sort_unstable();
            lines.dedup();
            prop_assert!(lines.len() <= 15);
        }
    }
}
