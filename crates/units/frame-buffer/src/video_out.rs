//! Video output: reads each finished frame once (law 11), at the pace of a display.
//!
//! Frames that finish faster than the display shows them wait, and drawing continues. During drawing the display thus takes the
//! memory bandwidth of a real one. Frames that a real display would have skipped are read at the end.

use crate::config::VideoOutConfig;
use crate::unit::FrameDone;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use serde::{Deserialize, Serialize};

/// Counters of the video output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VideoOutCounters {
    /// Frames received.
    pub frames: u64,
    /// Bytes read.
    pub bytes: u64,
}

/// State of the video output between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VideoOutState {
    /// Address of the next read.
    pub address: u64,
    /// Remaining bytes of the frame.
    pub left: u64,
    /// Fraction of a cycle left by the last read \[byte cycles per second\].
    pub left_of_cycle: u64,
    /// Counters.
    pub counters: VideoOutCounters,
}

/// Video output: reads a frame from its end token on, one read per step, as client 0 of the graphics-data memory (124).
#[derive(Clone, Debug, Default)]
pub struct VideoOut {
    /// Parameters.
    pub config: VideoOutConfig,
    /// Rate of the display \[bytes/s\]. 0 means no limit.
    bytes_per_second: u64,
    hz: u64,
    /// State between steps.
    pub state: VideoOutState,
}

impl VideoOut {
    /// Creates a video output in its power-on state, with pixels of `pixel_bytes` bytes, in a device with a clock of `hz`.
    pub fn new(config: VideoOutConfig, pixel_bytes: u32, hz: u64) -> Self {
        let bytes_per_second = u64::from(config.pixel_hz) * u64::from(pixel_bytes);
        Self { config, bytes_per_second, hz, state: VideoOutState::default() }
    }

    /// Returns the cycles that the display takes for this many bytes. The fraction of a cycle carries over.
    fn display(&mut self, bytes: u32) -> u64 {
        if self.bytes_per_second == 0 {
            return 0;
        }
        let left = self.state.left_of_cycle + u64::from(bytes) * self.hz;
        self.state.left_of_cycle = left % self.bytes_per_second;
        left / self.bytes_per_second
    }
}

impl Unit for VideoOut {
    basrelief_kernel::unit_info!("reads every finished picture once, for the display");
    type In = Option<FrameDone>;
    type Out = ();

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.left > 0 { Demand::Nothing } else { Demand::All }
    }

    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        if let Some(frame) = input {
            self.state.address = frame.address;
            self.state.left = if self.config.enabled { frame.bytes } else { 0 };
            self.state.counters.frames += 1;
        }
        let bytes = u32::try_from(self.state.left).unwrap_or(u32::MAX).min(self.config.burst_bytes);
        if bytes == 0 {
            return Step::after(0, ());
        }
        traffic.read(0, self.state.address, bytes);
        self.state.address += u64::from(bytes);
        self.state.left -= u64::from(bytes);
        self.state.counters.bytes += u64::from(bytes);
        let cycles = self.display(bytes).max(u64::from(self.config.cycles_per_read));
        Step::after(0, ()).busy(cycles)
    }

    /// Returns one read.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0 && self.config.enabled)
    }

    fn is_empty(&self) -> bool {
        self.state.left == 0
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.figure("video_out_bytes", self.state.counters.bytes, "bytes", "What was read for the display");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reads(config: VideoOutConfig, bytes: u64) -> (Vec<(u64, u32)>, u64) {
        let mut unit = VideoOut::new(config, 4, 200_000_000);
        let mut input = Some(FrameDone { address: 1000, bytes, ..FrameDone::default() });
        let (mut all, mut cycles) = (Vec::new(), 0);
        while input.is_some() || unit.demand() == Demand::Nothing {
            let mut traffic = MemoryPorts::default();
            cycles += unit.step(input.take(), &mut traffic).occupancy;
            assert!(traffic.requests().len() as u32 <= unit.largest_step(0));
            assert!(traffic.requests().iter().all(|r| !r.write));
            all.extend(traffic.requests().iter().map(|r| (r.address, r.bytes)));
        }
        assert!(unit.is_empty());
        assert_eq!(unit.state.counters.bytes, all.iter().map(|(_, n)| u64::from(*n)).sum::<u64>());
        (all, cycles)
    }

    #[test]
    fn each_byte_is_read_once_with_short_last_read() {
        let config = VideoOutConfig { cycles_per_read: 3, pixel_hz: 0, ..VideoOutConfig::default() };
        assert_eq!(reads(config, 600), (vec![(1000, 256), (1256, 256), (1512, 88)], 9));
    }

    #[test]
    fn frame_takes_display_time() {
        // 640 x 480 pixels, 60 times a second: 200 MHz / 60 cycles.
        assert_eq!(reads(VideoOutConfig::default(), 640 * 480 * 4).1, 3_333_333);
        // 150 pixels in three reads. The fraction of a cycle carries over.
        let per_second = |pixel_hz| reads(VideoOutConfig { pixel_hz, ..VideoOutConfig::default() }, 600).1;
        assert_eq!([per_second(200_000_000), per_second(70_000_000), per_second(0)], [150, 428, 3]);
    }

    #[test]
    fn disabled_video_output_reads_nothing() {
        let config = VideoOutConfig { enabled: false, ..VideoOutConfig::default() };
        assert_eq!(reads(config, 600), (vec![], 1));
    }

    #[test]
    fn empty_frame_causes_no_traffic() {
        assert_eq!(reads(VideoOutConfig::default(), 0), (vec![], 1));
    }
}
