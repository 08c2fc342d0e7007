//! The display: scan-out of the front buffer, and flips. Both are requests of law 4, so the display is no unit.

use crate::config::{DisplayConfig, DisplayMode};
use basrelief_kernel::{FlipTiming, PeriodicReads};
use basrelief_signals::layout;

/// Largest refresh \[cycles\]: one hour at 4 GHz.
const MAX_REFRESH: u64 = 1 << 44;

/// Scan-out of a display in a device with a clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanOut {
    /// Reads per refresh, >= 1.
    pub reads: u64,
    /// Cycles from read to read, >= 1.
    pub period: u64,
    /// Bytes of a read.
    pub bytes: u32,
}

impl ScanOut {
    /// Returns the cycles of a refresh. It has whole reads of whole cycles, so it is a little shorter than 1 / `refresh_hz`.
    pub fn refresh(&self) -> u64 {
        self.reads * self.period
    }
}

impl DisplayConfig {
    /// Returns the scan-out of pixels of `pixel_bytes` bytes in a device with a clock of `hz`.
    pub fn scan_out(&self, pixel_bytes: u32, hz: u64) -> ScanOut {
        let (refresh_hz, bytes) = (u64::from(self.refresh_hz.max(1)), self.burst_bytes.max(1));
        let frame_bytes = u64::from(self.pixel_hz).div_ceil(refresh_hz) * u64::from(pixel_bytes);
        let reads = frame_bytes.div_ceil(bytes.into()).max(1);
        let period = (hz / refresh_hz / reads).clamp(1, MAX_REFRESH / reads);
        ScanOut { reads, period, bytes }
    }

    /// Returns the reads of the display. Until the first flip, it reads the last buffer of the swap chain.
    pub fn reads(&self, pixel_bytes: u32, hz: u64) -> PeriodicReads {
        let ScanOut { reads, period, bytes } = self.scan_out(pixel_bytes, hz);
        let base = layout::color_buffer(u64::from(self.buffers) - 1);
        let stride = u64::from(bytes);
        PeriodicReads { period, bytes: if self.enabled { bytes } else { 0 }, base, stride, span: reads * stride }
    }

    /// Returns the times of flips. `shared`: the picture shares its buffer with depth values, so the display reads it for one refresh, and
    /// nothing overwrites it meanwhile.
    pub fn flips(&self, pixel_bytes: u32, hz: u64, shared: bool) -> FlipTiming {
        let refresh = self.scan_out(pixel_bytes, hz).refresh();
        let in_refreshes = self.enabled && self.mode == DisplayMode::Fifo;
        FlipTiming { period: if in_refreshes { refresh } else { 1 }, hold: if self.enabled && shared { refresh } else { 0 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refresh_reads_one_picture_in_its_time() {
        let scan = DisplayConfig::default().scan_out(4, 200_000_000);
        assert_eq!(scan, ScanOut { reads: 640 * 480 * 4 / 256, period: 694, bytes: 256 });
        assert_eq!(scan.refresh(), 3_331_200, "3,333,333 cycles are 1/60 s");
        let slow = DisplayConfig { pixel_hz: 1, refresh_hz: 100, ..DisplayConfig::default() };
        assert_eq!(slow.scan_out(4, 1), ScanOut { reads: 1, period: 1, bytes: 256 });
    }

    #[test]
    fn flips_follow_mode_and_buffer() {
        let flips = |enabled, mode, shared| {
            let FlipTiming { period, hold } =
                DisplayConfig { enabled, mode, ..DisplayConfig::default() }.flips(4, 200_000_000, shared);
            [period, hold]
        };
        assert_eq!(flips(true, DisplayMode::Immediate, false), [1, 0]);
        assert_eq!(flips(true, DisplayMode::Fifo, false), [3_331_200, 0]);
        assert_eq!(flips(true, DisplayMode::Immediate, true), [1, 3_331_200]);
        assert_eq!(flips(false, DisplayMode::Fifo, true), [1, 0]);
    }

    #[test]
    fn disabled_display_reads_nothing() {
        let reads = |enabled| DisplayConfig { enabled, ..DisplayConfig::default() }.reads(4, 200_000_000);
        assert_eq!((reads(true).bytes, reads(false).bytes), (256, 0));
        assert_eq!(reads(true).base, layout::color_buffer(1), "the first frame is drawn in buffer 0");
    }
}
