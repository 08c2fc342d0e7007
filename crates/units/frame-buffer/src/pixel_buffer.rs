//! Pixel/depth buffer (124) of the rate-limited renderer in its second function: it stores the picture and shows it.

use crate::config::{DisplayConfig, PixelBufferConfig};
use crate::state::FinishedFrame;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use basrelief_signals::{Frame, PictureFlow, PixelBlock, layout};
use serde::{Deserialize, Serialize};

/// Side of a block \[pixels\].
const BLOCK: u32 = 4;
/// Pixels of a block.
const BLOCK_PIXELS: u32 = BLOCK * BLOCK;

/// Counters of the pixel buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelBufferCounters {
    /// Frames whose last picture was shown.
    pub frames: u64,
    /// Pictures shown.
    pub pictures: u64,
    /// Pixels written.
    pub pixels: u64,
}

/// State of the pixel buffer between steps.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelBufferState {
    /// Picture being drawn, if a frame has begun.
    pub picture: Option<FinishedFrame>,
    /// Number of pictures in the current frame so far.
    pub round: u32,
    /// Size of the last picture in memory \[bytes\].
    pub bytes: u64,
    /// Pictures that a better one of the same frame follows, not fetched yet, in order.
    pub rounds: Vec<FinishedFrame>,
    /// Last pictures of their frames, not fetched yet, in order.
    pub finished: Vec<FinishedFrame>,
    /// Counters.
    pub counters: PixelBufferCounters,
}

/// Pixel buffer (124): takes blocks of pixels, and shows the picture when it is complete. In progressive mode this happens
/// several times per frame, and each picture ends a frame in the sense of law 11. Client 0 writes whole blocks of pixels. A block
/// comes once per picture, so no writes are gathered.
///
/// Memory without drawn pixels holds old data: depth values, or another picture. The first picture of a frame in each buffer
/// therefore also writes each block without pixels, all background, in one cycle. Later pictures leave such blocks unchanged.
///
/// Client 1 flips the display to a picture. Its credits are the free buffers of the swap chain. In a shared memory the picture is the
/// only buffer, and the display holds the credit until it has read the picture. So no pixel overwrites the picture before.
///
/// Output: a token to the server behind the last picture of a frame, because the next frame's depth values overwrite the pixels. In a shared
/// memory the z-test then waits for the display.
#[derive(Clone, Debug)]
pub struct PixelBuffer {
    /// Parameters.
    pub config: PixelBufferConfig,
    /// Buffers of the swap chain; `None` if the pixels replace the depth values.
    buffers: Option<u64>,
    /// State between steps.
    pub state: PixelBufferState,
}

impl PixelBuffer {
    /// Creates a buffer in its power-on state. `shared`: the pixels replace the depth values.
    pub fn new(config: PixelBufferConfig, display: &DisplayConfig, shared: bool) -> Self {
        let buffers = (!shared).then_some(display.buffers.into());
        Self { config, buffers, state: PixelBufferState::default() }
    }

    /// Returns the base address. Pictures go through the buffers of the swap chain in turn.
    fn base(&self) -> u64 {
        self.buffers.map_or(layout::Z_BUFFER, |buffers| layout::color_buffer(self.state.counters.pictures % buffers.max(1)))
    }

    /// Returns the size of the last picture in memory \[bytes\].
    pub fn bytes(&self) -> u64 {
        self.state.bytes
    }

    fn begin(&mut self, frame: &Frame, traffic: &mut MemoryPorts) {
        let (index, width, height) = (frame.index, frame.width, frame.height);
        self.state.picture = None;
        self.state.round = 0;
        if !layout::fits(width, height) {
            return traffic.fault(format!(
                "pixel buffer: frame {index} is {width} x {height} pixels; there is room for {} per side and {} in all, use a smaller size",
                layout::MAX_SIDE,
                layout::MAX_PIXELS
            ));
        }
        let pixels = width as usize * height as usize;
        self.state.picture =
            Some(FinishedFrame { index, round: 0, width, height, rgb: vec![[0; 3]; pixels], covered: vec![false; pixels] });
    }

    #[inline]
    fn write(&mut self, block: &PixelBlock, traffic: &mut MemoryPorts) {
        let Some(picture) = &mut self.state.picture else { return };
        if block.mask == 0 && u64::from(self.state.round) >= self.buffers.unwrap_or(1) {
            return;
        }
        let [left, top] = block.at.map(|b| u32::from(b) * BLOCK);
        for (i, rgb) in (0..).zip(&block.rgb).filter(|(i, _)| block.mask & 1 << i != 0) {
            let (x, y) = (left + i % BLOCK, top + i / BLOCK);
            let place = (y * picture.width + x) as usize;
            if x < picture.width && y < picture.height {
                picture.rgb[place] = *rgb;
                picture.covered[place] = true;
            }
        }
        self.state.counters.pixels += u64::from(block.mask.count_ones());
        let number = u64::from(block.at[1]) * u64::from(picture.width.div_ceil(BLOCK)) + u64::from(block.at[0]);
        let bytes = BLOCK_PIXELS * self.config.pixel_bytes;
        traffic.write(0, self.base() + number * u64::from(bytes), bytes);
    }

    /// Shows the picture (465, 474). Returns true if a frame has begun.
    fn show(&mut self, last: bool, traffic: &mut MemoryPorts) -> bool {
        let base = self.base();
        let picture = if last { self.state.picture.take() } else { self.state.picture.clone() };
        let Some(picture) = picture else { return false };
        let picture = FinishedFrame { round: self.state.round, ..picture };
        let FinishedFrame { width, height, .. } = picture;
        if last { &mut self.state.finished } else { &mut self.state.rounds }.push(picture);
        let blocks = u64::from(width.div_ceil(BLOCK)) * u64::from(height.div_ceil(BLOCK));
        self.state.bytes = blocks * u64::from(BLOCK_PIXELS * self.config.pixel_bytes);
        self.state.round += 1;
        self.state.counters.pictures += 1;
        self.state.counters.frames += u64::from(last);
        traffic.write(1, base, 1);
        true
    }
}

impl Unit for PixelBuffer {
    basrelief_kernel::unit_info!("stores the image in place of the depth values, and shows it");
    type In = Option<PictureFlow>;
    type Out = Option<()>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(PictureFlow::Pixels(block)) => {
                self.write(&block, traffic);
                return Step::over(block.mask.count_ones() as usize, 1, latency, None);
            }
            Some(PictureFlow::Frame(frame)) => self.begin(&frame, traffic),
            Some(PictureFlow::Show { last }) => {
                if !self.show(last, traffic) {
                    return Step::after(latency, None);
                }
                return Step::after(latency, last.then_some(())).marked();
            }
            None => {}
        }
        Step::after(latency, None)
    }

    /// Returns one block and one flip.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client < 2)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let c = &self.state.counters;
        let saved = if self.buffers.is_none() { self.bytes() } else { 0 };
        stats.figure("pixels", c.pixels, "pixels", "Pixels written");
        stats.figure("frames", c.frames, "frames", "Frames finished");
        stats.figure("pictures", c.pictures, "pictures", "Pictures shown");
        stats.figure(
            "memory_saved_by_sharing_bytes",
            saved,
            "bytes",
            "Memory that pixels take in place of depth values, where they share one",
        );
        stats.hardware(HardwareKind::Registers, "block of pixels", BLOCK_PIXELS, 8 * self.config.pixel_bytes);
        stats.hardware(HardwareKind::Adder, "address of a block", 2_u32, 32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn buffer(shared: bool) -> PixelBuffer {
        PixelBuffer::new(PixelBufferConfig::default(), &DisplayConfig::default(), shared)
    }

    /// Returns client and address of the requests of three pictures of 8 x 4 pixels. The left block of each is drawn.
    fn requests(shared: bool) -> Vec<(u32, u64)> {
        let mut unit = buffer(shared);
        let frame = PictureFlow::Frame(Arc::new(Frame { width: 8, height: 4, ..Frame::default() }));
        let block = |x, mask| PictureFlow::Pixels(PixelBlock { at: [x, 0], mask, rgb: [[9; 3]; 16] });
        let picture = |last| [block(0, 0x00ff), block(1, 0), PictureFlow::Show { last }];
        let tokens = [frame].into_iter().chain(picture(false)).chain(picture(false)).chain(picture(true));
        let mut all = Vec::new();
        for token in tokens {
            let mut traffic = MemoryPorts::default();
            unit.step(Some(token), &mut traffic);
            assert!(
                (0..2).all(
                    |c| traffic.requests().iter().filter(|r| r.client == c).count() <= unit.largest_step(c as usize) as usize
                )
            );
            assert!(traffic.requests().iter().all(|r| r.write));
            all.extend(traffic.requests().iter().map(|r| (r.client, r.address)));
        }
        assert_eq!(unit.state.finished[0].covered.iter().filter(|c| **c).count(), 8);
        all
    }

    // Claim: defer, [0067], [0076]: Video output reads only pixels from a shared memory, and nothing overwrites them meanwhile.
    #[test]
    fn background_is_written_once_per_frame_and_buffer() {
        let second = |base| (0, base + u64::from(BLOCK_PIXELS * PixelBufferConfig::default().pixel_bytes));
        let picture = |base, whole: bool| [(0, base)].into_iter().chain(whole.then(|| second(base))).chain([(1, base)]);
        let shared = [true, false, false].into_iter().flat_map(|whole| picture(layout::Z_BUFFER, whole));
        assert_eq!(requests(true), shared.collect::<Vec<_>>(), "all that is shown; then only what may be better");
        let [a, b] = [0, 1].map(layout::color_buffer);
        let chain = [(a, true), (b, true), (a, false)].into_iter().flat_map(|(base, whole)| picture(base, whole));
        assert_eq!(requests(false), chain.collect::<Vec<_>>());
    }

    #[test]
    fn last_picture_of_a_frame_is_reported_to_the_server() {
        for shared in [false, true] {
            let mut unit = buffer(shared);
            let mut step = |token| unit.step(Some(token), &mut MemoryPorts::default());
            step(PictureFlow::Frame(Arc::new(Frame { width: 640, height: 480, ..Frame::default() })));
            let [better, last] = [false, true].map(|last| step(PictureFlow::Show { last }));
            assert!(better.out.is_none() && last.out == Some(()) && better.marked && last.marked);
        }
    }
}
