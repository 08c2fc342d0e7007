//! Video output: reads each finished frame once (law 11).

use crate::config::VideoOutConfig;
use crate::unit::FrameDone;
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, Step, Traffic, Unit};
use serde::{Deserialize, Serialize};

/// What the video output has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VideoOutCounters {
    /// Frames taken.
    pub frames: u64,
    /// Bytes read.
    pub bytes: u64,
}

/// Everything the video output remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct VideoOutState {
    /// Address of the next read.
    pub address: u64,
    /// What is left of the frame \[bytes\].
    pub left: u64,
    /// What it has counted.
    pub counters: VideoOutCounters,
}

/// Video output: reads a frame from its end token on, one read per step, as client 0 of the graphics-data memory (124).
#[derive(Clone, Debug, Default)]
pub struct VideoOut {
    /// Parameters.
    pub config: VideoOutConfig,
    /// Everything it remembers.
    pub state: VideoOutState,
}

impl VideoOut {
    /// A video output at power-on.
    pub fn new(config: VideoOutConfig) -> Self {
        Self { config, state: VideoOutState::default() }
    }
}

impl Unit for VideoOut {
    basrelief_kernel::role!("reads every finished picture once, for the display");
    type In = Option<FrameDone>;
    type Out = ();

    #[inline]
    fn demand(&self) -> Demand {
        if self.state.left > 0 { Demand::Nothing } else { Demand::All }
    }

    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
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
        Step::after(0, ()).busy(u64::from(self.config.cycles_per_read))
    }

    /// One read.
    fn largest_step(&self, client: usize) -> u32 {
        u32::from(client == 0 && self.config.enabled)
    }

    fn is_empty(&self) -> bool {
        self.state.left == 0
    }

    fn tell(&self, facts: &mut Facts) {
        facts.figure("video_out_bytes", self.state.counters.bytes, "bytes", "What was read for the display");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reads(config: VideoOutConfig, bytes: u64) -> (Vec<(u64, u32)>, u64) {
        let mut unit = VideoOut::new(config);
        let mut input = Some(FrameDone { address: 1000, bytes, ..FrameDone::default() });
        let (mut all, mut cycles) = (Vec::new(), 0);
        while input.is_some() || unit.demand() == Demand::Nothing {
            let mut traffic = Traffic::default();
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
    fn each_byte_is_read_once_and_the_last_read_may_be_short() {
        let config = VideoOutConfig { cycles_per_read: 3, ..VideoOutConfig::default() };
        assert_eq!(reads(config, 600), (vec![(1000, 256), (1256, 256), (1512, 88)], 9));
    }

    #[test]
    fn switched_off_it_swallows_frames() {
        let config = VideoOutConfig { enabled: false, ..VideoOutConfig::default() };
        assert_eq!(reads(config, 600), (vec![], 1));
    }

    #[test]
    fn an_empty_frame_is_no_traffic() {
        assert_eq!(reads(VideoOutConfig::default(), 0), (vec![], 1));
    }
}
