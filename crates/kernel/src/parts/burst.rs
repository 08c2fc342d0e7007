//! Bursts of a part in whole cycles of a clock.

use super::sheet::{ClockRate, DataSheet, rounded};

/// Largest burst considered \[bytes\]: the default number of consecutive bytes in one channel.
pub const MOST_BURST_BYTES: u32 = 256;

/// Typical size of a request \[bytes\].
const LINE_BYTES: u32 = 64;

/// A part's rate at a clock, as a ratio of bytes per cycle.
struct BytesPerCycle(u128, u128);

impl BytesPerCycle {
    /// Returns true if the rate of such a burst is within 5 %.
    fn is_met_by(&self, [bytes, cycles]: [u32; 2]) -> bool {
        let (have, want) = (u128::from(bytes) * self.1, u128::from(cycles) * self.0);
        20 * have.abs_diff(want) <= want
    }

    /// Returns the cycles of so many bytes, rounded down and up; at least 1.
    fn cycles(&self, bytes: u32) -> [u32; 2] {
        let exact = u128::from(bytes) * self.1;
        [exact / self.0, exact.div_ceil(self.0)].map(|n| u32::try_from(n).unwrap_or(u32::MAX).max(1))
    }

    /// Returns the burst of so many bytes, if there is one within 5 %.
    fn burst(&self, bytes: u32) -> Option<[u32; 2]> {
        self.cycles(bytes).map(|cycles| [bytes, cycles]).into_iter().find(|burst| self.is_met_by(*burst))
    }
}

impl DataSheet {
    /// Returns bytes and cycles of a burst at a clock of `hz`. If its bytes are given, the cycles follow from them, rounded up if
    /// no whole number is within 5 %.
    pub(super) fn burst(&self, hz: u64, bytes: Option<u32>) -> Result<[u32; 2], String> {
        let (bytes_per_second, per) = self.bytes_per_second(hz);
        let rate = BytesPerCycle(bytes_per_second, u128::from(hz) * per);
        if let Some(bytes) = bytes {
            return Ok(rate.burst(bytes).unwrap_or([bytes, rate.cycles(bytes)[1]]));
        }
        let others = (4..=MOST_BURST_BYTES).step_by(4).filter_map(|bytes| rate.burst(bytes));
        let best = || {
            others.min_by(|a, b| {
                let ([cycles, lines], [other_cycles, other_lines]) = (line_cycles(*a), line_cycles(*b));
                (cycles * other_lines).cmp(&(other_cycles * lines))
            })
        };
        rate.burst(self.burst_bytes).or_else(best).ok_or_else(|| {
            let gigabytes = rounded(bytes_per_second as f64 / per as f64 / 1e9);
            // The bytes per cycle at 5 % below the rate.
            let least = (20 * bytes_per_second).div_ceil(21 * u128::from(MOST_BURST_BYTES) * per);
            let least = ClockRate(u64::try_from(least).unwrap_or(u64::MAX));
            format!("no burst of {MOST_BURST_BYTES} bytes or fewer in whole cycles comes within 5 % of its {gigabytes} GB/s per channel, which takes {least} or more")
        })
    }
}

/// Cycles that aligned lines take in bursts with their own alignment, summed over all positions at which a line can begin, and
/// the number of these lines.
fn line_cycles([bytes, cycles]: [u32; 2]) -> [u64; 2] {
    let step = gcd(bytes, LINE_BYTES);
    let bursts: u64 = (0..bytes).step_by(step as usize).map(|begin| u64::from((begin + LINE_BYTES).div_ceil(bytes))).sum();
    [bursts * u64::from(cycles), u64::from(bytes / step)]
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}
