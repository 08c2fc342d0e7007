//! Cycles in real time.

/// Nanoseconds per second.
const NS: u64 = 1_000_000_000;

/// Units of time per cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TimeScale {
    /// Units per second.
    units: u64,
    hz: u64,
    /// Units per cycle, where that is a whole number.
    whole: Option<u64>,
}

impl TimeScale {
    fn new(units: u64, hz: u64) -> Self {
        Self { units, hz, whole: units.is_multiple_of(hz).then(|| units / hz) }
    }

    /// In nanoseconds. Without a clock a cycle is one; also with one of more than 1 GHz, so that no two cycles fall together.
    pub(crate) fn nanoseconds(hz: u64) -> Self {
        Self::new(NS, if (1..=NS).contains(&hz) { hz } else { NS })
    }

    /// In the coarsest of nano-, pico- and femtoseconds of which a cycle takes a whole number, or else in the last; and the power of ten
    /// that this is of a second. Without a clock a cycle is a nanosecond.
    pub(crate) fn whole(hz: u64) -> (Self, i8) {
        let hz = if hz == 0 { NS } else { hz };
        let scales = [(NS, -9), (1_000 * NS, -12), (1_000_000 * NS, -15)].map(|(units, power)| (Self::new(units, hz), power));
        scales.into_iter().find(|(scale, _)| scale.whole.is_some()).unwrap_or(scales[2])
    }

    /// Returns the start time of a cycle, rounded down to a whole unit and saturated to 63 bits.
    pub(crate) fn at(self, cycle: u64) -> u64 {
        let time = match self.whole {
            Some(units) => cycle.saturating_mul(units),
            None => u64::try_from(u128::from(cycle) * u128::from(self.units) / u128::from(self.hz)).unwrap_or(u64::MAX),
        };
        time.min(i64::MAX as u64)
    }

    /// Describes the time scale: duration of a cycle on a device of `hz`, and its length in the trace.
    pub(crate) fn words(self, hz: u64) -> String {
        let ns = self.units as f64 / self.hz as f64;
        match (self.hz == hz, self.whole) {
            (true, Some(ns)) => format!("a cycle is {ns} ns"),
            (true, None) => format!("a cycle is {ns:.3} ns, times are rounded down"),
            _ => "a cycle is shown as 1 ns".into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_takes_as_long_as_the_clock_says() {
        let at = |hz, cycle| TimeScale::nanoseconds(hz).at(cycle);
        assert_eq!([at(200_000_000, 7), at(25_000_000, 7), at(1_000_000_000, 7)], [35, 280, 7]);
        assert_eq!([at(150_000_000, 1), at(150_000_000, 2), at(150_000_000, 3)], [6, 13, 20]);
        assert_eq!([at(0, 7), at(2_000_000_000, 7)], [7, 7], "no two cycles fall together");
        assert_eq!([at(1, u64::MAX), at(3, u64::MAX), at(0, u64::MAX)], [i64::MAX as u64; 3]);
    }

    #[test]
    fn a_unit_is_found_of_which_a_cycle_takes_a_whole_number() {
        let whole = |hz| (TimeScale::whole(hz).1, TimeScale::whole(hz).0.at(3));
        assert_eq!([whole(0), whole(200_000_000), whole(25_000_000)], [(-9, 3), (-9, 15), (-9, 120)]);
        assert_eq!([whole(64_000_000), whole(2_000_000_000)], [(-12, 46_875), (-12, 1_500)]);
        assert_eq!(whole(150_000_000), (-15, 20_000_000));
        assert_eq!(whole(300_000_000), (-15, 10_000_000), "rounded down from 3 1/3 ns a cycle");
    }

    #[test]
    fn the_words_say_what_is_shown() {
        let words = |hz| TimeScale::nanoseconds(hz).words(hz);
        assert_eq!(words(200_000_000), "a cycle is 5 ns");
        assert_eq!(words(150_000_000), "a cycle is 6.667 ns, times are rounded down");
        assert_eq!([words(0), words(2_000_000_000)], ["a cycle is shown as 1 ns"; 2]);
    }
}
