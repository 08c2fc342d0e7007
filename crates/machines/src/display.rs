//! The display of a machine: clients of the memory with the colour buffers.

use crate::problem::{ConfigProblem, problem};
use basrelief_frame_buffer::DisplayConfig;
use basrelief_kernel::{MemoryConfig, MemorySystem};

/// Swap chain of a machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SwapChain<'a> {
    /// Parameters.
    pub(crate) display: &'a DisplayConfig,
    /// Size of a pixel in memory \[bytes\].
    pub(crate) pixel_bytes: u32,
    /// Clock of the machine \[Hz\].
    pub(crate) hz: u64,
    /// True if the picture shares its only buffer with depth values.
    pub(crate) shared: bool,
}

impl SwapChain<'_> {
    /// Adds the scan-out to a memory. Returns the client of flips, for the unit that finishes frames.
    pub(crate) fn add(&self, m: &mut MemorySystem, memory: usize) -> usize {
        self.add_with_scan_out(m, memory).1
    }

    /// As [`SwapChain::add`]. Also returns the client of the scan-out.
    pub(crate) fn add_with_scan_out(&self, m: &mut MemorySystem, memory: usize) -> (usize, usize) {
        let scan_out = m.add_periodic_client("scan_out", memory, self.display.reads(self.pixel_bytes, self.hz));
        // A frame is drawn, and one is shown. A flip for each other buffer may be under way.
        let credits = if self.shared { 1 } else { self.display.buffers.saturating_sub(1).max(1) };
        let timing = self.display.flips(self.pixel_bytes, self.hz, self.shared);
        (scan_out, m.add_flip_client("flip", scan_out, timing, credits))
    }

    /// Checks that memory `name` can move the reads of the display.
    ///
    /// # Errors
    /// The display takes all of its bandwidth, or more.
    pub(crate) fn check(&self, name: &str, memory: &MemoryConfig) -> Result<(), ConfigProblem> {
        let scan = self.display.scan_out(self.pixel_bytes, self.hz);
        let bursts = u64::from(scan.bytes.div_ceil(memory.burst_bytes.max(1)));
        let cycles = (bursts * u64::from(memory.burst_cycles)).div_ceil(memory.channels.max(1).into());
        if !self.display.enabled || cycles < scan.period {
            return Ok(());
        }
        problem(
            "display.pixel_hz",
            format!(
                "is {}, so memory `{name}` would move {} bytes for the display in every {} cycles, which takes {cycles} cycles; choose a lower pixel_hz, a faster memory, or enabled = false",
                self.display.pixel_hz, scan.bytes, scan.period
            ),
        )
    }
}
