//! The form of a data sheet.

use std::fmt;

/// Data sheet of a channel.
pub(super) struct DataSheet {
    /// Chips and their arrangement.
    pub(super) about: &'static str,
    pub(super) source: &'static str,
    pub(super) rate: SheetRate,
    /// Typical burst of a controller of its time.
    pub(super) burst_bytes: u32,
    pub(super) cl: SheetTime,
    pub(super) cwl: SheetTime,
    pub(super) rcd: SheetTime,
    pub(super) rp: SheetTime,
    pub(super) ras: SheetTime,
    /// Time beyond the burst.
    pub(super) rtp: SheetTime,
    pub(super) wr: SheetTime,
    pub(super) wtr: SheetTime,
    pub(super) rrd: SheetTime,
    pub(super) faw: SheetTime,
    pub(super) refi: SheetTime,
    pub(super) rfc: SheetTime,
    pub(super) banks: u32,
    pub(super) row_bytes: u32,
    /// True if `banks` and `row_bytes` are not in the sheet.
    pub(super) chips_assumed: bool,
    /// True if precharges, activations and column commands share a bus.
    pub(super) has_command_bus: bool,
    /// Bursts that a controller of its time chooses from, and such a controller.
    pub(super) window: u32,
    pub(super) controller: &'static str,
    /// Board parameters that the part implies.
    pub(super) board: &'static [(&'static str, u32)],
}

/// Rate of the data bus of a channel.
pub(super) enum SheetRate {
    /// Bytes per clock of the part; the clock is a ratio \[Hz\].
    Own { bytes: u32, hz: (u64, u64), of: &'static str },
    /// Bytes per cycle of the device, for memory on the device's chip.
    Device { bytes: u32, of: &'static str },
}

#[derive(Clone, Copy)]
pub(super) enum SheetLength {
    Picoseconds(u64),
    /// Clocks of the part.
    Clocks(u32),
    /// Cycles of the device.
    Cycles(u32),
}

/// A time of a sheet.
#[derive(Clone, Copy)]
pub(super) struct SheetTime {
    pub(super) length: SheetLength,
    /// Its name in the sheet.
    pub(super) of: &'static str,
    pub(super) assumed: bool,
}

pub(super) const fn ps(length: u64, of: &'static str) -> SheetTime {
    SheetTime { length: SheetLength::Picoseconds(length), of, assumed: false }
}

pub(super) const fn ns(length: u64, of: &'static str) -> SheetTime {
    ps(1000 * length, of)
}

pub(super) const fn clocks(length: u32, of: &'static str) -> SheetTime {
    SheetTime { length: SheetLength::Clocks(length), of, assumed: false }
}

pub(super) const fn cycles(length: u32, of: &'static str) -> SheetTime {
    SheetTime { length: SheetLength::Cycles(length), of, assumed: false }
}

impl SheetTime {
    /// Marks a time that is not in the sheet.
    pub(super) const fn assumed(self) -> Self {
        Self { assumed: true, ..self }
    }
}

/// A clock rate, for display.
pub(super) struct ClockRate(pub(super) u64);

impl fmt::Display for ClockRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 1_000_000 { write!(f, "{} Hz", self.0) } else { write!(f, "{} MHz", rounded(self.0 as f64 / 1e6)) }
    }
}

/// Rounds to two decimal places.
pub(super) fn rounded(x: f64) -> f64 {
    (100.0 * x).round() / 100.0
}
