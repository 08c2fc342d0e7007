//! Memory numbers of a part.

use super::part::MemoryPart;
use super::sheet::{ClockRate, DataSheet, SheetLength, SheetRate, SheetTime, rounded};
use crate::MemoryConfig;
use basrelief_parameters::{Parameters, Provenance};
use std::fmt;

/// A memory number of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartNumber {
    /// Name of the parameter.
    pub name: &'static str,
    /// Value in the parameter's unit of measure.
    pub value: u32,
    /// The entry of the data sheet, and its conversion.
    pub provenance: Provenance,
}

/// A part that does not fit the clock. The text lists the parts that fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartError(String);

impl fmt::Display for PartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for PartError {}

impl DataSheet {
    fn times(&self) -> [(&'static str, SheetTime); 12] {
        [
            ("cl", self.cl),
            ("cwl", self.cwl),
            ("rcd", self.rcd),
            ("rp", self.rp),
            ("ras", self.ras),
            ("rtp", self.rtp),
            ("wr", self.wr),
            ("wtr", self.wtr),
            ("rrd", self.rrd),
            ("faw", self.faw),
            ("refi", self.refi),
            ("rfc", self.rfc),
        ]
    }

    /// Rate in bytes per second as a ratio, seen from a device with a clock of `hz`.
    pub(super) fn bytes_per_second(&self, hz: u64) -> (u128, u128) {
        match self.rate {
            SheetRate::Own { bytes, hz: (clocks, per), .. } => (u128::from(bytes) * u128::from(clocks), u128::from(per)),
            SheetRate::Device { bytes, .. } => (u128::from(bytes) * u128::from(hz), 1),
        }
    }

    /// Cycles of a clock of `hz`, as a ratio.
    fn cycles(&self, length: SheetLength, hz: u64) -> (u128, u128) {
        match (length, &self.rate) {
            (SheetLength::Picoseconds(ps), _) => (u128::from(ps) * u128::from(hz), 1_000_000_000_000),
            (SheetLength::Clocks(n), SheetRate::Own { hz: (clocks, per), .. }) => {
                (u128::from(n) * u128::from(hz) * u128::from(*per), u128::from(*clocks))
            }
            (SheetLength::Clocks(n) | SheetLength::Cycles(n), _) => (n.into(), 1),
        }
    }

    fn time(&self, name: &'static str, time: SheetTime, hz: u64, burst_cycles: u32) -> PartNumber {
        let (count, per) = self.cycles(time.length, hz);
        let (whole, rounding) = if name == "refi" { (count / per, "down") } else { (count.div_ceil(per), "up") };
        let burst = if name == "rtp" { burst_cycles } else { 0 };
        let value = u32::try_from(whole).unwrap_or(u32::MAX).saturating_add(burst);
        let at = ClockRate(hz);
        let length = match (time.length, &self.rate) {
            (SheetLength::Picoseconds(ps), _) => format!("{} ns, rounded {rounding} at {at}", ps as f64 / 1e3),
            (SheetLength::Clocks(n), SheetRate::Own { hz: (clocks, per), .. }) => {
                let ns = rounded(f64::from(n) * *per as f64 * 1e9 / *clocks as f64);
                let plural = if n == 1 { "" } else { "s" };
                format!("{n} clock{plural} of {}, {ns} ns, rounded {rounding} at {at}", ClockRate(clocks / per))
            }
            (SheetLength::Clocks(n) | SheetLength::Cycles(n), _) => format!("{n} cycles"),
        };
        PartNumber { name, value, provenance: self.from(format!("{}: {length}", time.of), time.assumed) }
    }

    /// Returns the commands of a channel per cycle of a clock of `hz`: whole ones, and at least one; 0 if it has no command bus.
    fn commands_at(&self, hz: u64) -> PartNumber {
        let number =
            |value, text: String, assumed| PartNumber { name: "commands_per_cycle", value, provenance: self.from(text, assumed) };
        match self.rate {
            _ if !self.has_command_bus => number(0, "no rows, so no row commands".into(), false),
            SheetRate::Device { .. } => number(1, "a command per cycle of the device".into(), true),
            SheetRate::Own { hz: (clocks, per), .. } => {
                let value = u32::try_from(clocks / per / hz.max(1)).unwrap_or(u32::MAX).max(1);
                let [own, at] = [ClockRate(clocks / per), ClockRate(hz)];
                number(value, format!("a command per clock of {own}, rounded down at {at}, and at least one"), false)
            }
        }
    }

    /// Returns the bursts that a controller of its time chooses from.
    fn queue(&self) -> PartNumber {
        PartNumber { name: "window", value: self.window, provenance: self.from(self.controller.into(), true) }
    }

    fn from(&self, text: String, assumed: bool) -> Provenance {
        let source = self.source;
        if assumed {
            Provenance::Assumed(format!("{text}; typical of the class, not in the sheet cited ({source})").into())
        } else {
            Provenance::Derived(format!("{text} ({source})").into())
        }
    }

    fn of_rate(&self) -> String {
        match self.rate {
            SheetRate::Own { hz: (clocks, per), of, .. } => format!("{of}, clock of {}", ClockRate(clocks / per)),
            SheetRate::Device { of, .. } => of.into(),
        }
    }
}

impl MemoryPart {
    /// Description of the chips and its source; `None` for [`MemoryPart::Custom`].
    pub fn about(self) -> Option<String> {
        self.sheet().map(|sheet| format!("{} ({})", sheet.about, sheet.source))
    }

    /// Peak bandwidth of a channel \[bytes/s\], seen from a device with a clock of `hz`; `None` for [`MemoryPart::Custom`].
    pub fn bytes_per_second(self, hz: u64) -> Option<f64> {
        self.sheet().map(|sheet| sheet.bytes_per_second(hz)).map(|(bytes, per)| bytes as f64 / per as f64)
    }

    /// Returns all numbers that the part sets at a clock of `hz`. `burst`: bytes and cycles of the burst, if the user has set
    /// them; dependent numbers follow the set values. Empty for [`MemoryPart::Custom`].
    ///
    /// # Errors
    /// If its rate or its times cannot be expressed in cycles of this clock.
    pub fn numbers(self, hz: u64, burst: [Option<u32>; 2]) -> Result<Vec<PartNumber>, PartError> {
        self.numbers_or_why(hz, burst).map_err(|why| {
            let fit = Self::ALL.iter().filter(|part| part.numbers_or_why(hz, [None; 2]).is_ok());
            let fit = fit.map(|part| part.name()).collect::<Vec<_>>().join(", ");
            PartError(format!(
                "{} does not fit a clock of {}: {why}; at this clock fit {fit}, and custom numbers",
                self.name(),
                ClockRate(hz)
            ))
        })
    }

    fn numbers_or_why(self, hz: u64, burst: [Option<u32>; 2]) -> Result<Vec<PartNumber>, String> {
        let Some(sheet) = self.sheet() else { return Ok(vec![]) };
        let [bytes, cycles] = match burst {
            [Some(bytes), Some(cycles)] => [bytes, cycles],
            [bytes, cycles] => {
                let found = sheet.burst(hz, bytes)?;
                [found[0], cycles.unwrap_or(found[1])]
            }
        };
        let moved = |bytes: u32, cycles: u32| rounded(f64::from(bytes) / f64::from(cycles) * hz as f64 / 1e9);
        let (of_part, per) = sheet.bytes_per_second(hz);
        let of_part = rounded(of_part as f64 / per as f64 / 1e9);
        let text = format!(
            "{bytes} bytes in {cycles} cycles: {} GB/s; the part has {of_part}: {}",
            moved(bytes, cycles),
            sheet.of_rate()
        );
        let derived = |name, value, text: &str| PartNumber { name, value, provenance: sheet.from(text.into(), false) };
        let rate = [("burst_bytes", bytes), ("burst_cycles", cycles)].map(|(name, value)| derived(name, value, &text));
        let chips = [("banks", sheet.banks), ("row_bytes", sheet.row_bytes)].map(|(name, value)| PartNumber {
            name,
            value,
            provenance: sheet.from(sheet.about.into(), sheet.chips_assumed),
        });
        let of_board = |number: &PartNumber| sheet.board.iter().any(|(name, _)| *name == number.name);
        let queue = [sheet.commands_at(hz), sheet.queue()].into_iter().filter(|number| !of_board(number));
        let board = sheet.board.iter().map(|&(name, value)| derived(name, value, sheet.about));
        let times = sheet.times().into_iter().map(|(name, time)| sheet.time(name, time, hz, cycles));
        let numbers: Vec<PartNumber> = times.chain(rate).chain(chips).chain(queue).chain(board).collect();
        can_be(&numbers).map(|()| numbers)
    }
}

/// Checks that a memory can have these numbers.
fn can_be(numbers: &[PartNumber]) -> Result<(), String> {
    let mut memory = MemoryConfig::default();
    numbers.iter().for_each(|number| memory.set(number));
    memory.check("").map_err(|e| e.to_string())?;
    let MemoryConfig { refi, rfc, rcd, .. } = memory;
    let ever = rfc > 0;
    if ever && refi <= rfc + rcd {
        return Err(format!("a refresh every {refi} cycles leaves no time for rfc = {rfc} and rcd = {rcd}"));
    }
    Ok(())
}

impl MemoryConfig {
    /// Sets the numbers of the part at a clock of `hz`, except those that are `given`, by name. A burst must lie in one channel,
    /// so `channel_bytes` grows with a larger burst.
    ///
    /// # Errors
    /// If the part does not fit the clock. Then nothing changes.
    pub fn take_part(&mut self, hz: u64, given: impl Fn(&str) -> bool) -> Result<(), PartError> {
        let burst = [("burst_bytes", self.burst_bytes), ("burst_cycles", self.burst_cycles)];
        let numbers = self.part.numbers(hz, burst.map(|(name, value)| given(name).then_some(value)))?;
        numbers.iter().filter(|number| !given(number.name)).for_each(|number| self.set(number));
        if self.part != MemoryPart::Custom && !given("channel_bytes") {
            self.channel_bytes = self.channel_bytes.max(self.burst_bytes);
        }
        Ok(())
    }

    /// Returns the memory with the numbers of its part at a clock of `hz`; unchanged if the part does not fit.
    #[must_use]
    pub fn at(mut self, hz: u64) -> Self {
        // A part that does not fit changes nothing.
        let _ = self.take_part(hz, |_| false);
        self
    }

    fn set(&mut self, number: &PartNumber) {
        if let Some(value) = self.number_mut(number.name) {
            *value = number.value;
        }
    }

    fn number_mut(&mut self, name: &str) -> Option<&mut u32> {
        Some(match name {
            "channels" => &mut self.channels,
            "channel_bytes" => &mut self.channel_bytes,
            "window" => &mut self.window,
            "cap" => &mut self.cap,
            "cl" => &mut self.cl,
            "cwl" => &mut self.cwl,
            "rcd" => &mut self.rcd,
            "rp" => &mut self.rp,
            "ras" => &mut self.ras,
            "rtp" => &mut self.rtp,
            "wr" => &mut self.wr,
            "wtr" => &mut self.wtr,
            "rrd" => &mut self.rrd,
            "faw" => &mut self.faw,
            "refi" => &mut self.refi,
            "rfc" => &mut self.rfc,
            "burst_bytes" => &mut self.burst_bytes,
            "burst_cycles" => &mut self.burst_cycles,
            "banks" => &mut self.banks,
            "row_bytes" => &mut self.row_bytes,
            "issue" => &mut self.issue,
            "commands_per_cycle" => &mut self.commands_per_cycle,
            "outstanding" => &mut self.outstanding,
            _ => return None,
        })
    }
}
