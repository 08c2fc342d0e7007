//! Pixel/depth buffer (124) of the rate-limited renderer in its second function: it stores the picture and shows it.

use crate::config::{PixelBufferConfig, VideoOutConfig};
use crate::state::FinishedFrame;
use crate::unit::FrameDone;
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
    /// True if the last picture of a frame has been shown. The next step reports it.
    pub is_shown: bool,
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
/// Memory without drawn pixels holds old data: depth values, or another picture. The first picture of a frame therefore also
/// writes each block without pixels, all background, in one cycle. Later pictures leave such blocks unchanged.
///
/// Outputs: one to the video output, and one to the server behind the last picture of a frame, because the next frame's depth
/// values overwrite the pixels. In a shared memory nothing overwrites them before the video output has read the picture. The unit
/// stays occupied for that time.
#[derive(Clone, Debug)]
pub struct PixelBuffer {
    /// Parameters.
    pub config: PixelBufferConfig,
    base: u64,
    /// Video output that reads a shared memory while nothing is written, and the clock in cycles per second.
    display: Option<(VideoOutConfig, u64)>,
    /// State between steps.
    pub state: PixelBufferState,
}

type Out = (Option<FrameDone>, Option<()>);

impl PixelBuffer {
    /// Creates a buffer in its power-on state. `shared`: the pixels replace the depth values, this video output reads them, and
    /// the device has a clock of this many cycles per second.
    pub fn new(config: PixelBufferConfig, shared: Option<(VideoOutConfig, u64)>) -> Self {
        let base = if shared.is_some() { layout::Z_BUFFER } else { layout::COLOR_BUFFERS };
        Self { config, base, display: shared, state: PixelBufferState::default() }
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
        if block.mask == 0 && self.state.round > 0 {
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
        traffic.write(0, self.base + number * u64::from(bytes), bytes);
    }

    /// Shows the picture (465, 474). Returns `None` if no frame has begun.
    fn show(&mut self, last: bool) -> Option<FrameDone> {
        let picture = if last { self.state.picture.take() } else { self.state.picture.clone() };
        let picture = picture?;
        let picture = FinishedFrame { round: self.state.round, ..picture };
        let FinishedFrame { index, width, height, .. } = picture;
        if last { &mut self.state.finished } else { &mut self.state.rounds }.push(picture);
        let blocks = u64::from(width.div_ceil(BLOCK)) * u64::from(height.div_ceil(BLOCK));
        self.state.bytes = blocks * u64::from(BLOCK_PIXELS * self.config.pixel_bytes);
        self.state.round += 1;
        self.state.counters.pictures += 1;
        self.state.counters.frames += u64::from(last);
        self.state.is_shown = last;
        Some(FrameDone { index, width, height, address: self.base, bytes: self.state.bytes })
    }

    /// Returns the cycles that the video output takes to read a picture of this size, or 0 if nothing waits for it.
    fn read_cycles(&self, bytes: u64) -> u64 {
        let Some((video, hz)) = self.display.as_ref().filter(|(video, _)| video.enabled) else { return 0 };
        let reads = bytes.div_ceil(u64::from(video.burst_bytes)) * u64::from(video.cycles_per_read);
        let per_second = u128::from(video.pixel_hz) * u128::from(self.config.pixel_bytes);
        let shown = (u128::from(bytes) * u128::from(*hz)).checked_div(per_second).unwrap_or(0);
        reads.max(u64::try_from(shown).unwrap_or(u64::MAX))
    }
}

impl Unit for PixelBuffer {
    basrelief_kernel::unit_info!("keeps the picture where the depth values were, and shows it");
    type In = Option<PictureFlow>;
    type Out = Out;

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.is_shown { Demand::Nothing } else { Demand::All }
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Out> {
        let latency = u64::from(self.config.latency);
        match input {
            Some(PictureFlow::Pixels(block)) => {
                self.write(&block, traffic);
                return Step::over(block.mask.count_ones() as usize, 1, latency, (None, None));
            }
            Some(PictureFlow::Frame(frame)) => self.begin(&frame, traffic),
            Some(PictureFlow::Show { last }) => {
                let Some(done) = self.show(last) else { return Step::after(latency, (None, None)) };
                let kept = match self.read_cycles(done.bytes) {
                    0 => 1,
                    read => latency + read,
                };
                return Step::after(latency, (Some(done), None)).busy(kept).marked();
            }
            None => return Step::after(latency, (None, std::mem::take(&mut self.state.is_shown).then_some(()))),
        }
        Step::after(latency, (None, None))
    }

    fn is_empty(&self) -> bool {
        !self.state.is_shown
    }

    /// Returns one block.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0)
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let c = &self.state.counters;
        let saved = if self.base == layout::Z_BUFFER { self.bytes() } else { 0 };
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
        PixelBuffer::new(PixelBufferConfig::default(), shared.then(|| (VideoOutConfig::default(), 100_000_000)))
    }

    /// Returns addresses and bytes that two pictures of 8 x 4 pixels write. The left block of each is drawn.
    fn writes(shared: bool) -> Vec<(u64, u32)> {
        let mut unit = buffer(shared);
        let frame = frame(8, 4);
        let block = |x, mask| PictureFlow::Pixels(PixelBlock { at: [x, 0], mask, rgb: [[9; 3]; 16] });
        let picture = |last| [block(0, 0x00ff), block(1, 0), PictureFlow::Show { last }];
        let tokens = [frame].into_iter().chain(picture(false)).chain(picture(true));
        let mut all = Vec::new();
        for token in tokens {
            let mut traffic = MemoryPorts::default();
            unit.step(Some(token), &mut traffic);
            assert!(traffic.requests().len() as u32 <= unit.largest_step(0));
            all.extend(traffic.requests().iter().map(|r| (r.address, r.bytes)));
        }
        assert_eq!(unit.state.finished[0].covered.iter().filter(|c| **c).count(), 8);
        all
    }

    // Claim: defer, [0067], [0076]: Video output reads only pixels from a shared memory, and nothing overwrites them meanwhile.
    #[test]
    fn background_is_written_once_per_frame() {
        for (shared, base) in [(true, layout::Z_BUFFER), (false, layout::COLOR_BUFFERS)] {
            let block = u64::from(BLOCK_PIXELS * PixelBufferConfig::default().pixel_bytes);
            let at = |number: u64| (base + number * block, block as u32);
            assert_eq!(writes(shared), [at(0), at(1), at(0)], "all that is shown; then only what may be better");
        }
    }

    fn frame(width: u32, height: u32) -> PictureFlow {
        PictureFlow::Frame(Arc::new(Frame { width, height, ..Frame::default() }))
    }

    // Claim: as background_is_written_once_per_frame.
    #[test]
    fn displayed_pixels_are_not_overwritten() {
        let kept = |shared: bool| {
            let mut unit = buffer(shared);
            let mut step = |token: Option<PictureFlow>| unit.step(token, &mut MemoryPorts::default());
            step(Some(frame(640, 480)));
            let shown = step(Some(PictureFlow::Show { last: true }));
            assert!(shown.out.0.is_some() && shown.out.1.is_none() && shown.marked);
            assert_eq!(step(None).out, (None, Some(())), "then the next frame may come");
            assert!(unit.is_empty() && unit.demand() == Demand::All);
            shown.occupancy
        };
        let latency = u64::from(PixelBufferConfig::default().latency);
        assert_eq!(kept(true), latency + 100_000_000 / 60, "a picture of the display: 1/60 s at 100 MHz");
        assert_eq!(kept(false), 1);
    }
}
